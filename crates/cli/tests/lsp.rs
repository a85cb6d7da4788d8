//! `flank lsp` over pipes, as an editor uses it.

mod support;

#[path = "lsp/client.rs"]
mod client;
#[path = "lsp/completion.rs"]
mod completion;
#[path = "lsp/editors.rs"]
mod editors;
#[path = "lsp/focus.rs"]
mod focus;
#[path = "lsp/older.rs"]
mod older;
#[path = "lsp/paths.rs"]
mod paths;
#[path = "lsp/sessions.rs"]
mod sessions;
#[path = "lsp/shipped.rs"]
mod shipped;
#[path = "lsp/told.rs"]
mod told;
#[path = "lsp/work.rs"]
mod work;
#[path = "lsp/wrong.rs"]
mod wrong;
