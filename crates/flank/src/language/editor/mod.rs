//! What an editor asks of a text: findings with places and changes, hover, definitions, uses, completion, tokens.
//!
//! Places are bytes of files; nothing of an editor's protocol is known here.

pub(crate) mod analysis;
pub(crate) mod builtins;
pub(crate) mod completion;
pub(crate) mod cursor;
pub(crate) mod describe;
pub(crate) mod hover;
pub(crate) mod names;
pub(crate) mod navigation;
pub(crate) mod outline;
pub(crate) mod rename;
pub(crate) mod shipped;
pub(crate) mod tokens;
