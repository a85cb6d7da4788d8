//! A machine summary of another program becomes a job.

use std::fmt::Write;
use std::path::PathBuf;

use flank_chain_dsl::{Files, Sources, read_other_file};
use roxmltree::{Document, Node, ParsingOptions};
use schemars::JsonSchema;
use serde::Serialize;

use crate::exchange::{library, xml_cost};
use crate::project::choices::choices;
use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::shown_path;

/// Which job is made of a REXS file.
#[derive(Clone, Debug)]
pub struct ImportRequest {
    /// The REXS file.
    pub file: PathBuf,
    /// In which frames the file's signs are; REXS does not say.
    pub signs: Signs,
    /// What the coefficients of motions multiply; REXS does not say.
    pub coefficients: Option<Coefficients>,
    /// The id of the `bevel_gear_manufacturing_settings`, where the file holds several.
    pub settings: Option<String>,
    /// The id of the `bevel_gear_tool` with the outside blades.
    pub outside: Option<String>,
    /// The id of the `bevel_gear_tool` with the inside blades.
    pub inside: Option<String>,
    /// The name of the job.
    pub name: String,
    /// Where the library lies, seen from the job's file.
    pub library: String,
}

choices! {
    /// In which frames the signs of a file are.
    Signs {
        /// As they are in the file, taken for those of the frames of `cradle_generator`.
        Frames = "frames",
        /// Of machine summaries: tilt, swivel and cradle angle of a left-hand pinion are reversed.
        LeftHandPinion = "left-hand-pinion",
        /// Of machine summaries: tilt and work offset of a right-hand gear are reversed.
        RightHandGear = "right-hand-gear",
    }
}

choices! {
    /// What coefficients of motions are.
    Coefficients {
        /// To be divided by the factorials.
        Taylor = "taylor",
        /// Of powers of the roll.
        Polynomial = "polynomial",
    }
}

/// A job made of a machine summary, of `flank import`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.import/2")]
pub struct Imported {
    /// The REXS file, as it was given, with forward slashes.
    pub file: String,
    /// Its name.
    pub job: String,
    /// Of the job's file.
    pub text: String,
    /// What is doubtful about the file.
    #[serde(skip)]
    pub doubts: Vec<String>,
}

/// No REXS file is larger.
const MOST_BYTES: usize = 16 << 20;

const SETTINGS: &str = "bevel_gear_manufacturing_settings";
const TOOL: &str = "bevel_gear_tool";
/// The files of the library that a job uses.
const LIBRARY: [&str; 2] = ["machines/cradle.chain", "tools/face_mill.chain"];

/// The versions of REXS whose names and units these are.
const VERSIONS: [(u32, u32); 2] = [(1, 3), (1, 6)];
/// A text of the file goes into a comment so far.
const MOST_LETTERS: usize = 200;
/// So many components are listed.
const MOST_LISTED: usize = 16;

/// Settings with one value: attribute, setting of `cradle_generator`, unit, and whether the file may leave it out as zero.
const VALUES: [(&str, &str, &str, bool); 9] = [
    ("radial_distance", "radial_distance", "mm", false),
    ("center_roll_position", "cradle_angle", "deg", false),
    ("cutter_tilt", "cutter_tilt", "deg", true),
    ("cutter_swivel", "cutter_swivel", "deg", true),
    ("work_offset", "work_offset", "mm", true),
    ("sliding_base", "sliding_base", "mm", true),
    ("machine_root_angle", "machine_root_angle", "deg", false),
    ("machine_center_to_crossing_point", "machine_center_to_crossing_point", "mm", true),
    ("ratio_of_roll", "ratio_of_roll", "", false),
];
/// Coefficients of motions: attribute, the settings from the lowest order on, that order, unit.
const MOTIONS: [(&str, &[&str], u32, &str); 6] = [
    ("radial_motion_coefficients", &orders::RADIAL, 1, "mm"),
    ("tilt_motion_coefficients", &orders::TILT, 1, "rad"),
    ("swivel_motion_coefficients", &orders::SWIVEL, 1, "rad"),
    ("vertical_motion_coefficients", &orders::VERTICAL, 1, "mm"),
    ("helical_motion_coefficients", &orders::HELICAL, 1, "mm"),
    ("modified_roll_coefficients", &orders::ROLL, 2, ""),
];
/// Attributes of motions that the generator of the library does not have.
const NOT_THERE: [&str; 3] = ["horizontal_distance", "horizontal_motion_coefficients", "angular_motion_coefficients"];

