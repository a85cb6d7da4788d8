//! Conversations as texts: what the editor does after `>`, below it what the server says.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use gen_lsp_types::{
    CodeActionRequest, CodeActionResponse, CodeLensRequest, CompletionItemTextEdit, CompletionRequest,
    CompletionResponse, Contents, Definition, DefinitionRequest, DefinitionResponse, Diagnostic,
    DocumentFormattingRequest, DocumentRangeFormattingRequest, DocumentSymbol, DocumentSymbolRequest,
    DocumentSymbolResponse, FoldingRangeRequest, HoverRequest, InlayHintRequest, Label, Location, Message,
    PrepareRenameRequest, PrepareRenameResult, Range, ReferencesRequest, RenameRequest, SemanticTokensRequest,
    TextDocumentContentRequest, TextEdit, Uri, WorkspaceEdit,
};
use serde_json::{Value, json};

use crate::client::Client;
use crate::support::{folder, top};

struct Session {
    client: Client,
    folder: PathBuf,
    /// What was done last in a text: where a mark stood.
    texts: HashMap<String, String>,
    legend: Vec<String>,
}

/// Plays all sessions; with `UPDATE_SESSIONS=1` the server's words are written into them.
#[test]
fn the_server_says_what_the_sessions_say() {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lsp/sessions");
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(all).expect("sessions").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(paths.len() >= 6, "{}", paths.len());
    for path in paths {
        let written = std::fs::read_to_string(&path).expect("UTF-8");
        let name = path.file_stem().expect("a name").to_str().expect("UTF-8");
        let played = play(&format!("lsp-session-{name}"), &written);
        if std::env::var_os("UPDATE_SESSIONS").is_some() {
            std::fs::write(&path, &played).expect("the session");
        } else {
            assert_eq!(played, written, "{name}");
        }
    }
}

/// What a change adds has the line ends of the text.
#[test]
fn changes_keep_the_line_ends_of_a_text() {
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let text = text.replace("    drive m.Y = reference_radius * roll\n", "");
    for (uri, end) in [("file:///nowhere/unix.chain", "\n"), ("file:///nowhere/windows.chain", "\r\n")] {
        let mut client = Client::start();
        client.open(uri, &text.replace('\n', end));
        let told = client.findings(uri);
        let found = told
            .diagnostics
            .iter()
            .find(|found| found.code == Some(gen_lsp_types::Code::String("E0501".to_string())))
            .expect("an axis");
        let params = json!({ "textDocument": { "uri": uri }, "range": found.range, "context": { "diagnostics": [] } });
        let actions = client.ask("textDocument/codeAction", params).expect("actions");
        let added = actions[0]["edit"]["changes"][uri][0]["newText"].as_str().expect("a text");
        assert!(added.ends_with(end) && added.replace(end, "").find(['\n', '\r']).is_none(), "{added:?}");
        assert_eq!(client.end(), Some(0));
    }
}

fn play(name: &str, written: &str) -> String {
    let mut session =
        Session { client: Client::start(), folder: folder(name), texts: HashMap::new(), legend: Vec::new() };
    session.legend = [
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
    ]
    .map(str::to_string)
    .to_vec();
    let mut out = String::new();
    let mut lines = written.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(command) = line.strip_prefix("> ") else {
            // a heading, or what was said before
            if line.starts_with('#') || line.is_empty() {
                out += &format!("{line}\n");
            }
            continue;
        };
        out += &format!("{line}\n");
        let mut text = String::new();
        while let Some(part) = lines.next_if(|line| line.starts_with("| ") || *line == "|") {
            out += &format!("{part}\n");
            text += &format!("{}\n", part.strip_prefix("| ").unwrap_or_default());
        }
        for said in session.done(command, &text).lines() {
            out += &format!("  {said}\n");
        }
    }
    assert_eq!(session.client.end(), Some(0), "{name}");
    out
}

