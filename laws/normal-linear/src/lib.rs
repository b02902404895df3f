//! Linear spring with dashpot along the normal.

mod linear_spring_dashpot;

pub use linear_spring_dashpot::LinearSpringDashpot;
