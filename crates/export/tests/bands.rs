//! Surfaces that hand over their points in bands of rows: the files are those of the same surfaces in one piece.

mod synthetic;

use std::io::Cursor;

use flank_export::{
    Banded, Dataset, Patch, Surfaces, Taker, Target, WriteError, write_3mf, write_csv, write_json, write_obj,
    write_parquet, write_stl, write_vtp,
};
use synthetic::{gallery, with_fields};

/// So many rows at a time.
struct Rows(Patch, usize);

impl Banded for Rows {
    fn outline(&self) -> &Patch {
        &self.0
    }

    fn bands(&self, take: Taker<'_>) -> Result<(), WriteError> {
        self.0.points.chunks((self.1 * self.0.columns.count).max(1)).try_for_each(take)
    }
}

type Writer = fn(&Surfaces<'_>, &mut dyn Target) -> Result<(), WriteError>;

const WRITERS: [(&str, Writer); 7] = [
    ("CSV", |surfaces, out| write_csv(surfaces, out)),
    ("JSON", |surfaces, out| write_json(surfaces, out)),
    ("Parquet", |surfaces, out| write_parquet(surfaces, out)),
    ("STL", write_stl),
    ("OBJ", |surfaces, out| write_obj(surfaces, out)),
    ("3MF", |surfaces, out| write_3mf(surfaces, out)),
    ("VTK", write_vtp),
];

#[test]
fn bands_write_the_bytes_of_the_whole() {
    let bytes = |write: Writer, surfaces: &Surfaces<'_>| {
        let mut bytes = Cursor::new(Vec::new());
        write(surfaces, &mut bytes).expect("sound surfaces");
        bytes.into_inner()
    };
    for (name, dataset) in gallery() {
        let patches = dataset.patches.into_iter().map(with_fields).collect();
        let dataset = Dataset { patches, ..dataset };
        for rows in [1, 2, 3] {
            let banded: Vec<Rows> = dataset.patches.iter().map(|patch| Rows(patch.clone(), rows)).collect();
            let list = banded.iter().map(|rows| rows as &dyn Banded).collect();
            let banded = Surfaces { header: &dataset.header, list };
            for (format, write) in WRITERS {
                assert!(bytes(write, &banded) == bytes(write, &dataset.surfaces()), "{format} of {name}, {rows} rows");
            }
        }
    }
}

/// A surface that breaks off.
struct Broken(Patch);

impl Banded for Broken {
    fn outline(&self) -> &Patch {
        &self.0
    }

    fn bands(&self, take: Taker<'_>) -> Result<(), WriteError> {
        take(&self.0.points[..self.0.columns.count])
    }
}

#[test]
fn missing_rows_are_refused() {
    for (name, dataset) in gallery() {
        let Some(patch) = dataset.patches.first().filter(|patch| patch.points.len() > patch.columns.count) else {
            continue;
        };
        let broken = Broken(patch.clone());
        for (format, write) in WRITERS {
            let surfaces = Surfaces { header: &dataset.header, list: vec![&broken] };
            let ended = write(&surfaces, &mut Cursor::new(Vec::new()));
            assert!(matches!(ended, Err(WriteError::Malformed(_))), "{format} of {name}");
        }
    }
}
