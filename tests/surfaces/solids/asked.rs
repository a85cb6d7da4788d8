//! Bodies as they are asked for.

use std::path::Path;
use std::sync::Arc;

use flank::{
    Answer, Buffers, Disk, EvaluatorOptions, JobSelection, MeshFormat, NotDone, Project, SolidNumbers, SolidPart,
    SolidRequest, SolidResult, Unwatched, solid,
};
use flank_tests::bodies::triangles;
use flank_tests::repository;

pub(crate) const BODIES: &str = "tests/surfaces/specs/bodies.chain";
pub(crate) const DEVIATION: f64 = 0.01;

pub(crate) struct Asked<'a> {
    pub(crate) spec: &'a str,
    pub(crate) job: &'a str,
    pub(crate) set: &'a [(&'a str, &'a str)],
    pub(crate) part: SolidPart,
    pub(crate) deviation: f64,
    /// The text, where there is no such file.
    pub(crate) text: Option<&'a str>,
    /// What of the text is replaced by what.
    pub(crate) changed: Option<(&'a str, &'a str)>,
    pub(crate) ball: Option<f64>,
    pub(crate) step: Option<f64>,
}

impl<'a> Asked<'a> {
    pub(crate) fn new(spec: &'a str, job: &'a str, set: &'a [(&'a str, &'a str)]) -> Asked<'a> {
        let (part, deviation) = (SolidPart::Gear, DEVIATION);
        Asked { spec, job, set, part, deviation, text: None, changed: None, ball: None, step: None }
    }

    /// The result, and the triangles that were written of each solid, in a folder.
    pub(crate) fn built(&self, folder: &Path) -> SolidResult {
        let path = repository(self.spec);
        let mut files = Buffers::over(Arc::new(Disk));
        if let Some(text) = self.text {
            files = files.with(&path, text);
        }
        if let Some((from, to)) = self.changed {
            let text = std::fs::read_to_string(&path).expect("a spec");
            assert!(text.contains(from), "{from}");
            files = files.with(&path, text.replace(from, to));
        }
        let set = self.set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        let project = Project::open(&path, Arc::new(files));
        let request = SolidRequest {
            jobs: JobSelection { project, job: Some(self.job.to_string()), set },
            part: self.part,
            out: folder.to_path_buf(),
            format: vec![MeshFormat::Stl],
            step: self.step,
            deviation: self.deviation,
            density: 7850.0,
            ball: self.ball,
            evaluator: EvaluatorOptions::default(),
        };
        let mut results = Vec::new();
        solid(&request, &Unwatched, &mut |result| results.push(result)).expect("a right spec");
        results.remove(0)
    }

    pub(crate) fn only(&self) -> (SolidNumbers, Vec<[[f32; 3]; 3]>) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut result = self.built(folder.path());
        assert!(result.is_complete(), "{:?}", result.not_done());
        (result.solids.remove(0), triangles(&folder.path().join(format!("{}.stl", self.job))))
    }

    pub(crate) fn refused(&self) -> String {
        self.not_done().message
    }

    pub(crate) fn not_done(&self) -> NotDone {
        let folder = tempfile::tempdir().expect("a folder");
        let result = self.built(folder.path());
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "no broken body in a file");
        result.not_done()[0].clone()
    }
}
