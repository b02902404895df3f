//! The block of a substrate.

use super::{Block, FROZEN, need, opt};

pub const SUBSTRATE: Block = Block {
    name: "Substrate",
    doc: "`substrate: (laws: { \"steel\": StickSlip(..) })`: a plane of constant z under the bodies, which roll or slide on it \
          without overlap. Its friction is found from the sum of all other forces on a body (Kondic 1999). It costs less \
          than a wall and has no stiffness; the centre of a body of radius R starts at least R above it.",
    fields: &[
        opt("height", "length in m", "0", "z of the surface."),
        opt(
            "motion",
            "`Static`, `Constant(..)`, `Sinusoidal(..)`, `Table([..])` or `Rotation(..)`",
            "`Static`",
            "How it moves in its own plane: along x and y, or turning about z. Walls that move with it have the same motion.",
        ),
        opt(
            "inclination",
            "angle in rad, between -pi/2 and pi/2",
            "0",
            "Tilts the surface: gravity, which the scene then gives along -z, gets a component along -y (Kondic 1999, Eq. (1)).",
        ),
        opt(
            "confined",
            FROZEN,
            "true",
            "Bodies never leave the surface, at whatever vertical force. If false, they lift off where the force of the \
             surface vanishes, fly, and land.",
        ),
        opt(
            "restitution",
            "number from 0 to 1",
            "0",
            "Ratio of the vertical speeds after and before a landing; needs `confined: false`.",
        ),
        need(
            "laws",
            "map of names of materials to substrate laws",
            "How bodies of each material roll and slide. `granule laws` lists the laws with their parameters.",
        ),
        opt(
            "rolling_friction",
            "map of names of materials to lists of (velocity in m/s, coefficient)",
            "the law's parameter",
            "Coefficient of rolling friction by the rolling speed: straight lines between the rows, constant outside.",
        ),
    ],
};
