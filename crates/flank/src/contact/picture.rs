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
    let film = contacts.first().map_or(0.0, |contact| contact.film);
    let path = "red the path of contact, dashed where an edge touches";
    let note = match kind {
        ContactPicture::Pattern => format!(
            "Blue: nearer to the mate than {film} um of compound at some time of the mesh; {path}; ring: the middle; dots: one pair of \
             teeth hands over to the next; thin: where the flanks are within the compound at one time."
        ),
        ContactPicture::Error => {
            "The error is what the contact adds to the wanted law of the driven member, from that of the middle; diamonds: one pair of \
             teeth hands over to the next."
                .to_string()
        }
        ContactPicture::Gap | ContactPicture::Overview => format!(
            "Least gap to the mate over the whole mesh of a pair of teeth, up to {FILMS} films of {film} um; thick line: the edge of the \
             compound; {path}."
        ),
        ContactPicture::Path => format!(
            "{}{}; thin: where the flanks are within {film} um of each other at the roll position that stands there; ring: the middle; \
             dots: one pair of teeth hands over to the next.",
            path[..1].to_uppercase(),
            &path[1..]
        ),
    };
    let note = match contacts.len().saturating_sub(MOST_CONTACTS) {
        0 => note,
        more => format!("{note} {} not shown: choose by contact.", counted(more, "more contact")),
    };
    ContactDrawing { header, title, note, contacts }
}
