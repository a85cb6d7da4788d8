//! The files that a command leaves in its folder.

use std::path::{Path, PathBuf};

use flank_draw::{Picture, Report, Scene, write_page, write_report_html, write_report_markdown};
use flank_export::{
    BodyMesh, BrickBody, Dataset, Dialect, Face, FileSet, GearBody, Header, MeasuringGrid, MotionTable, PlacedBody,
    PlacedFrame, Surfaces, Target, WriteError, make_folder, write_3mf, write_body_3mf, write_body_obj, write_body_stl,
    write_csv, write_grid_csv, write_grid_json, write_inp, write_json, write_motion_csv, write_motion_json, write_nc,
    write_obj, write_parquet, write_step, write_step_assembly, write_step_body, write_stl, write_vtp, write_vtu,
};
use rayon::prelude::*;

use crate::project::choices::{PictureFormat, PointFormat, ReportFormat, TableFormat};
use crate::project::failure::Failure;
use crate::project::monitor::{Monitor, Unwatched};
use crate::project::remark::{Remark, RemarkKind};
use crate::project::session::check;
use crate::project::shown_path;
use crate::project::spec::Origin;

/// A folder that is written to. Its files get their names together when it is finished; until then it is as it was.
#[must_use = "files have no names before it is finished"]
pub(crate) struct Folder<'a> {
    path: &'a Path,
    /// What is not written over.
    origin: &'a Origin,
    files: FileSet,
    monitor: &'a dyn Monitor,
    pub(crate) written: Vec<String>,
}