/// Attributes of a tool that make its face mill.
const OF_TOOL: [&str; 5] = [
    "blade_point_radius",
    "blade_pressure_angle",
    "tool_edge_radius_bevel_gear_tool",
    "blade_spheric_radius",
    "blade_profile_height",
];
/// Attributes of profiles that a face mill does not have.
const RELIEVED: [&str; 2] = ["protuberance_height_bevel_gear_tool", "tip_relief_height_bevel_gear_tool"];

/// Names of the settings, by the order of their coefficient.
mod orders {
    macro_rules! six {
        ($name:ident, $motion:literal) => {
            pub(super) const $name: [&str; 6] = [
                concat!($motion, "_1"),
                concat!($motion, "_2"),
                concat!($motion, "_3"),
                concat!($motion, "_4"),
                concat!($motion, "_5"),
                concat!($motion, "_6"),
            ];
        };
    }
    six!(RADIAL, "radial_motion");
    six!(TILT, "tilt_motion");
    six!(SWIVEL, "swivel_motion");
    six!(VERTICAL, "vertical_motion");
    six!(HELICAL, "helical_motion");
    pub(super) const ROLL: [&str; 6] = [
        "modified_roll_2c",
        "modified_roll_6d",
        "modified_roll_24e",
        "modified_roll_120f",
        "modified_roll_720g",
        "modified_roll_5040h",
    ];
}

/// Makes a job of the bevel gear's machine summary in a REXS file.
///
/// # Errors
/// If the file cannot be read, is no REXS file or lacks what the job needs; if no tool is named; if the library has something of the job's
/// name.
pub fn import(files: &dyn Files, request: &ImportRequest) -> Result<Imported, Failure> {
    let file = shown_path(&request.file);
    check_name(&request.name)?;
    let mut sources = Sources::default();
    let text = read_other_file(files, &mut sources, &request.file, MOST_BYTES)
        .map_err(|finding| Failure::Findings(Findings::new(&[finding], &sources)))
        .map(|id| sources.file(id).text.clone());
    if request.outside.is_none() && request.inside.is_none() {
        return Err(without_tools(text.ok().as_deref()));
    }
    let mut doubts = Vec::new();
    let text = job(&text?, &file, request, &mut doubts)?;
    Ok(Imported { file, job: request.name.clone(), text, doubts })
}

/// # Errors
/// In words, if the library that the job uses has something of its name.
fn check_name(name: &str) -> Result<(), Failure> {
    match LIBRARY.into_iter().find(|path| library::defines(path, name)) {
        Some(path) => {
            let message =
                format!("the job cannot be called `{name}`: {path}, which it uses, has something of that name");
            Err(Failure::Request(message))
        }
        None => Ok(()),
    }
}

/// The message about a command line without tools, with those of the file if it can be read.
fn without_tools(text: Option<&str>) -> Failure {
    let document = text.and_then(|text| parsed(text).ok());
    let tools: Vec<_> = document.iter().flat_map(|document| Component::all(document.root_element(), TOOL)).collect();
    let known = if tools.is_empty() { String::new() } else { format!("; there is: {}", listed(&tools)) };
    Failure::Request(format!(
        "say which tool has which blades: option `outside` for the concave flank, option `inside` for the convex one{known}"
    ))
}

/// A text as XML, within limits of what that costs.
fn parsed(text: &str) -> Result<Document<'_>, String> {
    xml_cost::check(text)?;
    let options = ParsingOptions { nodes_limit: xml_cost::NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => {
            format!("there are more than {} elements and texts, more than any REXS file needs", xml_cost::NODES)
        }
        error => format!("this is not XML: {error}"),
    })
}

