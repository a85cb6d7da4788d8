//! What the editor can do, and what it has set.

use serde_json::Value;

/// What an editor says of itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Editor {
    pub(super) refreshes_lenses: bool,
    pub(super) refreshes_hints: bool,
    pub(super) shows_documents: bool,
    /// Whether it shows work that goes on.
    pub(super) shows_progress: bool,
    /// Whether files are watched for who asks.
    pub(super) watches_files: bool,
    /// Whether it knows nothing of Markdown.
    pub(super) is_plain: bool,
    /// Whether it leads through places to fill.
    pub(super) fills_snippets: bool,
}

impl Editor {
    pub(super) fn of(params: &Value) -> Editor {
        let can =
            |path: &str| params.pointer(&format!("/capabilities/{path}")).and_then(Value::as_bool).unwrap_or(false);
        let formats = params.pointer("/capabilities/textDocument/hover/contentFormat").and_then(Value::as_array);
        Editor {
            refreshes_lenses: can("workspace/codeLens/refreshSupport"),
            refreshes_hints: can("workspace/inlayHint/refreshSupport"),
            shows_documents: can("window/showDocument/support"),
            shows_progress: can("window/workDoneProgress"),
            watches_files: can("workspace/didChangeWatchedFiles/dynamicRegistration"),
            fills_snippets: can("textDocument/completion/completionItem/snippetSupport"),
            is_plain: formats.is_some_and(|formats| !formats.iter().any(|format| format == "markdown")),
        }
    }
}

/// `{"inlayHints": {"literals": true}, "preview": {"onChange": true, "opens": true}}`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Settings {
    /// Values beside plain numbers, too.
    pub(super) literal_values: bool,
    /// Whether the page follows changes, not only saves.
    pub(super) page_follows_changes: bool,
    /// Whether the editor opens the page by itself.
    pub(super) opens_page: bool,
}

impl Settings {
    /// What is not set stays.
    pub(super) fn set(&mut self, options: &Value) {
        let set = |path: &str, to: &mut bool| *to = options.pointer(path).and_then(Value::as_bool).unwrap_or(*to);
        set("/inlayHints/literals", &mut self.literal_values);
        set("/preview/onChange", &mut self.page_follows_changes);
        set("/preview/opens", &mut self.opens_page);
    }
}
