//! `flank import`

use flank::{Disk, ImportRequest, import};

use crate::arguments::Import;
use crate::failure::Failure;
use crate::{Ending, document, eprint, print};

pub(crate) fn run(arguments: &Import) -> Result<Ending, Failure> {
    let request = ImportRequest {
        file: arguments.file.clone(),
        signs: arguments.signs,
        coefficients: arguments.coefficients,
        settings: arguments.settings.clone(),
        outside: arguments.outside.clone(),
        inside: arguments.inside.clone(),
        name: arguments.name.clone(),
        library: arguments.library.clone(),
    };
    let imported = import(&Disk, &request)?;
    imported.doubts.iter().for_each(|doubt| eprint(&format!("note: {}: {doubt}\n", imported.file)));
    print(&if arguments.json { document::text(&imported) } else { imported.text });
    Ok(Ending::Done)
}