/// The job that a REXS file describes, as text.
fn job(text: &str, file: &str, arguments: &ImportRequest, doubts: &mut Vec<String>) -> Result<String, Failure> {
    let document = parsed(text).map_err(|reason| Failure::Input(format!("{file}: {reason}")))?;
    let model = document.root_element();
    if model.tag_name().name() != "model" {
        let first = on_one_line(model.tag_name().name());
        let message = format!("{file} is no REXS file: it begins with `{first}`, not with `model`");
        return Err(Failure::Input(message));
    }
    let settings =
        Component::one(model, SETTINGS, arguments.settings.as_deref(), "settings").map_err(Failure::Input)?;
    let tools = [("outside", &arguments.outside, "concave"), ("inside", &arguments.inside, "convex")];
    let version = model.attribute("version").map_or("without a version".to_string(), on_one_line);
    // not the folder, which is another one on every machine
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy();
    let mut out = format!("//! From {}, REXS {version}, {}.\n", on_one_line(&name), settings.described());
    if let Some(doubt) = unknown_version(model.attribute("version")) {
        let _ = writeln!(out, "//! Note: {doubt}.");
        doubts.push(doubt);
    }
    let _ = writeln!(out, "//! Signs: {}.", said(arguments.signs));
    let machine = machine(&settings, arguments, &mut out).map_err(Failure::Input)?;
    let known: Vec<&str> = VALUES.iter().map(|value| value.0).chain(MOTIONS.iter().map(|motion| motion.0)).collect();
    settings.tell_unused(&known, &mut out);
    let mut chosen = Vec::new();
    for (blades, id, flank) in tools {
        let Some(id) = id else { continue };
        let tool = Component::one(model, TOOL, Some(id), blades).map_err(Failure::Input)?;
        tool.tell_unused(&OF_TOOL, &mut out);
        chosen.push((blades, tool, flank));
    }
    let _ = write!(
        out,
        "\nuse \"{0}/{1}\"\nuse \"{0}/{2}\"\n\njob {3} {{\n{machine}",
        arguments.library, LIBRARY[0], LIBRARY[1], arguments.name
    );
    let mut surfaces = String::new();
    for (blades, tool, flank) in chosen {
        let _ = write!(
            out,
            "\n    // {}\n    tool {blades}_blades = {}",
            tool.described(),
            cutter(&tool).map_err(Failure::Input)?
        );
        let _ = writeln!(out, "    mount {blades}_blades on m.cutter");
        let _ = writeln!(surfaces, "    surface {flank} in m.work = envelope({blades}_blades.{blades}, over: roll)");
    }
    let _ = write!(out, "\n    motion roll : angle in -30 deg .. 30 deg\n    drive m.roll = roll\n\n{surfaces}}}\n");
    Ok(out)
}

fn said(signs: Signs) -> &'static str {
    match signs {
        Signs::Frames => "as they are in the file, taken for those of the frames of cradle_generator",
        Signs::LeftHandPinion => {
            "left-hand-pinion: cutter_tilt, cutter_swivel and center_roll_position times -1, coefficients of motions as they are"
        }
        Signs::RightHandGear => {
            "right-hand-gear: cutter_tilt and work_offset times -1, coefficients of motions as they are"
        }
    }
}

/// Whether a constant is reversed. Of coefficients none is: in the published system that these two sets of signs are those of, they count along
/// the roll of this machine.
fn is_reversed(signs: Signs, attribute: &str) -> bool {
    match signs {
        Signs::Frames => false,
        Signs::LeftHandPinion => ["cutter_tilt", "cutter_swivel", "center_roll_position"].contains(&attribute),
        Signs::RightHandGear => ["cutter_tilt", "work_offset"].contains(&attribute),
    }
}

/// The machine with its settings; how coefficients are scaled goes to the head of the file.
fn machine(settings: &Component<'_, '_>, arguments: &ImportRequest, head: &mut String) -> Result<String, String> {
    for attribute in NOT_THERE {
        if settings.coefficients(attribute)?.iter().any(|value| *value != 0.0) {
            return Err(format!(
                "{}: `{attribute}` is not zero, and cradle_generator has no such motion",
                settings.described()
            ));
        }
    }
    let mut lines = Vec::new();
    for (attribute, setting, unit, may_miss) in VALUES {
        match settings.number(attribute, unit)? {
            Some(value) => {
                let value = if is_reversed(arguments.signs, attribute) && value != 0.0 { -value } else { value };
                lines.push(format!("        {setting}: {value:?}{}", spaced(unit)));
            }
            None if may_miss => {}
            None => return Err(format!("{} has no `{attribute}`", settings.described())),
        }
    }
    for (attribute, names, lowest, unit) in MOTIONS {
        let values = settings.coefficients(attribute)?;
        if values.iter().all(|value| *value == 0.0) {
            continue;
        }
        let Some(meaning) = arguments.coefficients else {
            return Err(format!(
                "{}: `{attribute}` is not zero; say what its numbers are, for REXS does not: option `coefficients taylor` or option `coefficients polynomial`",
                settings.described()
            ));
        };
        if let Some(beyond) = values.iter().skip(names.len()).position(|value| *value != 0.0) {
            let order = lowest as usize + names.len() + beyond;
            return Err(format!(
                "{}: `{attribute}` goes up to order {order}, cradle_generator does not",
                settings.described()
            ));
        }
        for ((value, name), order) in values.iter().zip(names).zip(lowest..) {
            let scale = match meaning {
                Coefficients::Taylor => 1.0,
                Coefficients::Polynomial => (1..=order).map(f64::from).product(),
            };
            let _ = writeln!(head, "//! {attribute}, order {order}: {value:?} times {scale} is {name}.");
            lines.push(format!("        {name}: {:?}{}", value * scale, spaced(unit)));
        }
    }
    Ok(format!("    machine m = cradle_generator(\n{}\n    )\n", lines.join(",\n")))
}

