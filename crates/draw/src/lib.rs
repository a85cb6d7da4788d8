//! Pictures, reports and pages of solved tooth surfaces: SVG and PNG, HTML and Markdown, one HTML file with everything in it.
//!
//! What is drawn is a [`flank_export::Dataset`]; this crate knows nothing of how its points were solved.

mod base64;
mod page;
mod picture;
mod report;

pub use page::{
    PageAxis, PageBody, PageColumn, PageContact, PageCut, PageFace, PageFrame, PageJoint, PageMachine, PageMember,
    PageMilling, PageMotion, PageNumber, PageParameter, PageParts, PageSurface, PageTool, PageTouch, Revolution, Scene,
    ToolForm, write_page, write_waiting_page,
};
pub use picture::{
    ContactDrawing, ContactMark, ContactPicture, DrawnContact, DrawnFlank, DrawnFrame, ErrorCurves, GearDrawing,
    GearFace, GearFaceKind, LinkKind, MOST_CONTACTS, MachineDrawing, MachineLink, MilledPairDrawing, MillingDrawing,
    PassChart, Picture, PictureError, PictureOptions, RidgeSection, Section, SectionCircle, SectionLine, Station,
    StationShape, ToolPosition, TraceChart, TraceDrawing, axis_positions, comparable_maps, contact, deviation_map,
    field_lines, field_maps, gear, machine, milled_pair, milling, picture, round_step, section, topography, traces,
};
pub use report::{
    Block, Column, Figure, Kind, Report, Section as ReportSection, Tone, write_report_html, write_report_markdown,
};
