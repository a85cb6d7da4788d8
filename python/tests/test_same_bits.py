"""The comparison of bits, for jobs that are quick."""

import os
from pathlib import Path

import flank
from same_bits import compared


def test_bits_are_those_of_files():
    program = os.environ.get("FLANK_PROGRAM")
    for path in ["specs/bevel/pinion_19x62.chain", "specs/hobbing/undercut_gear.chain", "specs/bevel/ease_off_19x62.chain"]:
        for name, job in flank.load_all(path).items():
            if all(surface.counts is None for surface in job.surfaces.values()):
                continue
            count, different = compared(Path(path), name, job, program)
            assert count > 0 and different == 0, (path, name)