fn cutter(tool: &Component<'_, '_>) -> Result<String, String> {
    for attribute in RELIEVED {
        if tool.coefficients(attribute)?.iter().any(|value| *value != 0.0) {
            return Err(format!(
                "{}: `{attribute}` is not zero, and these blades have one profile; face_mill_relieved has a toprem and a flankrem",
                tool.described()
            ));
        }
    }
    let needed = |attribute: &str, unit| {
        tool.number(attribute, unit)?.ok_or(format!("{} has no `{attribute}`", tool.described()))
    };
    let radius = needed("blade_point_radius", "mm")?;
    let angle = needed("blade_pressure_angle", "deg")?;
    let edge = needed("tool_edge_radius_bevel_gear_tool", "mm")?;
    if angle < 0.0 {
        return Err(format!(
            "{}: blade_pressure_angle is {angle} deg; a blade angle counts from the cutter's axis and is positive for inside and \
             outside blades",
            tool.described()
        ));
    }
    let mut lines = vec![
        format!("outside_point_radius: {radius:?} mm"),
        format!("inside_point_radius: {radius:?} mm"),
        format!("blade_angle: {angle:?} deg"),
        format!("edge_radius: {edge:?} mm"),
    ];
    // of a straight blade it may be zero
    let curved = tool.number("blade_spheric_radius", "mm")?.filter(|radius| *radius != 0.0);
    if let Some(sphere) = curved.filter(|sphere| *sphere < 0.0) {
        return Err(format!(
            "{}: blade_spheric_radius is {sphere} mm; a curved blade of face_mill has a positive one, and what a negative one is REXS does \
             not say",
            tool.described()
        ));
    }
    lines.extend(curved.map(|sphere| format!("blade_radius: {sphere:?} mm")));
    match (tool.number("blade_profile_height", "mm")?, curved) {
        (Some(height), None) => lines.push(format!("blade_height: {height:?} mm")),
        (Some(height), Some(sphere)) => {
            let length = length_of_blade(height, (angle.to_radians(), sphere, edge)).ok_or_else(|| {
                format!(
                    "{}: an arc of {sphere} mm does not reach the blade_profile_height {height} mm",
                    tool.described()
                )
            })?;
            lines.push(format!("blade_length: {length:?} mm"));
        }
        (None, _) => {}
    }
    let kind = if curved.is_some() { "face_mill" } else { "face_mill_straight" };
    Ok(format!("{kind}(\n        {}\n    )\n", lines.join(",\n        ")))
}

/// How long the profile of a curved blade is up to a height over the plane of the tips: the rounding of the edge and the arc. `None` if the
/// arc does not come so high, or the rounding goes beyond.
fn length_of_blade(height: f64, (blade_angle, blade_radius, edge_radius): (f64, f64, f64)) -> Option<f64> {
    // angles of the arc, from the direction in which the cutter's radius grows
    let over = blade_radius * blade_angle.sin();
    let touching = ((over + edge_radius) / (blade_radius + edge_radius)).asin();
    let end = ((over + height) / blade_radius).asin();
    // the difference of angles that hardly differ, of blades that are nearly straight
    let turn = |height: f64, to: f64| 2.0 * (height / (2.0 * blade_radius * (0.5 * (blade_angle + to)).cos())).asin();
    let edge_height = edge_radius * blade_radius * (1.0 - blade_angle.sin()) / (blade_radius + edge_radius);
    let arc = blade_radius * (turn(height, end) - turn(edge_height, touching));
    let edge = edge_radius * (std::f64::consts::FRAC_PI_2 - touching);
    (arc > 0.0).then_some(edge + arc)
}

