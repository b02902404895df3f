//! What an engine of rolling bodies is made of.

use granule_geometry::Motion;
use granule_law_api::SurfaceFriction;

use crate::Setup;

/// What bodies do between collisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Between {
    /// They slide and roll along arcs.
    Arcs {
        /// Aim for the error of a place over one piece of an arc whose friction turns \[m\], greater than zero. An arc
        /// is exact, however long, if nothing turns its friction.
        error: f64,
    },
    /// Nothing: a collision ends as if its slides were over at once, with the effective restitution (e Q - 1)/(1 + Q) of
    /// Kondic 1999, Eq. (68), and bodies roll without friction.
    EffectiveRestitution,
}

/// Everything that an engine of rolling bodies needs.
#[derive(Clone, Debug)]
pub struct RollingSetup {
    /// Bodies, side walls and rules. Bodies stand on the plane z = `height`, or are frozen anywhere.
    pub base: Setup,
    /// Height of the plane \[m\].
    pub height: f64,
    /// Motion of the plane along x and y; it must not turn.
    pub motion: Motion,
    /// Friction of the plane for each material; `None` for materials of frozen bodies alone.
    pub friction: Vec<Option<SurfaceFriction>>,
    /// What happens between collisions.
    pub between: Between,
    /// Work and dissipation are accounted for.
    pub ledger: bool,
}
