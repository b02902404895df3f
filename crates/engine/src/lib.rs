//! The step: candidates, contacts, laws, forces.
//!
//! Bodies are sorted along a space-filling curve and cut into *tiles* of consecutive bodies whose size depends on their
//! number alone. A tile evaluates the pairs whose first body it owns. What a pair does to a body of another tile goes
//! into the tile's outbox; the owner adds it in a fixed order before it integrates. So results are the same bits for any
//! number of threads, and no contact is evaluated twice.
//!
//! There is no input or output, clock, environment or randomness in here.

mod blame;
mod chunk;
mod dispatch;
mod engine;
mod error;
mod gather;
mod guards;
mod history;
mod level;
mod list;
mod lists;
mod prefetch;
mod rebuild;
mod records;
mod resolve;
mod saved;
mod scatter;
mod slices;
mod space;
mod substrate;
mod tally;
mod tile;
mod walls;

pub use engine::{Engine, Phase};
pub use error::EngineError;
pub use granule_state::InstructionSet;
pub use guards::{Alarm, AlarmKind};
pub use resolve::Losses;
pub use saved::EngineState;
pub use substrate::{SubstrateTally, SubstrateWork, slips};
pub use tally::{ContactForce, ContactPartner, ContactRecord, Tally, Work};
