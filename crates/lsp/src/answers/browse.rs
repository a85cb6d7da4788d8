//! Hover, definitions, uses, the outline, folding.

use std::collections::BTreeSet;

use flank::{NameKind, OutlineItem, Reference, TextSpan};
use gen_lsp_types::{
    Contents, Definition, DefinitionParams, DefinitionResponse, DocumentSymbol, DocumentSymbolParams,
    DocumentSymbolResponse, FoldingRange, FoldingRangeKind, FoldingRangeParams, Hover, HoverParams, Location,
    MarkupContent, MarkupKind, ReferenceParams, SymbolKind,
};

use crate::position::Lines;
use crate::snapshot::Snapshot;

pub(crate) fn hover(snapshot: &Snapshot, params: HoverParams) -> Option<Hover> {
    let at = params.text_document_position_params;
    let opened = snapshot.opened(&at.text_document.uri)?;
    let found = opened.analysis.hover(opened.offset(at.position))?;
    let is_plain = snapshot.options.plain_text;
    let mut parts = vec![if is_plain { found.signature } else { format!("```chain\n{}\n```", found.signature) }];
    parts.extend(found.about);
    // most names have no parameters, and most specs no solves
    if !found.parameters.is_empty() && snapshot.solves.is_known_of(&opened.path) {
        let texts = opened.analysis.texts();
        let told = found.parameters.iter().filter_map(|name| snapshot.solves.influence(&opened.path, name, texts));
        parts.extend(told.map(str::to_string));
    }
    let kind = if is_plain { MarkupKind::PlainText } else { MarkupKind::Markdown };
    let value = if is_plain { parts.join("\n\n").replace('`', "") } else { parts.join("\n\n") };
    let contents = Contents::MarkupContent(MarkupContent { kind, value });
    Some(Hover { contents, range: snapshot.places(&opened.analysis).range(&found.span) })
}

pub(crate) fn definition(snapshot: &Snapshot, params: DefinitionParams) -> Option<DefinitionResponse> {
    let at = params.text_document_position_params;
    let opened = snapshot.opened(&at.text_document.uri)?;
    let found = opened.analysis.definition(opened.offset(at.position))?;
    let location = snapshot.places(&opened.analysis).location(&found)?;
    Some(DefinitionResponse::Definition(Definition::Location(location)))
}

pub(crate) fn references(snapshot: &Snapshot, params: ReferenceParams) -> Option<Vec<Location>> {
    let at = params.text_document_position_params;
    let opened = snapshot.opened(&at.text_document.uri)?;
    let definition = opened.analysis.first_definition(opened.offset(at.position))?;
    let all = all_references(snapshot, &definition);
    let wanted = all.into_iter().filter(|(found, _)| params.context.include_declaration || !found.is_definition);
    Some(wanted.map(|(_, location)| location).collect())
}

/// All places of all open specs that lead to a definition, each once.
pub(super) fn all_references(snapshot: &Snapshot, definition: &TextSpan) -> Vec<(Reference, Location)> {
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    for path in snapshot.documents.paths() {
        let analysis = snapshot.analysis(path);
        let places = snapshot.places(&analysis);
        for found in analysis.references(definition) {
            if seen.insert(found.clone())
                && let Some(location) = places.location(&found.span)
            {
                all.push((found, location));
            }
        }
    }
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

pub(crate) fn symbols(snapshot: &Snapshot, params: DocumentSymbolParams) -> Option<DocumentSymbolResponse> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let lines = opened.lines();
    let all = opened.analysis.outline();
    let all = all.iter().map(|item| document_symbol(item, &lines)).collect();
    Some(DocumentSymbolResponse::DocumentSymbolList(all))
}

fn document_symbol(item: &OutlineItem, lines: &Lines<'_>) -> DocumentSymbol {
    let inside: Vec<DocumentSymbol> = item.inside.iter().map(|inner| document_symbol(inner, lines)).collect();
    #[expect(deprecated, reason = "a field of the protocol that has to be left out by name")]
    DocumentSymbol {
        name: item.name.clone(),
        detail: Some(item.detail.clone()),
        kind: symbol_kind(item.kind),
        tags: None,
        deprecated: None,
        range: lines.range(item.extent.start, item.extent.end),
        selection_range: lines.range(item.span.start, item.span.end),
        children: (!inside.is_empty()).then_some(inside),
    }
}

fn symbol_kind(kind: NameKind) -> SymbolKind {
    match kind {
        NameKind::Machine | NameKind::Tool => SymbolKind::Class,
        NameKind::Job => SymbolKind::Module,
        NameKind::Function => SymbolKind::Function,
        NameKind::Parameter | NameKind::MachineError | NameKind::Argument | NameKind::SurfaceParameter => {
            SymbolKind::Property
        }
        NameKind::Value | NameKind::Coordinate => SymbolKind::Constant,
        NameKind::Axis | NameKind::Motion | NameKind::Unknown => SymbolKind::Variable,
        NameKind::Frame => SymbolKind::Namespace,
        NameKind::NcWord => SymbolKind::Key,
        NameKind::MachineInstance | NameKind::ToolInstance => SymbolKind::Object,
        NameKind::Profile
        | NameKind::Segment
        | NameKind::ToolSurface
        | NameKind::Surface
        | NameKind::Solid
        | NameKind::Sample => SymbolKind::Struct,
        NameKind::Contact | NameKind::Want | NameKind::Milling => SymbolKind::Event,
    }
}

pub(crate) fn folding(snapshot: &Snapshot, params: FoldingRangeParams) -> Option<Vec<FoldingRange>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let folds = opened.analysis.folds().into_iter().map(|fold| FoldingRange {
        start_line: fold.first as u32,
        end_line: fold.last as u32,
        kind: fold.is_comment.then_some(FoldingRangeKind::Comment),
        ..FoldingRange::default()
    });
    Some(folds.collect())
}
