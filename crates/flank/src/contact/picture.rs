//! What a picture of contacts is called, and what it says below.

use flank_draw::{ContactDrawing, ContactPicture, DrawnContact, MOST_CONTACTS};
use flank_export::Header;

use crate::contact::drawn::FILMS;
use crate::project::units::counted;

pub(crate) fn names(contacts: &[DrawnContact]) -> String {
    contacts.iter().take(MOST_CONTACTS).map(|contact| contact.name.as_str()).collect::<Vec<&str>>().join(", ")
}

pub(crate) fn about(kind: ContactPicture) -> &'static str {
    match kind {
        ContactPicture::Pattern => "contact pattern",
        ContactPicture::Error => "error over the roll",
        ContactPicture::Gap | ContactPicture::Overview => "least gap over the roll",
        ContactPicture::Path => "path of contact",
    }
}

/// What a picture of contacts shows, with its title and the sentences below it.
pub(crate) fn drawing(job: &str, contacts: Vec<DrawnContact>, kind: ContactPicture, header: Header) -> ContactDrawing {
    let title = format!("{job}: {} of {}", about(kind), names(&contacts));
    let film = contacts.first().map_or(String::new(), |contact| format!("{} \u{b5}m", contact.film));
    let is_line = contacts.iter().all(|contact| contact.flanks.iter().all(|flank| flank.path.is_empty()));
    let path = match is_line {
        true => "thin: the lines along which the flanks touch at one time",
        false => {
            "red: the path of contact, dashed where an edge touches; ring: the middle; dots: at this roll position one pair of teeth hands over to the next"
        }
    };
    let ellipses = if is_line { "" } else { "; thin: within the compound at one time" };
    let grey = "Grey: where the tooth ends.";
    let note = match kind {
        ContactPicture::Pattern => {
            format!("Blue: nearer than {film} to the mate at some time of the mesh; {path}{ellipses}. {grey}")
        }
        ContactPicture::Error => {
            "The error is what the contact adds to the wanted law of the driven member, from that of the middle; diamonds: one pair of \
             teeth hands over to the next."
                .to_string()
        }
        ContactPicture::Gap | ContactPicture::Overview => {
            let path = if is_line { String::new() } else { format!("; {path}") };
            format!("Least gap over the mesh of a pair of teeth, up to {FILMS} films of {film}; white: the edge of the film{path}. {grey}")
        }
        ContactPicture::Path => format!("At round roll positions, for a film of {film}; {path}{ellipses}. {grey}"),
    };
    let note = match contacts.len().saturating_sub(MOST_CONTACTS) {
        0 => note,
        more => format!("{note} {} not shown: choose by contact.", counted(more, "more contact")),
    };
    ContactDrawing { header, title, note, contacts }
}
