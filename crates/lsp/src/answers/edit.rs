//! Completion, layout, changes that mend findings, new names.

use std::collections::HashMap;

use flank::{Completion, CompletionKind, NameKind, PathCompletions, TextEdit as Edit, lay_out};
use gen_lsp_types::{
    CodeAction, CodeActionKind, CodeActionParams, CodeActionResponse, Command, CompletionItem, CompletionItemKind,
    CompletionItemTextEdit, CompletionList, CompletionParams, CompletionResponse, DocumentFormattingParams,
    DocumentRangeFormattingParams, InsertTextFormat, PrepareRenameParams, PrepareRenamePlaceholder,
    PrepareRenameResult, RenameParams, TextEdit, Uri, WorkspaceEdit,
};

use super::browse::all_references;
use super::relaid;
use crate::diagnostics::diagnostic;
use crate::position::Lines;
use crate::snapshot::{Opened, Places, Snapshot};
use crate::uri::{ERRORS, LIBRARY};

pub(crate) fn completion(snapshot: &Snapshot, params: CompletionParams) -> Option<CompletionResponse> {
    let at = params.text_document_position_params;
    let opened = snapshot.opened(&at.text_document.uri)?;
    let offset = opened.offset(at.position);
    let paths = opened.analysis.path_completions(offset, &snapshot.documents);
    // signs that paths have are typed elsewhere, too
    let asked_by = params.context.and_then(|context| context.trigger_character);
    let is_of_path = asked_by.is_some_and(|sign| ["\"", "/"].contains(&sign.as_str()));
    let paths = paths.or_else(|| is_of_path.then(PathCompletions::default));
    let is_incomplete = paths.as_ref().is_some_and(|paths| paths.is_part);
    let found = paths.map_or_else(|| opened.analysis.completions(offset), |paths| paths.found);
    let lines = opened.lines();
    let items = found
        .iter()
        .enumerate()
        .map(|(rank, proposal)| item(proposal, rank, &lines, snapshot.options.snippets))
        .collect();
    let list = CompletionList { is_incomplete, item_defaults: None, apply_kind: None, items };
    Some(CompletionResponse::CompletionList(list))
}

fn item(proposal: &Completion, rank: usize, lines: &Lines<'_>, snippets: bool) -> CompletionItem {
    let range = lines.range(proposal.replaces.start, proposal.replaces.end);
    let has_places = proposal.is_snippet && snippets;
    let format = if has_places { InsertTextFormat::Snippet } else { InsertTextFormat::PlainText };
    let new_text = if has_places { proposal.text.clone() } else { proposal.plain_text() };
    CompletionItem {
        label: proposal.label.clone(),
        kind: Some(item_kind(proposal.kind)),
        detail: (!proposal.detail.is_empty()).then(|| proposal.detail.clone()),
        // editors sort by this text
        sort_text: Some(format!("{rank:04}")),
        insert_text_format: Some(format),
        text_edit: Some(CompletionItemTextEdit::TextEdit(TextEdit { range, new_text })),
        ..CompletionItem::default()
    }
}

fn item_kind(kind: CompletionKind) -> CompletionItemKind {
    match kind {
        CompletionKind::Keyword => CompletionItemKind::Keyword,
        CompletionKind::Unit => CompletionItemKind::Unit,
        CompletionKind::Setting => CompletionItemKind::Property,
        CompletionKind::Snippet => CompletionItemKind::Snippet,
        CompletionKind::File => CompletionItemKind::File,
        CompletionKind::Folder => CompletionItemKind::Folder,
        CompletionKind::Function | CompletionKind::Name(NameKind::Function) => CompletionItemKind::Function,
        CompletionKind::Name(NameKind::Machine | NameKind::Tool | NameKind::Job) => CompletionItemKind::Class,
        CompletionKind::Name(NameKind::Parameter | NameKind::MachineError) => CompletionItemKind::Property,
        CompletionKind::Name(NameKind::Value) => CompletionItemKind::Constant,
        CompletionKind::Name(NameKind::Frame) => CompletionItemKind::Module,
        CompletionKind::Name(_) => CompletionItemKind::Variable,
    }
}

/// Whether a text is the library's, which is read only.
fn is_shipped(opened: &Opened<'_>) -> bool {
    opened.document.uri.starts_with(LIBRARY)
}

pub(crate) fn format(snapshot: &Snapshot, params: DocumentFormattingParams) -> Option<Vec<TextEdit>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    formatted(snapshot, &opened, None)
}

pub(crate) fn format_range(snapshot: &Snapshot, params: DocumentRangeFormattingParams) -> Option<Vec<TextEdit>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let (start, end) = (params.range.start, params.range.end);
    // a range that ends where a line begins has nothing of that line
    let last = if end.character == 0 && end.line > start.line { end.line - 1 } else { end.line };
    formatted(snapshot, &opened, Some([start.line as usize, last as usize]))
}

/// The lines that the layout changes, of a range or of all; nothing where the text is wrong.
fn formatted(snapshot: &Snapshot, opened: &Opened<'_>, within: Option<[usize; 2]>) -> Option<Vec<TextEdit>> {
    if is_shipped(opened) {
        return Some(Vec::new());
    }
    let laid = lay_out(&snapshot.project(&opened.path)).ok()?;
    let lines = opened.lines();
    let edits = relaid::changes(&opened.document.text, &laid.text, within);
    let edit = |(from, to, new_text)| TextEdit { range: lines.range(from, to), new_text };
    Some(edits.into_iter().map(edit).collect())
}

