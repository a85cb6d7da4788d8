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

/// Writes the page of a dataset with the machine, the tools and the functions of a scene. The patches of the dataset are the
/// surfaces of the scene, in the same order; those beyond are lines.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_page(dataset: &Dataset, scene: &Scene, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    let document = serde_json::to_string(&Document::of_scene(dataset, scene)).map_err(std::io::Error::from)?;
    for part in HTML.split_inclusive('\n') {
        match part.trim() {
            "{{title}}" => writeln!(out, "<title>{} – flank</title>", escaped(&dataset.header.job))?,
            "{{style}}" => out.write_all(STYLE.as_bytes())?,
            // in JSON a `<` stands in texts only; escaped, no text can end the element
            "{{data}}" => writeln!(out, "{}", document.replace('<', "\\u003c"))?,
            "{{library}}" => out.write_all(LIBRARY.as_bytes())?,
            "{{script}}" => write_script(scene, out)?,
            _ => out.write_all(part.as_bytes())?,
        }
    }
    Ok(())
}

/// The emitted functions and the page's modules as one: what they import from each other they then simply have.
fn write_script(scene: &Scene, out: &mut dyn Write) -> Result<(), WriteError> {
    for module in [&*scene.functions].into_iter().chain(MODULES) {
        for line in module.lines().filter(|line| !line.starts_with("import ")) {
            writeln!(out, "{}", line.strip_prefix("export ").unwrap_or(line))?;
        }
    }
    writeln!(out, "start({{ {} }});", scene.function_names.join(", "))?;
    Ok(())
}
