//! What speed costs in accuracy, for one scene.
//!
//! [`trade`] runs a scene over a ladder of settings (steps in a contact, integrator, arithmetic of the laws, stiffness,
//! physics left out), measures the error of each in the quantities that the scene names against a reference that it
//! establishes itself, and what each costs. Settings that another one beats in both are marked; what is left is the front
//! to choose from, and [`chosen_scene`] writes a choice back into the text of the scene.
//!
//! Every setting runs several times: scenes with random parts with other seeds, all others with a step that differs by a
//! few per cent, which moves the moments at which contacts begin within their steps. A scene of few bodies is compared run
//! by run, and the worst run counts. In a scene of many bodies single paths mean nothing after some collisions: means over
//! the runs are compared, and their standard errors are told.

mod accuracy;
mod advise;
mod error;
mod files;
mod front;
mod hard;
mod measure;
mod meter;
mod models;
mod observable;
mod page;
mod reference;
mod setting;
mod single;
mod store;
mod study;

pub use accuracy::{Choice, Realised, decide};
pub use advise::{Advice, Claim, Group, Verdict, advice_json, advise};
pub use error::TradeError;
pub use files::write;
pub use front::Scored;
pub use meter::Meter;
pub use models::{Compared, Difference, Model, ModelComparison, ModelOptions, compare_models, models_json};
pub use page::{document, front_plot, json};
pub use reference::Reference;
pub use setting::{Omission, Setting, chosen_scene};
pub use study::{Options, Study, Watch, trade};
