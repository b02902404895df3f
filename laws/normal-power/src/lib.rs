//! Power laws along the normal, Hertz among them.

mod closed_form;
mod design;
mod hertz;
mod power_law;

pub use hertz::Hertz;
pub use power_law::PowerLaw;
