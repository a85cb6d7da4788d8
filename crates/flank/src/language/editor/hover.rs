//! What is said of a name under the pointer.

use flank_chain_dsl::syntax::{TokenKind, tokens};
use flank_chain_dsl::{Entry, NameKind, Span, SymbolId, Target, WordKind};

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::builtins::{function_about, number_about};
use crate::language::editor::shipped;

/// Of values of a definition, how many are listed.
const MOST_VALUES: usize = 8;

/// What is said of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// The name.
    pub span: TextSpan,
    /// As it is written, in the language.
    pub signature: String,
    /// What else is to be known, a paragraph each, as Markdown.
    pub about: Vec<String>,
    /// The names of its values as jobs have them (`pinion.m.swivel`): what a solve finds of them.
    pub parameters: Vec<String>,
}

impl Analysis {
    /// What is to be known of the name at a byte of the spec.
    pub fn hover(&self, offset: usize) -> Option<Hover> {
        let entry = self.index.at(self.main, offset as u32)?;
        let span = self.text_span(entry.span)?;
        let said = self.sources.text(entry.span);
        match entry.target {
            Target::Symbol(id) => Some(self.of_symbol(span, entry, id)),
            Target::File(file) => {
                let text = &self.sources.file(file).text;
                let lines = text.lines().map(str::trim_start).take_while(|line| line.starts_with("//!"));
                let about = lines.map(|line| line[3..].trim()).collect::<Vec<_>>().join("\n");
                let signature = format!("use {said}");
                Some(Hover {
                    span,
                    signature,
                    about: Vec::from_iter((!about.is_empty()).then_some(about)),
                    parameters: Vec::new(),
                })
            }
            Target::Word(kind) => {
                let (signature, about) = of_word(said, kind)?;
                Some(Hover { span, signature, about: vec![about], parameters: Vec::new() })
            }
            Target::Missing(kind) => {
                let found = shipped::definition(said, kind)?;
                let about = format!(
                    "{} of the shipped library, in `{}`. `flank new {said}` takes it into the project.",
                    kind.described(),
                    shipped::ShippedFiles::inside(&found.file).unwrap_or(&found.file).display()
                );
                let signature = format!("{} {said}", kind.described());
                Some(Hover { span, signature, about: vec![about], parameters: Vec::new() })
            }
        }
    }

    fn of_symbol(&self, span: TextSpan, entry: &Entry, id: SymbolId) -> Hover {
        let symbol = self.index.symbol(id);
        let mut about = Vec::new();
        let doc = self.documentation(symbol);
        if !doc.is_empty() {
            about.push(doc.join("\n"));
        }
        let values = self.counting(symbol);
        if self.shown_values(symbol).len() > 1 {
            let lines = values.iter().take(MOST_VALUES).map(|value| format!("- `{}`: {}", value.of, self.shown(value)));
            let mut lines: Vec<String> = lines.collect();
            if values.len() > MOST_VALUES {
                lines.push(format!("- and {} more", values.len() - MOST_VALUES));
            }
            about.push(lines.join("\n"));
        } else if let [value, ..] = values[..] {
            about.extend(self.giver(id, value.written));
        }
        if symbol.kind == NameKind::Axis {
            about.extend(self.laws(id, entry.span));
        }
        if !entry.is_definition {
            about.push(format!("defined in {}", self.told_place(symbol.name)));
        }
        let name = self.name(id);
        let parameters = values.iter().map(|value| format!("{}.{name}", value.of)).collect();
        Hover { span, signature: self.signature(id), about, parameters }
    }

    /// Who gives a value.
    fn giver(&self, id: SymbolId, written: Span) -> Option<String> {
        let symbol = self.index.symbol(id);
        if !matches!(symbol.kind, NameKind::Parameter | NameKind::MachineError) {
            return None;
        }
        if symbol.value == Some(written) {
            return Some("by default".to_string());
        }
        (written != symbol.name).then(|| format!("given in {}: `{}`", self.told_place(written), self.one_line(written)))
    }

    /// The laws of an axis, wherever it is driven, fixed or coupled: where it is named in a job those of this job, otherwise those of this file,
    /// where there are any.
    fn laws(&self, axis: SymbolId, at: Span) -> Vec<String> {
        let all: Vec<(Span, String)> = self.index.uses(axis).filter_map(|entry| self.law_at(entry.span)).collect();
        let job = self
            .items()
            .map(|id| self.index.symbol(id))
            .find(|item| item.kind == NameKind::Job && holds(item.extent, at));
        let in_job = |place: &Span| job.is_some_and(|job| holds(job.extent, *place));
        let in_file = |place: &Span| place.file == at.file;
        let told = |is_meant: &dyn Fn(&Span) -> bool| {
            let meant = all.iter().filter(|(place, _)| is_meant(place));
            meant.map(|(_, told)| told.clone()).collect::<Vec<String>>()
        };
        let narrowest = [told(&in_job), told(&in_file)].into_iter().find(|laws| !laws.is_empty());
        narrowest.unwrap_or_else(|| told(&|_| true))
    }

