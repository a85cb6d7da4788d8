//! The files that a command leaves in its folder.

use std::io::Write;
use std::path::Path;

use flank_export::{Dataset, Picture, WriteError, write_atomically, write_csv, write_json, write_stl};

use crate::arguments::Format;
use crate::spec;

/// A folder that is written to, and the files that stand there now.
pub(crate) struct Folder<'a> {
    path: &'a Path,
    pub(crate) written: Vec<String>,
}

impl<'a> Folder<'a> {
    /// The folder, made if it is not there.
    pub(crate) fn at(path: &'a Path) -> Result<Folder<'a>, String> {
        std::fs::create_dir_all(path).map_err(|error| format!("cannot make the folder {}: {error}", path.display()))?;
        Ok(Folder { path, written: Vec::new() })
    }

    /// The points in the formats that are asked for.
    pub(crate) fn data(&mut self, name: &str, dataset: &Dataset, formats: &[Format]) -> Result<(), String> {
        for format in formats {
            match format {
                Format::Csv => self.write(&format!("{name}.csv"), |out| write_csv(dataset, out))?,
                Format::Json => self.write(&format!("{name}.json"), |out| write_json(dataset, out))?,
                Format::Stl => self.write(&format!("{name}.stl"), |out| write_stl(dataset, out))?,
            }
        }
        Ok(())
    }

    /// A picture as PNG and SVG.
    pub(crate) fn picture(&mut self, name: &str, drawn: &Picture) -> Result<(), String> {
        let png = drawn.png().map_err(|error| error.to_string())?;
        self.write(&format!("{name}.png"), |out| Ok(out.write_all(&png)?))?;
        let svg = drawn.svg();
        self.write(&format!("{name}.svg"), |out| Ok(out.write_all(svg.as_bytes())?))
    }

    fn write(&mut self, name: &str, content: impl Fn(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), String> {
        let path = self.path.join(name);
        write_atomically(&path, content).map_err(|error| error.to_string())?;
        self.written.push(spec::shown(&path));
        Ok(())
    }
}