impl<'a> Folder<'a> {
    /// The folder, made with its first file if it is not there.
    pub(crate) fn at(path: &'a Path, origin: &'a Origin, monitor: &'a dyn Monitor) -> Folder<'a> {
        Folder { path, origin, files: FileSet::default(), monitor, written: Vec::new() }
    }

    /// Gives all files their names, and returns these.
    pub(crate) fn finish(self) -> Result<Vec<String>, Failure> {
        check(self.monitor)?;
        self.files.finish()?;
        Ok(self.written)
    }

    /// The points in the formats that are asked for. A mesh has one origin: of surfaces in several frames there is one for each.
    pub(crate) fn data(&mut self, name: &str, surfaces: &Surfaces<'_>, formats: &[PointFormat]) -> Result<(), Failure> {
        let meshes = by_frame(name, surfaces.list.iter().map(|surface| (surface.outline().frame.as_str(), *surface)));
        let meshes: Vec<(String, Surfaces<'_>)> =
            meshes.into_iter().map(|(name, list)| (name, Surfaces { header: surfaces.header, list })).collect();
        for format in formats {
            match format {
                PointFormat::Csv => self.write(&format!("{name}.csv"), |out| write_csv(surfaces, out))?,
                PointFormat::Json => self.write(&format!("{name}.json"), |out| write_json(surfaces, out))?,
                PointFormat::Parquet => self.write(&format!("{name}.parquet"), |out| write_parquet(surfaces, out))?,
                PointFormat::Stl | PointFormat::Obj | PointFormat::ThreeMf | PointFormat::Vtp => {
                    meshes.iter().try_for_each(|(name, mesh)| self.mesh(name, mesh, *format))?;
                }
            }
        }
        Ok(())
    }

    fn mesh(&mut self, name: &str, surfaces: &Surfaces<'_>, format: PointFormat) -> Result<(), Failure> {
        // a file of triangles says nothing where there are none
        let is_line =
            surfaces.list.iter().map(|surface| surface.outline()).all(|of| of.rows.count.min(of.columns.count) < 2);
        if is_line && matches!(format, PointFormat::Stl | PointFormat::ThreeMf) {
            let message =
                format!("the mesh of {name} has no triangle: samples of two rows and two columns at least have some");
            self.monitor.remark(&Remark::new(RemarkKind::NoTriangles, name, message));
        }
        match format {
            PointFormat::Stl => self.write(&format!("{name}.stl"), |out| write_stl(surfaces, out)),
            PointFormat::Obj => self.write(&format!("{name}.obj"), |out| write_obj(surfaces, out)),
            PointFormat::ThreeMf => self.write(&format!("{name}.3mf"), |out| write_3mf(surfaces, out)),
            PointFormat::Vtp => self.write(&format!("{name}.vtp"), |out| write_vtp(surfaces, out)),
            PointFormat::Csv | PointFormat::Json | PointFormat::Parquet => Ok(()),
        }
    }

    /// Smooth faces, a file for each frame as of meshes.
    pub(crate) fn step(&mut self, name: &str, header: &Header, faces: &[&Face]) -> Result<(), Failure> {
        let files = by_frame(name, faces.iter().map(|face| (face.frame(), *face)));
        files
            .iter()
            .try_for_each(|(name, faces)| self.write(&format!("{name}.step"), |out| write_step(header, faces, out)))
    }

    /// What there is to say of files of earlier runs under a name that is not written now.
    pub(crate) fn older<'e>(&self, name: &str, extensions: impl Iterator<Item = &'e str>) -> Vec<String> {
        let older =
            extensions.map(|extension| self.path.join(format!("{name}.{extension}"))).filter(|path| path.exists());
        older.map(|path| format!("`{}` is there from an earlier run", shown_path(&path))).collect()
    }

    /// The closed surface of a body.
    pub(crate) fn body_stl(&mut self, name: &str, header: &Header, body: &BodyMesh<'_>) -> Result<(), Failure> {
        self.write(&format!("{name}.stl"), |out| write_body_stl(header, body, out))
    }

    /// A body with smooth faces.
    pub(crate) fn body_step(&mut self, name: &str, header: &Header, body: &GearBody) -> Result<(), Failure> {
        self.write(&format!("{name}.step"), |out| write_step_body(header, body, out))
    }

    /// Bodies with smooth faces where they are mounted.
    pub(crate) fn body_assembly(
        &mut self,
        name: &str,
        header: &Header,
        bodies: &[PlacedBody<'_>],
    ) -> Result<(), Failure> {
        self.write(&format!("{name}.step"), |out| write_step_assembly(header, bodies, out))
    }

    /// The same with shared corners.
    pub(crate) fn body_obj(&mut self, name: &str, header: &Header, body: &BodyMesh<'_>) -> Result<(), Failure> {
        self.write(&format!("{name}.obj"), |out| write_body_obj(header, body, out))
    }

    /// Bodies where they stand, packed.
    pub(crate) fn body_3mf(
        &mut self,
        name: &str,
        header: &Header,
        bodies: &[(BodyMesh<'_>, PlacedFrame)],
    ) -> Result<(), Failure> {
        self.write(&format!("{name}.3mf"), |out| write_body_3mf(header, bodies, out))
    }

    /// Bricks for Abaqus and CalculiX.
    pub(crate) fn bricks_inp(&mut self, name: &str, header: &Header, body: &BrickBody<'_>) -> Result<(), Failure> {
        self.write(&format!("{name}.inp"), |out| write_inp(header, body, out))
    }

    /// The same for ParaView.
    pub(crate) fn bricks_vtu(&mut self, name: &str, header: &Header, body: &BrickBody<'_>) -> Result<(), Failure> {
        self.write(&format!("{name}.vtu"), |out| write_vtu(header, body, out))
    }

    /// A picture as PNG and SVG.
    pub(crate) fn picture(&mut self, name: &str, drawn: &Picture) -> Result<(), Failure> {
        self.picture_as(name, drawn, &[PictureFormat::Png, PictureFormat::Svg])
    }

    /// The same after what `meanwhile` writes: the picture is painted beside it, on another thread.
    pub(crate) fn picture_after(
        &mut self,
        name: &str,
        drawn: Option<&Picture>,
        meanwhile: impl FnOnce(&mut Self) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Some(drawn) = drawn else { return meanwhile(self) };
        let mut png = None;
        let svg = rayon::in_place_scope(|scope| {
            scope.spawn(|_| png = Some(drawn.png()));
            meanwhile(self).map(|()| drawn.svg())
        });
        let png = png.expect("the scope has waited for it").map_err(|error| error.to_string())?;
        let svg = svg?;
        self.write(&format!("{name}.png"), |out| Ok(out.write_all(&png)?))?;
        self.text(&format!("{name}.svg"), &svg)
    }

    /// A picture in some formats, all painted at the same time.
    pub(crate) fn picture_as(&mut self, name: &str, drawn: &Picture, formats: &[PictureFormat]) -> Result<(), Failure> {
        let painted = formats.par_iter().map(|format| match format {
            PictureFormat::Png => drawn.png().map(|png| ("png", png)),
            PictureFormat::Svg => Ok(("svg", drawn.svg().into_bytes())),
        });
        let painted = painted.collect::<Result<Vec<_>, _>>().map_err(|error| error.to_string())?;
        for (ending, bytes) in painted {
            self.write(&format!("{name}.{ending}"), |out| Ok(out.write_all(&bytes)?))?;
        }
        Ok(())
    }

    /// Axis positions over a motion.
    pub(crate) fn motion(&mut self, name: &str, motion: &MotionTable, format: TableFormat) -> Result<(), Failure> {
        match format {
            TableFormat::Csv => self.write(&format!("{name}.csv"), |out| write_motion_csv(motion, out)),
            TableFormat::Json => self.write(&format!("{name}.json"), |out| write_motion_json(motion, out)),
        }
    }

    /// Nominal points for a measuring machine.
    pub(crate) fn grid(&mut self, name: &str, grid: &MeasuringGrid, format: TableFormat) -> Result<(), Failure> {
        match format {
            TableFormat::Csv => self.write(&format!("{name}.csv"), |out| write_grid_csv(grid, out)),
            TableFormat::Json => self.write(&format!("{name}.json"), |out| write_grid_json(grid, out)),
        }
    }

    /// A program that runs the motion in a number of seconds.
    pub(crate) fn nc(&mut self, name: &str, motion: &MotionTable, to: Dialect, seconds: f64) -> Result<(), Failure> {
        self.write(&format!("{name}.{}", to.extension()), |out| write_nc(motion, to, seconds, out))
    }

    /// A page to look at.
    pub(crate) fn page(&mut self, name: &str, dataset: &Dataset, scene: &Scene) -> Result<(), Failure> {
        self.write(&format!("{name}.html"), |out| write_page(dataset, scene, out))
    }

    /// A document to read.
    pub(crate) fn report(&mut self, name: &str, report: &Report, format: ReportFormat) -> Result<(), Failure> {
        match format {
            ReportFormat::Html => self.write(name, |out| write_report_html(report, out)),
            ReportFormat::Md => self.write(name, |out| write_report_markdown(report, out)),
        }
    }

    /// Any text.
    pub(crate) fn text(&mut self, name: &str, text: &str) -> Result<(), Failure> {
        self.write(name, |out| Ok(out.write_all(text.as_bytes())?))
    }

    fn write(
        &mut self,
        name: &str,
        content: impl Fn(&mut dyn Target) -> Result<(), WriteError>,
    ) -> Result<(), Failure> {
        let path = self.path.join(name);
        if self.origin.holds(&path) {
            let path = shown_path(&path);
            return Err(Failure::Input(format!(
                "`{path}` is what this command reads and would be written over: name another file or folder"
            )));
        }
        check(self.monitor)?;
        if self.written.is_empty() {
            make_folder(self.path)?;
        }
        let written = self.files.write(&path, content);
        // what stood in its way may be that
        check(self.monitor)?;
        written?;
        self.written.push(shown_path(&path));
        Ok(())
    }
}

/// Writes texts into a folder, which is made if it is not there: all of them, or none. Gives back their paths. Files that were `read`, by
/// their paths without links, are not written over.
///
/// # Errors
/// What stands in the way.
pub fn write_texts(folder: &Path, texts: &[(String, String)], read: &[PathBuf]) -> Result<Vec<String>, Failure> {
    let origin = Origin::of_files(read);
    let mut folder = Folder::at(folder, &origin, &Unwatched);
    texts.iter().try_for_each(|(name, text)| folder.text(name, text))?;
    folder.finish()
}

/// What lies in each frame, with the name of its file: the frame is part of it where there are several.
fn by_frame<'f, T>(name: &str, all: impl Iterator<Item = (&'f str, T)>) -> Vec<(String, Vec<T>)> {
    let mut frames: Vec<(&str, Vec<T>)> = Vec::new();
    for (frame, one) in all {
        match frames.iter_mut().find(|(known, _)| *known == frame) {
            Some((_, list)) => list.push(one),
            None => frames.push((frame, vec![one])),
        }
    }
    let is_one = frames.len() == 1;
    frames
        .into_iter()
        .map(|(frame, list)| (if is_one { name.to_string() } else { format!("{name}.{frame}") }, list))
        .collect()
}
