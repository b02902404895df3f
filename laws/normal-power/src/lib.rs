//! Power laws along the normal, Hertz among them.

mod closed_form;
mod hertz;

pub use hertz::Hertz;
