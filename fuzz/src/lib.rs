//! The functions that are fuzzed; they are kept with the tests, which call them too.

#[path = "../../tests/src/conversation.rs"]
pub mod conversation;
#[path = "../../tests/src/layout.rs"]
pub mod layout;
#[path = "../../tests/src/targets.rs"]
pub mod targets;
