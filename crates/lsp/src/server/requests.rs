//! What the editor asks.

use std::io::{self, Write};

use lsp_server::{ErrorCode, Request, Response};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{Event, Server};
use crate::answers::{browse, edit, look};
use crate::snapshot::Snapshot;
use crate::tasks;

impl<W: Write> Server<W> {
    pub(super) fn answer(&mut self, request: Request) -> io::Result<()> {
        match request.method.as_str() {
            "textDocument/hover" => self.answer_from(request, |snapshot, params| Ok(browse::hover(snapshot, params))),
            "textDocument/definition" => {
                self.answer_from(request, |snapshot, params| Ok(browse::definition(snapshot, params)))
            }
            "textDocument/references" => {
                self.answer_from(request, |snapshot, params| Ok(browse::references(snapshot, params)))
            }
            "textDocument/documentSymbol" => {
                self.answer_from(request, |snapshot, params| Ok(browse::symbols(snapshot, params)))
            }
            "textDocument/foldingRange" => {
                self.answer_from(request, |snapshot, params| Ok(browse::folding(snapshot, params)))
            }
            "textDocument/completion" => {
                self.answer_from(request, |snapshot, params| Ok(edit::completion(snapshot, params)))
            }
            "textDocument/formatting" => {
                self.answer_from(request, |snapshot, params| Ok(edit::format(snapshot, params)))
            }
            "textDocument/rangeFormatting" => {
                self.answer_from(request, |snapshot, params| Ok(edit::format_range(snapshot, params)))
            }
            "textDocument/codeAction" => {
                self.answer_from(request, |snapshot, params| Ok(edit::code_actions(snapshot, params)))
            }
            "textDocument/prepareRename" => self.answer_from(request, edit::prepare_rename),
            "textDocument/rename" => self.answer_from(request, edit::rename),
            "textDocument/semanticTokens/full" => {
                self.answer_from(request, |snapshot, params| Ok(look::tokens(snapshot, params)))
            }
            "textDocument/inlayHint" => {
                self.answer_from(request, |snapshot, params| Ok(look::inlay_hints(snapshot, params)))
            }
            "textDocument/codeLens" => self.answer_from(request, |snapshot, params| Ok(look::lenses(snapshot, params))),
            "workspace/textDocumentContent" => self.answer_from(request, |_, params| tasks::content(params)),
            "workspace/executeCommand" => self.execute(request),
            method => {
                let message = format!("`{method}` is not served");
                self.refuse(request.id, ErrorCode::MethodNotFound, message)
            }
        }
    }

    /// Answers on another thread, from the texts as they are now.
    fn answer_from<P, R>(
        &mut self,
        request: Request,
        answer: impl FnOnce(&Snapshot, P) -> Result<R, String> + Send + 'static,
    ) -> io::Result<()>
    where
        P: DeserializeOwned + Send + 'static,
        R: Serialize,
    {
        let uri = request.params.pointer("/textDocument/uri").and_then(Value::as_str);
        let about = uri.and_then(|uri| self.documents.find(uri));
        let about = about.map(|(path, document)| (path, document.version));
        let params: P = match serde_json::from_value(request.params) {
            Ok(params) => params,
            Err(error) => return self.refuse(request.id, ErrorCode::InvalidParams, error.to_string()),
        };
        let (snapshot, events, id) = (self.snapshot(), self.events.clone(), request.id);
        self.answering.spawn(move || {
            let answered = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| answer(&snapshot, params)));
            let response = match answered {
                Ok(Ok(result)) => Response::new_ok(id, result),
                Ok(Err(reason)) => Response::new_err(id, ErrorCode::RequestFailed as i32, reason),
                Err(_) => Response::new_err(id, ErrorCode::InternalError as i32, "the server has a fault".to_string()),
            };
            // where nobody hears any more, nobody asks
            let _ = events.send(Event::Answer { response, about });
        });
        Ok(())
    }

    fn execute(&mut self, request: Request) -> io::Result<()> {
        let asked = match tasks::Asked::read(request.params) {
            Ok(asked) => asked,
            Err(reason) => return self.refuse(request.id, ErrorCode::InvalidParams, reason),
        };
        let started = match self.tasks.start(asked.clone(), &self.documents) {
            Ok(value) => value,
            Err(reason) => return self.refuse(request.id, ErrorCode::RequestFailed, reason),
        };
        let page = match asked {
            tasks::Asked::Explain { page } => Some(serde_json::json!({ "uri": page, "takeFocus": true })),
            tasks::Asked::Preview { .. } if !self.settings.opens_page => {
                started.get("url").map(|url| serde_json::json!({ "uri": url, "external": true }))
            }
            _ => None,
        };
        if let Some(page) = page.filter(|_| self.editor.shows_documents) {
            self.ask("window/showDocument", page)?;
        }
        self.send(&Response::new_ok(request.id, started).into())
    }
}
