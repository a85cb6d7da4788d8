//! `flank import`

use flank::{Disk, ImportRequest, import};

use crate::arguments::{Coefficients, Import, Signs};
use crate::failure::Failure;
use crate::{Ending, document, eprint, print};

pub(crate) fn run(arguments: &Import) -> Result<Ending, Failure> {
    let request = ImportRequest {
        file: arguments.file.clone(),
        signs: match arguments.signs {
            Signs::Frames => flank::Signs::Frames,
            Signs::LeftHandPinion => flank::Signs::LeftHandPinion,
            Signs::RightHandGear => flank::Signs::RightHandGear,
        },
        coefficients: arguments.coefficients.map(|coefficients| match coefficients {
            Coefficients::Taylor => flank::Coefficients::Taylor,
            Coefficients::Polynomial => flank::Coefficients::Polynomial,
        }),
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
