//! Diagnostics as text: what was found, the source underlined, what to write instead.

use std::collections::BTreeMap;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use crate::diagnostics::source::{FileId, Sources, Span};
use crate::diagnostics::{Diagnostic, Severity};

/// One text for all diagnostics, in their order, with an empty line between them.
///
/// The output depends on nothing but the arguments. `colour` asks for ANSI colours.
pub fn render(diagnostics: &[Diagnostic], sources: &Sources, colour: bool) -> String {
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii);
    let texts: Vec<String> = diagnostics.iter().map(|one| renderer.render(&[group(one, sources)]) + "\n").collect();
    texts.join("\n")
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a Sources) -> Group<'a> {
    let level = match diagnostic.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code.as_str());
    let mut group = Group::with_title(title);
    let own = sources.file(diagnostic.span.file);
    if own.text.is_empty() {
        // nothing can be underlined
        group = group.element(Origin::path(own.path.to_string_lossy().into_owned()));
    } else {
        group = group.elements(snippets(diagnostic, sources));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    group
}

/// One snippet for each file that the diagnostic speaks of, its own first.
fn snippets<'a>(
    diagnostic: &'a Diagnostic,
    sources: &'a Sources,
) -> Vec<Snippet<'a, annotate_snippets::Annotation<'a>>> {
    let mut marks: BTreeMap<FileId, Vec<(Span, Option<&str>)>> = BTreeMap::new();
    for note in &diagnostic.notes {
        marks.entry(note.span.file).or_default().push((note.span, Some(&note.text)));
    }
    let own = diagnostic.span.file;
    let mut in_own = marks.remove(&own).unwrap_or_default();
    in_own.insert(0, (diagnostic.span, None));
    std::iter::once((own, in_own)).chain(marks).map(|(file, marks)| snippet(file, &marks, own, sources)).collect()
}

fn snippet<'a>(
    file: FileId,
    marks: &[(Span, Option<&'a str>)],
    own: FileId,
    sources: &'a Sources,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let source = sources.file(file);
    let lines = lines(&source.text, marks);
    let (first_line, _) = source.line(lines.start);
    // carriage returns would be shown as signs of their own
    let text = &source.text[lines.clone()];
    let place = |at: u32| {
        let before = &text[..at as usize - lines.start];
        before.len() - before.matches("\r\n").count()
    };
    let mut snippet = Snippet::source(text.replace("\r\n", "\n").replace('\r', "\n"))
        .line_start(first_line)
        .path(source.path.to_string_lossy().into_owned())
        .fold(true);
    for (index, &(span, label)) in marks.iter().enumerate() {
        let primary = index == 0 && file == own;
        let kind = if primary { AnnotationKind::Primary } else { AnnotationKind::Context };
        let annotation = kind.span(place(span.start)..place(span.end)).label(label);
        snippet = snippet.annotation(annotation);
    }
    snippet
}

/// The whole lines that hold all marks.
fn lines(text: &str, marks: &[(Span, Option<&str>)]) -> Range<usize> {
    let start = marks.iter().map(|(span, _)| span.start as usize).min().unwrap_or(0);
    let end = marks.iter().map(|(span, _)| span.end as usize).max().unwrap_or(0);
    let start = text[..start].rfind(['\n', '\r']).map_or(0, |at| at + 1);
    let end = text[end..].find(['\n', '\r']).map_or(text.len(), |at| end + at);
    start..end
}
