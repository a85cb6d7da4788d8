//! Where reports go: a folder, or one file.

use std::path::{Path, PathBuf};

use flank_chain_dsl::Job;
use flank_draw::Report as Document;
use flank_export::Face;

use super::Findings;
use crate::project::choices::{Choice, PictureFormat, ReportFormat};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::requests::ReportRequest;

pub(super) struct Target {
    folder: PathBuf,
    /// The name of the one file; names of jobs otherwise.
    file: Option<String>,
    formats: Vec<ReportFormat>,
}

impl Target {
    /// # Errors
    /// In words, if one file is to hold several formats.
    pub(super) fn check(request: &ReportRequest) -> Result<(), Failure> {
        let out = &request.out;
        let format = ReportFormat::of_path(out);
        match request.format.iter().find(|other| format.is_some_and(|format| **other != format)) {
            Some(other) => {
                let message =
                    format!("{} cannot hold {}: name a folder with option `out`", out.display(), other.name());
                Err(Failure::Request(message))
            }
            None => Ok(()),
        }
    }

    /// # Errors
    /// In words, if one file is to hold several reports.
    pub(super) fn of_request(request: &ReportRequest, jobs: &[&Job<'_>]) -> Result<Target, String> {
        let out = &request.out;
        let Some(format) = ReportFormat::of_path(out) else {
            let formats = if request.format.is_empty() { vec![ReportFormat::Html] } else { request.format.clone() };
            return Ok(Target { folder: out.clone(), file: None, formats });
        };
        if jobs.len() > 1 {
            let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
            let names = names.join(", ");
            return Err(format!(
                "{} can hold one job of {names}: choose it with option `job`, or name a folder",
                out.display()
            ));
        }
        let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let file = out.file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(Target { folder: folder.to_path_buf(), file, formats: vec![format] })
    }

    /// Writes the files of a job's report and names them.
    pub(super) fn write(
        &self,
        findings: &Findings<'_, '_>,
        document: &Document,
        monitor: &dyn Monitor,
    ) -> Result<Vec<String>, Failure> {
        let job = &findings.job.name;
        let mut folder = Folder::at(&self.folder, findings.origin, monitor);
        let faces: Vec<&Face> = findings.faces.iter().filter_map(|smooth| smooth.face.as_ref()).collect();
        if !faces.is_empty() {
            folder.step(job, &findings.header, &faces)?;
        }
        for format in &self.formats {
            let name = self.file.clone().unwrap_or_else(|| format!("{job}.report.{}", format.name()));
            if *format == ReportFormat::Md {
                for figure in document.figures() {
                    folder.picture_as(&figure.name, &figure.picture, &[PictureFormat::Svg])?;
                }
            }
            folder.report(&name, document, *format)?;
        }
        folder.finish()
    }
}