    /// File and line, the file as seen from the folder above that of the spec.
    fn told_place(&self, span: Span) -> String {
        let (path, line, _) = self.sources.place(span);
        let above = self.sources.file(self.main).path.parent().and_then(|folder| folder.parent());
        let path = above.and_then(|above| path.strip_prefix(above).ok()).unwrap_or(path);
        format!("{}, line {line}", crate::project::shown_path(path))
    }

    /// The place and the law of the statement that begins with paths of axes, one of which this is the end of, if one does.
    fn law_at(&self, axis: Span) -> Option<(Span, String)> {
        let text = &self.sources.file(axis.file).text;
        let line = text[..axis.start as usize].rfind(['\n', '\r']).map_or(0, |at| at + 1);
        let before = &text[line..axis.start as usize];
        let word = ["drive", "fix", "couple"].into_iter().find(|word| before.trim_start().starts_with(word))?;
        if before.contains('=') {
            return None;
        }
        // as many laws as axes, in the same order
        let number = before.matches(',').count();
        let behind = &text[axis.end as usize..];
        let laws = statement_rest(behind)?;
        let law = laws.get(number)?;
        let path = before.rsplit([',', ' ', '\t']).next().unwrap_or_default();
        let path = format!("{path}{}", self.sources.text(axis));
        Some((axis, format!("`{word} {path}` in {}: `{law}`", self.told_place(axis))))
    }
}

fn holds(part: Span, place: Span) -> bool {
    part.file == place.file && part.start <= place.start && place.end <= part.end
}

/// The values behind the `=` of a statement, apart at their commas.
fn statement_rest(text: &str) -> Option<Vec<String>> {
    let end = text.char_indices().take(4000).map(|(at, letter)| at + letter.len_utf8()).last()?;
    let text = &text[..end];
    let all = tokens(text, flank_chain_dsl::FileId(0));
    let at = |span: Span| &text[span.start as usize..span.end as usize];
    let equals = all.iter().position(|token| at(token.span) == "=")?;
    let (mut depth, mut laws, mut first, mut last) = (0, Vec::new(), None, 0);
    for token in &all[equals + 1..] {
        let said = at(token.span);
        let is_new_line = first.is_some() && text[last..token.span.start as usize].contains(['\n', '\r']);
        let begins = token.kind == TokenKind::Word && depth == 0 && is_new_line;
        if begins || said == "}" {
            break;
        }
        match said {
            "(" | "[" => depth += 1,
            ")" | "]" => depth -= 1,
            "," if depth == 0 => {
                laws.extend(first.take().map(|first: usize| text[first..last].to_string()));
                continue;
            }
            _ => {}
        }
        first = first.or(Some(token.span.start as usize));
        last = token.span.end as usize;
    }
    laws.extend(first.map(|first| text[first..last].to_string()));
    Some(laws.iter().map(|law| law.split_whitespace().collect::<Vec<_>>().join(" ")).collect())
}

/// What a word of the language means.
fn of_word(word: &str, kind: WordKind) -> Option<(String, String)> {
    let about = match kind {
        WordKind::Function => return function_about(word).map(|(signature, about)| (signature.into(), about.into())),
        WordKind::Constant => "the ratio of a circle's circumference to its diameter",
        WordKind::Coordinate => match word {
            "x" | "y" | "z" => "coordinate of the point, in the frame of the surface",
            "rho" => "distance of the point from the z axis",
            "polar_angle" => "angle of the point about the z axis",
            "nx" | "ny" | "nz" => "component of the unit normal out of the body",
            "profilewise" | "lengthwise" => "share of the way between the corners of the outline",
            _ => "given by the sample",
        },
        WordKind::Unit => {
            let (_, dimension) = flank_chain_dsl::unit_size(word)?;
            return Some((word.to_string(), format!("unit of {dimension}")));
        }
        WordKind::ErrorCode => {
            let code = flank_chain_dsl::Code::ALL.iter().find(|code| code.as_str() == word)?;
            return Some((word.to_string(), code.title().to_string()));
        }
        WordKind::Status => "what becomes of points",
        WordKind::Number => number_about(word)?,
        _ => return None,
    };
    Some((word.to_string(), about.to_string()))
}
