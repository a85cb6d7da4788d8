//! Pictures of whole gears, from the spec to the file; points and bodies beside them say what of it is drawing.

use std::path::Path;
use std::sync::Arc;

use divan::Bencher;
use flank::{
    Disk, EvaluatorOptions, JobSelection, MeshFormat, PictureFormat, PlotKind, PlotRequest, Project, SolidPart,
    SolidRequest, Unwatched, plot, solid,
};

const GEARS: [&str; 2] = ["specs/bevel/pinion_19x62.chain", "specs/bevel/gear_19x62.chain"];

fn main() {
    divan::main();
}

fn jobs(spec: &str) -> JobSelection {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(spec);
    JobSelection::all(Project::open(file, Arc::new(Disk)))
}

fn picture(spec: &str, what: PlotKind, format: PictureFormat) -> PlotRequest {
    PlotRequest {
        jobs: jobs(spec),
        what: vec![what],
        surface: Vec::new(),
        reference: None,
        of: Vec::new(),
        contact: Vec::new(),
        milling: None,
        errors: Vec::new(),
        positions: None,
        compound: None,
        out: std::env::temp_dir().join("flank_bench_pictures"),
        format: vec![format],
        size: (1200, 900),
        no_origin: true,
        evaluator: EvaluatorOptions::default(),
    }
}

#[divan::bench(args = GEARS)]
fn gear_png(bencher: Bencher, spec: &str) {
    let request = picture(spec, PlotKind::Gear, PictureFormat::Png);
    bencher.bench_local(|| plot(&request, &Unwatched, &mut |_| ()).expect("it has a gear"));
}

#[divan::bench(args = GEARS)]
fn gear_svg(bencher: Bencher, spec: &str) {
    let request = picture(spec, PlotKind::Gear, PictureFormat::Svg);
    bencher.bench_local(|| plot(&request, &Unwatched, &mut |_| ()).expect("it has a gear"));
}

/// The body alone, in no file.
#[divan::bench(args = GEARS)]
fn body(bencher: Bencher, spec: &str) {
    let request = SolidRequest {
        jobs: jobs(spec),
        part: SolidPart::Gear,
        out: std::env::temp_dir().join("flank_bench_pictures"),
        format: Vec::<MeshFormat>::new(),
        step: None,
        deviation: 0.5,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    bencher.bench_local(|| solid(&request, &Unwatched, &mut |_| ()).expect("it has a body"));
}
