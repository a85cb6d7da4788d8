//! What the editor tells.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use gen_lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams, DidSaveTextDocumentParams,
};
use lsp_server::Notification;
use serde_json::Value;

use super::{Phase, SILENCE, Server};
use crate::documents::Document;

/// A picture that follows changes, not only saves, waits for so long.
const PICTURE_SILENCE: Duration = Duration::from_millis(300);
/// The files that specs are made of: texts, and tables beside them.
const WATCHED: &str = "**/*.{chain,csv}";

impl<W: Write> Server<W> {
    pub(super) fn notification(&mut self, notification: Notification) -> io::Result<()> {
        if self.phase != Phase::Open {
            return Ok(());
        }
        let params = notification.params;
        match notification.method.as_str() {
            "textDocument/didOpen" => {
                let Ok(DidOpenTextDocumentParams { text_document: opened }) = serde_json::from_value(params) else {
                    return Ok(());
                };
                let document = Document::new(opened.uri.0, opened.version, opened.text);
                let path = self.documents.open(document);
                self.changed(Some(&path), Duration::ZERO);
            }
            "textDocument/didChange" => {
                let Ok(params) = serde_json::from_value::<DidChangeTextDocumentParams>(params) else { return Ok(()) };
                let uri = params.text_document.text_document_identifier.uri;
                let Some(path) = self.documents.find(&uri.0).map(|(path, _)| path) else { return Ok(()) };
                if self.documents.change(&path, params.text_document.version, params.content_changes) {
                    self.changed(Some(&path), SILENCE);
                    if self.settings.page_follows_changes {
                        self.picture_at = Some((Instant::now() + PICTURE_SILENCE, path));
                    }
                }
            }
            "textDocument/didClose" => {
                let Ok(params) = serde_json::from_value::<DidCloseTextDocumentParams>(params) else { return Ok(()) };
                let Some(path) = self.documents.find(&params.text_document.uri.0).map(|(path, _)| path) else {
                    return Ok(());
                };
                self.documents.close(&path);
                self.due.remove(&path);
                self.ready.remove(&path);
                self.changed(Some(&path), SILENCE);
                for told in self.findings.remove(&path, &self.documents) {
                    self.tell("textDocument/publishDiagnostics", told)?;
                }
            }
            "textDocument/didSave" => {
                let Ok(params) = serde_json::from_value::<DidSaveTextDocumentParams>(params) else { return Ok(()) };
                if let Some((path, _)) = self.documents.find(&params.text_document.uri.0) {
                    self.show_picture(&path);
                }
            }
            "workspace/didChangeWatchedFiles" => {
                // what is open is as the editor has it
                let address = |change: &Value| change["uri"].as_str().map(str::to_string);
                let changes = params["changes"].as_array().into_iter().flatten().filter_map(address);
                if changes.into_iter().any(|address| self.documents.find(&address).is_none()) {
                    self.changed(None, SILENCE);
                }
            }
            "workspace/didChangeConfiguration" => {
                let settings = params.pointer("/settings/flank").or_else(|| params.get("settings"));
                if let Some(settings) = settings {
                    self.set(settings)?;
                }
            }
            "window/workDoneProgress/cancel" => {
                if let Some(token) = params.get("token").and_then(Value::as_str) {
                    self.tasks.running.stop(token);
                }
            }
            "flank/didFocus" => {
                let uri = params.pointer("/textDocument/uri").and_then(Value::as_str);
                if let Some((path, _)) = uri.and_then(|uri| self.documents.find(uri)) {
                    self.focus(path);
                }
            }
            "initialized" if self.editor.watches_files => self.watch()?,
            // others are for other servers
            _ => {}
        }
        Ok(())
    }

    /// Asks to hear of files that change outside of the editor.
    fn watch(&mut self) -> io::Result<()> {
        let method = "workspace/didChangeWatchedFiles";
        let options = serde_json::json!({ "watchers": [{ "globPattern": WATCHED }] });
        let registration = serde_json::json!({ "id": method, "method": method, "registerOptions": options });
        self.ask("client/registerCapability", serde_json::json!({ "registrations": [registration] }))
    }

    fn set(&mut self, options: &Value) -> io::Result<()> {
        let before = self.settings;
        self.settings.set(options);
        if before.literal_values != self.settings.literal_values && self.editor.refreshes_hints {
            self.ask("workspace/inlayHint/refresh", Value::Null)?;
        }
        Ok(())
    }
}
