//! Static, kinetic, rolling and drilling friction of bodies on a surface.

mod stick_slip;

pub use stick_slip::StickSlip;
