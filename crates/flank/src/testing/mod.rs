//! `flank test`: specs that say what they are to be like.

mod explain;
mod find;
mod judge;
mod junit;
mod points;
mod quantities;
mod request;
pub(crate) mod result;
mod run;
mod snapshot;
mod text;
mod values;

pub use find::find_specs;
pub use junit::junit;
pub use request::TestRequest;
pub use run::{test, test_spec};
pub use snapshot::accept_snapshot;
