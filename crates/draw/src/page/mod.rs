//! A page to look at a job with: one HTML file that needs no network.

mod body;
mod contact;
mod document;
mod milling;
mod scene;

use std::io::Write;

use document::Document;
use flank_export::Dataset;
use flank_export::WriteError;
use flank_export::text::escaped;

pub use body::{PageBody, PageFace};
pub use contact::{PageContact, PageMember, PageNumber, PageTouch};
pub use milling::{PageColumn, PageCut, PageMilling};
pub use scene::{
    PageAxis, PageFrame, PageJoint, PageMachine, PageMotion, PageParameter, PageSurface, PageTool, Revolution, Scene,
    ToolForm,
};

const HTML: &str = include_str!("web/page.html");
const STYLE: &str = include_str!("web/style.css");
/// The parts of three.js that the page uses, with its licence; `library/build.mjs` makes it.
const LIBRARY: &str = include_str!("library/three.min.js");
/// The page's own modules, each after those that it imports.
const MODULES: [&str; 17] = [
    include_str!("web/numbers.js"),
    include_str!("web/settings.js"),
    include_str!("web/newton.js"),
    include_str!("web/surface.js"),
    include_str!("web/colours.js"),
    include_str!("web/shading.js"),
    include_str!("web/machine.js"),
    include_str!("web/meshes.js"),
    include_str!("web/stage.js"),
    include_str!("web/panel.js"),
    include_str!("web/flat.js"),
    include_str!("web/pair.js"),
    include_str!("web/body.js"),
    include_str!("web/milling.js"),
    include_str!("web/hanging.js"),
    include_str!("web/controls.js"),
    include_str!("web/main.js"),
];

/// The end of a page that waits for its job.
const WAITING: &str = include_str!("web/waiting.js");
/// What a page may load: nothing.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";
/// What one that waits for its job may: that, from where it is itself.
const WAITING_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'self'; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'";

/// What a page has of its job alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageParts {
    /// JSON, for the page itself.
    pub data: String,
    /// The emitted functions, a module of JavaScript.
    pub functions: String,
}

impl PageParts {
    /// Of a dataset with the machine, the tools and the functions of a scene. The patches of the dataset are the surfaces of the scene, in
    /// the same order; those beyond are lines.
    ///
    /// # Errors
    /// When the dataset is malformed.
    pub fn of_scene(dataset: &Dataset, scene: &Scene) -> Result<PageParts, WriteError> {
        dataset.check()?;
        let data = serde_json::to_string(&Document::of_scene(dataset, scene)).map_err(std::io::Error::from)?;
        Ok(PageParts { data, functions: scene.functions.clone() })
    }
}

/// Writes the page of a dataset, by itself in one file; the parts of the scene are those of [`PageParts::of_scene`].
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_page(dataset: &Dataset, scene: &Scene, out: &mut dyn Write) -> Result<(), WriteError> {
    let PageParts { data, functions } = PageParts::of_scene(dataset, scene)?;
    let end = format!("start({{ {} }});\n", scene.function_names.join(", "));
    // in JSON a `<` stands in texts only; escaped, no text can end the element
    let data = data.replace('<', "\\u003c");
    write_html((&dataset.header.job, POLICY), &data, &[&[&*functions], &MODULES[..], &[&*end]].concat(), out)
}

/// Writes a page that waits for its job, whose parts are read from where the page itself was: a script calls `begin` in it with their
/// addresses.
///
/// # Errors
/// When the stream refuses.
pub fn write_waiting_page(out: &mut dyn Write) -> Result<(), WriteError> {
    write_html(("the next picture", WAITING_POLICY), "", &[&MODULES[..], &[WAITING]].concat(), out)
}

fn write_html(
    (title, policy): (&str, &str),
    data: &str,
    modules: &[&str],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    for part in HTML.split_inclusive('\n') {
        match part.trim() {
            "{{title}}" => writeln!(out, "<title>{} – flank</title>", escaped(title))?,
            "{{policy}}" => writeln!(out, "<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">")?,
            "{{style}}" => out.write_all(STYLE.as_bytes())?,
            "{{data}}" => writeln!(out, "{data}")?,
            "{{library}}" => out.write_all(LIBRARY.as_bytes())?,
            "{{script}}" => write_script(modules, out)?,
            _ => out.write_all(part.as_bytes())?,
        }
    }
    Ok(())
}

/// Modules as one: what they import from each other they then simply have.
fn write_script(modules: &[&str], out: &mut dyn Write) -> Result<(), WriteError> {
    for line in modules.iter().flat_map(|module| module.lines()).filter(|line| !line.starts_with("import ")) {
        writeln!(out, "{}", line.strip_prefix("export ").unwrap_or(line))?;
    }
    Ok(())
}
