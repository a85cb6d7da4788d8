"""Specs that are written: corrected jobs, jobs with other values, jobs of the library, and of other programs."""

import shutil

import pytest
from conftest import PINION, ROOT

import flank


# the settings of a pinion of the library, tilted
SUMMARY = """<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" applicationId="test" date="2026-01-01T00:00:00+01:00">
  <components>
    <component id="12" type="bevel_gear_manufacturing_settings" name="pinion">
      <attribute id="radial_distance" unit="mm">97.95940290780507</attribute>
      <attribute id="center_roll_position" unit="deg">52.79674678267486</attribute>
      <attribute id="cutter_tilt" unit="deg">2.5</attribute>
      <attribute id="machine_root_angle" unit="deg">15.64096727073747</attribute>
      <attribute id="machine_center_to_crossing_point" unit="mm">-0.001306176586991889</attribute>
      <attribute id="ratio_of_roll" unit="none">3.339685914944047</attribute>
      <attribute id="helical_motion_coefficients" unit="none"><array><c>1.2</c><c>-1.5</c></array></attribute>
    </component>
    <component id="21" type="bevel_gear_tool" name="outside">
      <attribute id="blade_point_radius" unit="mm">95.9517390193892</attribute>
      <attribute id="blade_pressure_angle" unit="deg">20.0</attribute>
      <attribute id="blade_spheric_radius" unit="mm">2000000</attribute>
      <attribute id="tool_edge_radius_bevel_gear_tool" unit="mm">0.20845</attribute>
    </component>
  </components>
</model>
"""


@pytest.fixture
def project(tmp_path):
    """The pinion with the machines and tools that it uses, in a folder of its own."""
    for folder in ("bevel", "functions", "machines", "tools"):
        shutil.copytree(ROOT / "specs" / folder, tmp_path / "specs" / folder)
    (tmp_path / "flank.toml").write_text("")
    return tmp_path


def test_a_job_has_the_text_of_its_spec(job):
    assert job.text == (ROOT / PINION).read_text()


def test_other_values_are_saved_as_a_variant(project):
    job = flank.load(project / PINION).with_values({"m.radial_distance": "98.1 mm", "m.ratio_of_roll": 3.35})
    beside = flank.loads(job.text, name=str(project / "specs/bevel/beside.chain"))
    elsewhere = flank.load(job.save(project / "other.chain"))
    for again in (beside, elsewhere):
        assert {name: of.value for name, of in again.parameters.items()} == {name: of.value for name, of in job.parameters.items()}
        assert not again.overrides
    own = flank.load(project / PINION)
    with pytest.raises(flank.InputError, match="file of its own"):
        job.save(project / PINION)
    assert own.text == (project / PINION).read_text()


def test_what_would_not_compile_is_not_saved(job, tmp_path):
    with pytest.raises(flank.SpecError):
        job.with_values({"m.radial_distance": "98.1 mm"}).save(tmp_path / "away.chain")
    assert not list(tmp_path.iterdir())


def test_a_fit_writes_its_spec(project):
    job = flank.load(project / PINION)
    made = job.with_values({"m.radial_distance": "98.05 mm"})
    fit = job.fit("concave", made.measuring_grid("concave").xyz, vary="m.radial_distance")
    path = fit.write(project / "corrected.chain")
    corrected = flank.load(path)
    assert corrected.name == "pinion_19x62_corrected"
    assert corrected.parameters["m.radial_distance"].value == fit.job.parameters["m.radial_distance"].value
    assert "m.radial_distance" in fit.text and not (project / "specs/bevel/pinion_19x62_corrected.chain").exists()
    saved = flank.load(fit.job.save(project / "saved.chain"))
    assert saved.parameters["m.radial_distance"].value == fit.job.parameters["m.radial_distance"].value


def test_jobs_of_the_library_are_made(tmp_path):
    names = [one["name"] for one in flank.templates()["templates"]]
    assert "helical_gear" in names
    made = flank.new("helical_gear", tmp_path, name="mine", values={"teeth": 25, "helix_angle": (12, "deg")})
    job = flank.load(made["spec"])
    assert job.name == "mine" and job.parameters["helix_angle"].value == 12
    with pytest.raises(flank.SpecError, match="E0301"):
        flank.new("helical_gear", tmp_path / "other", values={"helix_angle": 12})
    with pytest.raises(flank.Error, match="helical_gaer"):
        flank.new("helical_gaer", tmp_path)


def test_machine_summaries_are_read(tmp_path):
    file = tmp_path / "summary.rexs"
    file.write_text(SUMMARY)
    options = {"coefficients": "taylor", "outside": "21"}
    made = flank.import_rexs(file, "left-hand-pinion", name="mine", **options)
    assert made.job == "mine" and "job mine" in made.text
    assert made.doubts == [] and "0 doubts" in repr(made)
    (tmp_path / "flank.toml").write_text("")
    shutil.copytree(ROOT / "specs", tmp_path / "specs")
    assert flank.load(made.save(tmp_path / "mine.chain")).parameters["m.radial_distance"].value == 97.95940290780507
    for wrong in ({"signs": "mirror"}, {"signs": "frames", "coefficients": "none"}):
        with pytest.raises(flank.InputError, match="mirror|none"):
            flank.import_rexs(file, **wrong)
    with pytest.raises(flank.InputError, match="`outside`"):
        flank.import_rexs(file, "frames")
