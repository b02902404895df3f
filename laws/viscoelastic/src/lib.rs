//! Viscoelastic: elastic spheres whose material relaxes; the restitution falls with the speed (Brilliantov et al. 1996).

mod series;
mod viscoelastic;

pub use viscoelastic::Viscoelastic;