/// A text of the file as it may stand in a comment: nothing in it ends the line, and no line is endless.
fn on_one_line(text: &str) -> String {
    match text.char_indices().nth(MOST_LETTERS) {
        Some((end, _)) => text[..end].replace(char::is_control, " ") + "…",
        None => text.replace(char::is_control, " "),
    }
}

/// The message about a file in a version of REXS that this is not made for.
fn unknown_version(version: Option<&str>) -> Option<String> {
    let number = |version: &str| {
        let (major, minor) = version.trim().split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    };
    let [first, last] = VERSIONS;
    let found = version.and_then(number);
    if found.is_some_and(|found| (first..=last).contains(&found)) {
        return None;
    }
    let own = version.map_or("no version of REXS".to_string(), |version| format!("REXS {}", on_one_line(version)));
    Some(format!(
        "it states {own}, and names and units are read as those of REXS {}.{} to {}.{}: compare the settings with the sheet",
        first.0, first.1, last.0, last.1
    ))
}

/// Components in a message.
fn listed(components: &[Component<'_, '_>]) -> String {
    let shown: Vec<String> = components.iter().take(MOST_LISTED).map(Component::described).collect();
    let more = components.len() - shown.len();
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// A component of a REXS model.
#[derive(Clone, Copy)]
struct Component<'a, 'i>(Node<'a, 'i>);

impl<'a, 'i> Component<'a, 'i> {
    fn all(model: Node<'a, 'i>, kind: &str) -> impl Iterator<Item = Component<'a, 'i>> {
        let is_one = move |node: &Node<'_, '_>| node.has_tag_name("component") && node.attribute("type") == Some(kind);
        model.descendants().filter(is_one).map(Component)
    }

    /// The one that is named, or the only one of its kind.
    fn one(model: Node<'a, 'i>, kind: &str, id: Option<&str>, option: &str) -> Result<Component<'a, 'i>, String> {
        let all: Vec<Component<'a, 'i>> = Component::all(model, kind).collect();
        let known = || listed(&all);
        match (id, all.as_slice()) {
            (_, []) => Err(format!("there is no component `{kind}` in the file")),
            (None, [only]) => Ok(*only),
            (None, _) => Err(format!(
                "there are several components `{kind}`; say which by its id, option `{option}`: {}",
                known()
            )),
            (Some(id), _) => {
                let own: Vec<_> = all.iter().filter(|component| component.0.attribute("id") == Some(id)).collect();
                match own[..] {
                    [one] => Ok(*one),
                    [] => Err(format!("there is no `{kind}` with the id {id}; there is: {}", known())),
                    [first, second, ..] => Err(format!(
                        "there are several `{kind}` with the id {id}, in lines {} and {}: which one is meant?",
                        line(first.0),
                        line(second.0)
                    )),
                }
            }
        }
    }

    fn described(&self) -> String {
        let said = |attribute: &str| self.0.attribute(attribute).map(on_one_line);
        let name = said("name").map(|name| format!(" ({name})"));
        let [kind, id] = [("type", "component"), ("id", "?")].map(|(of, none)| said(of).unwrap_or(none.to_string()));
        format!("{kind} {id}{}", name.unwrap_or_default())
    }

    /// # Errors
    /// If it stands there several times, and not as the same.
    fn attribute(&self, name: &str) -> Result<Option<Node<'a, 'i>>, String> {
        let is_meant = |node: &Node<'_, '_>| node.has_tag_name("attribute") && node.attribute("id") == Some(name);
        let mut all = self.0.children().filter(is_meant);
        let Some(first) = all.next() else { return Ok(None) };
        let said = |node: Node<'a, 'i>| {
            let parts = node.descendants().flat_map(|node| [node.attribute("unit"), node.attribute("code")]);
            (parts.collect::<Vec<_>>(), words(node))
        };
        match all.find(|other| said(*other) != said(first)) {
            None => Ok(Some(first)),
            Some(other) => Err(format!(
                "{}: `{name}` is there twice, in line {} as `{}` and in line {} as `{}`: which one is meant?",
                self.described(),
                line(first),
                on_one_line(&words(first).join(" ")),
                line(other),
                on_one_line(&words(other).join(" "))
            )),
        }
    }

    /// A number in the unit that is wanted; other units are refused.
    fn number(&self, name: &str, unit: &str) -> Result<Option<f64>, String> {
        let Some(node) = self.attribute(name)? else { return Ok(None) };
        let given = match node.attribute("unit").unwrap_or("none") {
            "°" => "deg",
            "none" => "",
            other => other,
        };
        if given != unit {
            let wanted = if unit.is_empty() { "none" } else { unit };
            let given = match given {
                "" => "without a unit".to_string(),
                given => format!("in {}", on_one_line(given)),
            };
            return Err(format!("{}: `{name}` is given {given}, REXS has it in {wanted}", self.described()));
        }
        self.parsed(name, node.text().unwrap_or_default()).map(Some)
    }

    /// Writes which of the attributes are not known, and what they are.
    fn tell_unused(&self, known: &[&str], out: &mut String) {
        let attributes = self.0.children().filter(|node| node.has_tag_name("attribute"));
        let of = self.described();
        for node in attributes {
            let name = on_one_line(node.attribute("id").unwrap_or("?"));
            let words = words(node);
            if !known.contains(&name.as_str()) && !words.is_empty() {
                let unit = node.attribute("unit").filter(|unit| *unit != "none").unwrap_or_default();
                let value = format!("{} {}", on_one_line(&words.join(" ")), on_one_line(unit));
                let _ = writeln!(out, "//! Not used of {of}: {name}, {}.", value.trim_end());
            }
        }
    }

    /// The numbers of an array, or a single one; none if it is not there.
    fn coefficients(&self, name: &str) -> Result<Vec<f64>, String> {
        let Some(node) = self.attribute(name)? else { return Ok(Vec::new()) };
        let array = node.children().find(|inner| inner.has_tag_name("array"));
        if let Some((array, code)) = array.and_then(|array| Some((array, array.attribute("code")?))) {
            let text: String = array.text().unwrap_or_default().split_whitespace().collect();
            return coded(&text, code).ok_or_else(|| {
                let [code, text] = [code, text.as_str()].map(on_one_line);
                format!("{}: `{name}` is no array of {code} in Base64: `{text}`", self.described())
            });
        }
        let cells: Vec<&str> = node
            .descendants()
            .filter(|cell| cell.has_tag_name("c"))
            .map(|cell| cell.text().unwrap_or_default())
            .collect();
        let texts = if cells.is_empty() { vec![node.text().unwrap_or_default()] } else { cells };
        texts.into_iter().filter(|text| !text.trim().is_empty()).map(|text| self.parsed(name, text)).collect()
    }

    fn parsed(&self, name: &str, text: &str) -> Result<f64, String> {
        let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| {
            format!("{}: `{name}` is `{}`, which is no number", self.described(), on_one_line(text.trim()))
        })
    }
}

