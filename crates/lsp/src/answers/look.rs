//! Colours of words, values beside formulas, lenses above jobs.

use flank::{NameKind, WordClass, WordKind};
use gen_lsp_types::{
    CodeLens, CodeLensParams, Command, InlayHint, InlayHintParams, Label, SemanticToken, SemanticTokens,
    SemanticTokensLegend, SemanticTokensParams,
};

use crate::snapshot::Snapshot;

const TYPES: [&str; 15] = [
    "machine",
    "tool",
    "job",
    "function",
    "frame",
    "axis",
    "motion",
    "parameter",
    "value",
    "surface",
    "profile",
    "unit",
    "dimension",
    "property",
    "status",
];
const MODIFIERS: [&str; 2] = ["definition", "defaultLibrary"];

pub(crate) fn legend() -> SemanticTokensLegend {
    SemanticTokensLegend {
        token_types: TYPES.map(str::to_string).to_vec(),
        token_modifiers: MODIFIERS.map(str::to_string).to_vec(),
    }
}

fn type_of(class: WordClass) -> &'static str {
    match class {
        WordClass::Name(kind) => match kind {
            NameKind::Machine | NameKind::MachineInstance => "machine",
            NameKind::Tool | NameKind::ToolInstance => "tool",
            NameKind::Job => "job",
            NameKind::Function => "function",
            NameKind::Frame => "frame",
            NameKind::Axis | NameKind::NcWord => "axis",
            NameKind::Motion | NameKind::Unknown => "motion",
            NameKind::Parameter | NameKind::MachineError | NameKind::Argument | NameKind::SurfaceParameter => {
                "parameter"
            }
            NameKind::Value | NameKind::Coordinate => "value",
            NameKind::Profile | NameKind::Segment => "profile",
            NameKind::ToolSurface
            | NameKind::Surface
            | NameKind::Solid
            | NameKind::Contact
            | NameKind::Want
            | NameKind::Milling
            | NameKind::Sample => "surface",
        },
        WordClass::Word(kind) => match kind {
            WordKind::Function => "function",
            WordKind::Unit => "unit",
            WordKind::Dimension => "dimension",
            WordKind::Constant | WordKind::Coordinate | WordKind::Number => "value",
            WordKind::Argument | WordKind::Column => "property",
            WordKind::Status | WordKind::ErrorCode => "status",
        },
    }
}

pub(crate) fn tokens(snapshot: &Snapshot, params: SemanticTokensParams) -> Option<SemanticTokens> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let lines = opened.lines();
    let (mut data, mut line, mut column) = (Vec::new(), 0, 0);
    for word in opened.analysis.classified() {
        let range = lines.range(word.span.start, word.span.end);
        // a token stays on its line
        if range.start.line != range.end.line {
            continue;
        }
        let delta_line = range.start.line - line;
        let delta_start = if delta_line == 0 { range.start.character - column } else { range.start.character };
        (line, column) = (range.start.line, range.start.character);
        let of_language = matches!(word.class, WordClass::Word(_));
        data.push(SemanticToken {
            delta_line,
            delta_start,
            length: range.end.character - range.start.character,
            token_type: TYPES.iter().position(|name| *name == type_of(word.class)).unwrap_or(0) as u32,
            token_modifiers_bitset: u32::from(word.is_definition) | (u32::from(of_language) << 1),
        });
    }
    Some(SemanticTokens { result_id: None, data })
}

pub(crate) fn inlay_hints(snapshot: &Snapshot, params: InlayHintParams) -> Option<Vec<InlayHint>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let lines = opened.lines();
    let (from, to) = (lines.offset(params.range.start), lines.offset(params.range.end));
    let values = opened.analysis.inlay_values(from, to, snapshot.options.literal_values);
    let hint = values.into_iter().map(|inlay| InlayHint {
        position: lines.position(inlay.offset),
        label: Label::String(format!("= {}", inlay.value)),
        kind: None,
        text_edits: None,
        tooltip: None,
        padding_left: Some(true),
        padding_right: None,
        data: None,
    });
    Some(hint.collect())
}

pub(crate) fn lenses(snapshot: &Snapshot, params: CodeLensParams) -> Option<Vec<CodeLens>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let lines = opened.lines();
    let texts = opened.analysis.texts();
    let mut lenses = Vec::new();
    for job in opened.analysis.jobs() {
        let range = lines.range(job.span.start, job.span.end);
        let outcome = snapshot.solves.told(&opened.path, &job.name, texts);
        let solve = outcome.map_or("solve".to_string(), |outcome| format!("solve: {outcome}"));
        for (title, command) in [(solve.as_str(), "flank.solve"), ("view", "flank.preview"), ("report", "flank.report")]
        {
            let arguments = vec![params.text_document.uri.0.clone().into(), job.name.clone().into()];
            let command = Command {
                title: title.to_string(),
                tooltip: None,
                command: command.to_string(),
                arguments: Some(arguments),
            };
            lenses.push(CodeLens { range, command: Some(command), data: None });
        }
    }
    Some(lenses)
}