impl Session {
    fn uri(&self, name: &str) -> String {
        if name.contains(':') { name.to_string() } else { format!("file://{}", self.folder.join(name).display()) }
    }

    /// Without the folder of the test.
    fn plain(&self, text: &str) -> String {
        text.replace(&format!("file://{}/", self.folder.display()), "")
            .replace(&format!("{}/", self.folder.display()), "")
    }

    fn document(&self, name: &str) -> Value {
        json!({ "textDocument": { "uri": self.uri(name) } })
    }

    /// `3:7`, from 1 as people count, the column in units of UTF-16.
    fn position(at: &str) -> Value {
        let (line, column) = at.split_once(':').expect("line and column");
        let zero = |number: &str| number.parse::<u32>().expect("a number") - 1;
        json!({ "line": zero(line), "character": zero(column) })
    }

    fn at(&self, name: &str, place: &str) -> Value {
        json!({ "textDocument": { "uri": self.uri(name) }, "position": Self::position(place) })
    }

    fn done(&mut self, command: &str, text: &str) -> String {
        let words: Vec<&str> = command.split(' ').collect();
        let said = match words[..] {
            ["disk", name] => {
                std::fs::write(self.folder.join(name), text).expect("a file");
                String::new()
            }
            ["open", name] => {
                self.texts.insert(name.to_string(), text.to_string());
                self.client.open(&self.uri(name), text);
                self.findings(name)
            }
            ["text", name] => {
                self.client.change(&self.uri(name), json!([{ "text": text }]));
                self.findings(name)
            }
            ["type", name, from, to] => {
                let range = json!({ "start": Self::position(from), "end": Self::position(to) });
                self.client.change(&self.uri(name), json!([{ "range": range, "text": text.trim_end_matches('\n') }]));
                self.findings(name)
            }
            ["findings", name] => self.findings(name),
            ["close", name] => {
                self.client.tell("textDocument/didClose", self.document(name));
                String::new()
            }
            ["hover", name, place] => self.hover(name, place),
            ["define", name, place] => match self.client.typed::<DefinitionRequest>(self.at(name, place)) {
                Some(DefinitionResponse::Definition(Definition::Location(location))) => location_told(&location),
                None => "nowhere".to_string(),
                other => format!("{other:?}"),
            },
            ["uses", name, place] => {
                let mut params = self.at(name, place);
                params["context"] = json!({ "includeDeclaration": true });
                let all = self.client.typed::<ReferencesRequest>(params).unwrap_or_default();
                all.iter().map(|location| location_told(location) + "\n").collect()
            }
            ["complete", name, place] => self.complete(name, place),
            ["symbols", name] => match self.client.typed::<DocumentSymbolRequest>(self.document(name)) {
                Some(DocumentSymbolResponse::DocumentSymbolList(all)) => {
                    all.iter().map(|one| symbol_told(one, 0)).collect()
                }
                other => format!("{other:?}"),
            },
            ["folds", name] => {
                let all = self.client.typed::<FoldingRangeRequest>(self.document(name)).unwrap_or_default();
                all.iter()
                    .map(|fold| {
                        format!(
                            "{}-{} {}\n",
                            fold.start_line + 1,
                            fold.end_line + 1,
                            fold.kind.as_ref().map_or("", |_| "comment")
                        )
                        .replace(" \n", "\n")
                    })
                    .collect()
            }
            ["format", name] => {
                let mut params = self.document(name);
                params["options"] = json!({ "tabSize": 4, "insertSpaces": true });
                edits_told(&self.client.typed::<DocumentFormattingRequest>(params).unwrap_or_default())
            }
            ["format", name, from, to] => {
                let mut params = self.document(name);
                params["options"] = json!({ "tabSize": 4, "insertSpaces": true });
                params["range"] = json!({ "start": Self::position(from), "end": Self::position(to) });
                edits_told(&self.client.typed::<DocumentRangeFormattingRequest>(params).unwrap_or_default())
            }
            ["actions", name, place] => self.actions(name, place),
            ["rename", name, place, new] => {
                let mut params = self.at(name, place);
                let placeholder = self.client.ask("textDocument/prepareRename", params.clone());
                let prepared = match placeholder {
                    Err(error) => return self.plain(error["message"].as_str().unwrap_or_default()),
                    Ok(_) => self.client.typed::<PrepareRenameRequest>(params.clone()),
                };
                assert!(matches!(prepared, Some(PrepareRenameResult::PrepareRenamePlaceholder(_)) | None));
                params["newName"] = json!(new);
                match self.client.ask("textDocument/rename", params.clone()) {
                    Err(error) => self.plain(error["message"].as_str().unwrap_or_default()),
                    Ok(_) => workspace_told(&self.client.typed::<RenameRequest>(params).unwrap_or_default()),
                }
            }
            ["tokens", name] => self.tokens(name),
            ["values", name] => {
                let mut params = self.document(name);
                params["range"] =
                    json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9999, "character": 0 } });
                let all = self.client.typed::<InlayHintRequest>(params).unwrap_or_default();
                let label = |label: &Label| if let Label::String(text) = label { text.clone() } else { String::new() };
                all.iter()
                    .map(|hint| {
                        format!("{}:{} {}\n", hint.position.line + 1, hint.position.character + 1, label(&hint.label))
                    })
                    .collect()
            }
            ["lenses", name] => {
                let all = self.client.typed::<CodeLensRequest>(self.document(name)).unwrap_or_default();
                let told = |lens: &gen_lsp_types::CodeLens| {
                    let command = lens.command.clone().expect("a command");
                    format!("{} {} ({})\n", range_told(&lens.range), command.title, command.command)
                };
                all.iter().map(told).collect()
            }
            ["solve", name, job] => {
                let params = json!({ "command": "flank.solve", "arguments": [self.uri(name), job] });
                match self.client.ask("workspace/executeCommand", params) {
                    Err(error) => error["message"].as_str().unwrap_or_default().to_string(),
                    Ok(_) => self.client.other("window/showMessage")["params"]["message"]
                        .as_str()
                        .unwrap_or_default()
                        .to_string(),
                }
            }
            ["content", uri] => match self.client.ask("workspace/textDocumentContent", json!({ "uri": uri })) {
                Err(error) => error["message"].as_str().unwrap_or_default().to_string(),
                Ok(_) => {
                    let content = self.client.typed::<TextDocumentContentRequest>(json!({ "uri": uri }));
                    content.text.lines().next().unwrap_or_default().to_string()
                }
            },
            ["files"] => {
                let entries = std::fs::read_dir(&self.folder).expect("the folder");
                let mut names: Vec<String> =
                    entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
                names.sort();
                names.join(" ")
            }
            _ => panic!("a session cannot `{command}`"),
        };
        self.plain(&said)
    }

    fn findings(&mut self, name: &str) -> String {
        let told = self.client.findings(&self.uri(name));
        told.diagnostics.iter().map(diagnostic_told).collect()
    }

    fn hover(&mut self, name: &str, place: &str) -> String {
        let Some(hover) = self.client.typed::<HoverRequest>(self.at(name, place)) else { return "nothing".to_string() };
        let Contents::MarkupContent(content) = hover.contents else { panic!("{:?}", hover.contents) };
        format!("{}\n{}", hover.range.map_or(String::new(), |range| range_told(&range)), content.value)
    }

    fn complete(&mut self, name: &str, place: &str) -> String {
        let found = self.client.typed::<CompletionRequest>(self.at(name, place));
        let Some(CompletionResponse::CompletionList(list)) = found else { return "nothing".to_string() };
        let mut out = String::new();
        for item in list.items.iter().take(12) {
            let edit = match &item.text_edit {
                Some(CompletionItemTextEdit::TextEdit(edit)) => edit,
                other => panic!("{other:?}"),
            };
            let text = if edit.new_text == item.label || edit.new_text.contains('\n') {
                String::new()
            } else {
                format!(" `{}`", edit.new_text)
            };
            let _ = writeln!(out, "{}{text} {}", item.label, item.detail.as_deref().unwrap_or_default());
        }
        if list.items.len() > 12 {
            let _ = writeln!(out, "…");
        }
        out
    }

    fn actions(&mut self, name: &str, place: &str) -> String {
        let position = Self::position(place);
        let params = json!({
            "textDocument": { "uri": self.uri(name) },
            "range": { "start": position, "end": position },
            "context": { "diagnostics": [] },
        });
        let mut out = String::new();
        for action in self.client.typed::<CodeActionRequest>(params).unwrap_or_default() {
            match action {
                CodeActionResponse::CodeAction(action) => {
                    let edit = workspace_told(&action.edit.unwrap_or_default());
                    let _ = write!(out, "{}\n{edit}", action.title);
                }
                CodeActionResponse::Command(command) => {
                    let _ = writeln!(out, "{} ({})", command.title, command.command);
                }
            }
        }
        out
    }

    fn tokens(&mut self, name: &str) -> String {
        let tokens = self.client.typed::<SemanticTokensRequest>(self.document(name)).expect("tokens");
        let text = self.texts[name].clone();
        let (mut line, mut column, mut out) = (0, 0, String::new());
        for token in tokens.data {
            column = if token.delta_line == 0 { column + token.delta_start } else { token.delta_start };
            line += token.delta_line;
            let units: Vec<u16> = text.lines().nth(line as usize).expect("a line").encode_utf16().collect();
            let word = String::from_utf16(&units[column as usize..(column + token.length) as usize]).expect("letters");
            let mark = if token.token_modifiers_bitset & 1 == 1 { " definition" } else { "" };
            let _ =
                writeln!(out, "{}:{} {word} {}{mark}", line + 1, column + 1, self.legend[token.token_type as usize]);
        }
        out
    }
}