pub(crate) fn code_actions(snapshot: &Snapshot, params: CodeActionParams) -> Option<Vec<CodeActionResponse>> {
    let opened = snapshot.opened(&params.text_document.uri)?;
    let (lines, places) = (opened.lines(), snapshot.places(&opened.analysis));
    let (from, to) = (lines.offset(params.range.start), lines.offset(params.range.end));
    let mut actions = Vec::new();
    let mut explained = Vec::new();
    let wants = |kind: &CodeActionKind| params.context.only.as_ref().is_none_or(|only| only.contains(kind));
    for found in opened.analysis.findings() {
        if found.span.file != opened.path || found.span.start > to || found.span.end < from {
            continue;
        }
        let shown = diagnostic(&found, &places, snapshot.spelled);
        for (number, cure) in found.cures.iter().enumerate().filter(|_| wants(&CodeActionKind::QuickFix)) {
            actions.push(CodeActionResponse::CodeAction(CodeAction {
                title: cure.title.clone(),
                kind: Some(CodeActionKind::QuickFix),
                diagnostics: Some(vec![shown.clone()]),
                is_preferred: Some(number == 0),
                edit: Some(workspace_edit(&places, std::slice::from_ref(&cure.edit))?),
                ..CodeAction::default()
            }));
        }
        if !explained.contains(&found.finding.code) && params.context.only.is_none() {
            explained.push(found.finding.code);
        }
    }
    for code in explained {
        let command = Command {
            title: format!("explain {code}"),
            tooltip: None,
            command: "flank.explain".to_string(),
            arguments: Some(vec![format!("{ERRORS}:/{code}.md").into()]),
        };
        actions.push(CodeActionResponse::Command(command));
    }
    Some(actions)
}

fn workspace_edit(places: &Places<'_>, edits: &[Edit]) -> Option<WorkspaceEdit> {
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for edit in edits {
        let location = places.location(&edit.span)?;
        let edit = TextEdit { range: location.range, new_text: edit.replacement.clone() };
        changes.entry(location.uri).or_default().push(edit);
    }
    Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}

pub(crate) fn prepare_rename(
    snapshot: &Snapshot,
    params: PrepareRenameParams,
) -> Result<Option<PrepareRenameResult>, String> {
    let at = params.text_document_position_params;
    let Some(opened) = snapshot.opened(&at.text_document.uri) else { return Ok(None) };
    let span = opened.analysis.renamed(opened.offset(at.position)).map_err(|error| error.to_string())?;
    let placeholder = opened.document.text.get(span.start..span.end).unwrap_or_default().to_string();
    let range = opened.lines().range(span.start, span.end);
    Ok(Some(PrepareRenameResult::PrepareRenamePlaceholder(PrepareRenamePlaceholder { range, placeholder })))
}

/// A new name in all open texts and those that they use. A name that makes a text wrong is refused.
pub(crate) fn rename(snapshot: &Snapshot, params: RenameParams) -> Result<Option<WorkspaceEdit>, String> {
    let at = params.text_document_position_params;
    let Some(opened) = snapshot.opened(&at.text_document.uri) else { return Ok(None) };
    let offset = opened.offset(at.position);
    opened.analysis.renamed(offset).map_err(|error| error.to_string())?;
    let Some(definition) = opened.analysis.first_definition(offset) else { return Ok(None) };
    opened.analysis.check_name(&definition, &params.new_name).map_err(|error| error.to_string())?;
    let all = all_references(snapshot, &definition);
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for (_, location) in &all {
        let edit = TextEdit { range: location.range, new_text: params.new_name.clone() };
        changes.entry(location.uri.clone()).or_default().push(edit);
    }
    let spans: Vec<Edit> =
        all.into_iter().map(|(found, _)| Edit { span: found.span, replacement: params.new_name.clone() }).collect();
    check_renamed(snapshot, &spans)?;
    Ok(Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }))
}

/// Compiles the open specs with the new name: none may have more errors than before, and each name has to mean what it meant.
fn check_renamed(snapshot: &Snapshot, edits: &[Edit]) -> Result<(), String> {
    let mut renamed = snapshot.clone();
    renamed.analyses = Default::default();
    let mut files: Vec<_> = edits.iter().map(|edit| edit.span.file.clone()).collect();
    files.sort();
    files.dedup();
    for file in files {
        let mut text = flank::Files::read(&snapshot.documents, &file, usize::MAX).map_err(|error| error.to_string())?;
        let mut own: Vec<&Edit> = edits.iter().filter(|edit| edit.span.file == file).collect();
        own.sort_by_key(|edit| std::cmp::Reverse(edit.span.start));
        own.iter().for_each(|edit| text.replace_range(edit.span.start..edit.span.end, &edit.replacement));
        let uri = snapshot.documents.uri_of(&file);
        renamed.documents.open(crate::documents::Document::new(uri, 0, text));
    }
    for path in snapshot.documents.paths() {
        let count = |of: &Snapshot| of.analysis(path).findings().len();
        if count(&renamed) > count(snapshot) {
            let found = renamed.analysis(path).findings();
            let told = found.first().map_or(String::new(), |first| format!(": {}", first.finding.message));
            return Err(format!("with this name {} would be wrong{told}", path.display()));
        }
        if let Some(told) = snapshot.analysis(path).first_other_meaning(&renamed.analysis(path)) {
            return Err(format!("with this name {} would mean something else: {told}", path.display()));
        }
    }
    Ok(())
}