/// What stands in an element.
fn words<'a>(node: Node<'a, '_>) -> Vec<&'a str> {
    let texts = node.descendants().filter(Node::is_text).filter_map(|text| text.text());
    texts.flat_map(str::split_whitespace).collect()
}

/// Where an element stands in the file.
fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// The numbers of a coded array: Base64 of little-endian numbers, one after the other.
fn coded(text: &str, code: &str) -> Option<Vec<f64>> {
    let bytes = base64(text)?;
    let numbers: Vec<f64> = match code {
        "float64" => bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect(),
        "float32" => bytes.as_chunks().0.iter().map(|chunk| f64::from(f32::from_le_bytes(*chunk))).collect(),
        "int32" => bytes.as_chunks().0.iter().map(|chunk| f64::from(i32::from_le_bytes(*chunk))).collect(),
        _ => return None,
    };
    let size = if code == "float64" { 8 } else { 4 };
    (numbers.len() * size == bytes.len() && numbers.iter().all(|number| number.is_finite())).then_some(numbers)
}

/// The bytes of a text in Base64 with its padding.
fn base64(text: &str) -> Option<Vec<u8>> {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text.trim_end_matches('=');
    if !text.len().is_multiple_of(4) || text.len() - digits.len() > 2 {
        return None;
    }
    let (mut bits, mut held, mut bytes) = (0u32, 0, Vec::new());
    for digit in digits.bytes() {
        let value = DIGITS.iter().position(|known| *known == digit)?;
        bits = bits << 6 | u32::try_from(value).ok()?;
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push(u8::try_from(bits >> held & 0xff).ok()?);
        }
    }
    Some(bytes)
}