fn range_told(range: &Range) -> String {
    let (start, end) = (range.start, range.end);
    let lines = if start.line == end.line { String::new() } else { format!("{}:", end.line + 1) };
    format!("{}:{}-{lines}{}", start.line + 1, start.character + 1, end.character + 1)
}

fn location_told(location: &Location) -> String {
    format!("{} {}", location.uri.0, range_told(&location.range))
}

fn diagnostic_told(found: &Diagnostic) -> String {
    let code = match &found.code {
        Some(gen_lsp_types::Code::String(code)) => code.clone(),
        other => panic!("{other:?}"),
    };
    let Message::String(message) = &found.message else { panic!("{:?}", found.message) };
    let mut out = format!("{} {code} {}", range_told(&found.range), message.replace('\n', " | "));
    if found.tags.is_some() {
        out += " (unused)";
    }
    out.push('\n');
    for related in found.related_information.iter().flatten() {
        let _ = writeln!(out, "    {}: {}", location_told(&related.location), related.message);
    }
    out
}

fn edits_told(edits: &[TextEdit]) -> String {
    edits.iter().map(|edit| format!("{} {:?}\n", range_told(&edit.range), edit.new_text)).collect()
}

fn workspace_told(edit: &WorkspaceEdit) -> String {
    let mut all: Vec<(&Uri, &Vec<TextEdit>)> = edit.changes.iter().flatten().collect();
    all.sort_by(|a, b| a.0.0.cmp(&b.0.0));
    let lines = all.iter().flat_map(|(uri, edits)| {
        edits.iter().map(move |edit| format!("    {} {} {:?}\n", uri.0, range_told(&edit.range), edit.new_text))
    });
    lines.collect()
}

fn symbol_told(symbol: &DocumentSymbol, depth: usize) -> String {
    let mut out = format!("{}{} {:?} {}\n", "  ".repeat(depth), symbol.name, symbol.kind, range_told(&symbol.range));
    for inner in symbol.children.iter().flatten() {
        out += &symbol_told(inner, depth + 1);
    }
    out
}
