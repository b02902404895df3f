//! What a law says about itself.

use crate::{ContactEnd, Dimension, Form, ParamSpec};

/// Place of a stage in a composition. The order of the variants is the order of execution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Slot {
    /// Repulsion along the normal.
    Normal,
    /// Attraction along the normal; adds to the normal force.
    Cohesion,
    /// Force in the tangent plane.
    Tangential,
    /// Torque against rolling.
    Rolling,
    /// Torque about the normal.
    Torsion,
    /// The whole of an instantaneous impact, for the event-driven driver; not a stage of a composition.
    Collision,
}

impl Slot {
    /// The slots of a composition in the order of execution.
    pub const ALL: [Self; 5] = [Self::Normal, Self::Cohesion, Self::Tangential, Self::Rolling, Self::Torsion];

    /// Name of the slot in a scene.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Cohesion => "cohesion",
            Self::Tangential => "tangential",
            Self::Rolling => "rolling",
            Self::Torsion => "torsion",
            Self::Collision => "collision",
        }
    }
}

/// A set of chunk columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns(u32);

impl Columns {
    /// No column.
    pub const NONE: Self = Self(0);
    /// Tangential velocity v_t.
    pub const TANGENTIAL_VELOCITY: Self = Self(1);
    /// Relative spin ω_i - ω_j.
    pub const RELATIVE_SPIN: Self = Self(1 << 1);
    /// Reduced mass m12.
    pub const REDUCED_MASS: Self = Self(1 << 2);
    /// Reduced radius R*.
    pub const REDUCED_RADIUS: Self = Self(1 << 3);
    /// Normal force f_n.
    pub const NORMAL_FORCE: Self = Self(1 << 4);
    /// Secant stiffness of the normal stage.
    pub const NORMAL_STIFFNESS: Self = Self(1 << 5);
    /// Damping of the normal stage.
    pub const NORMAL_DAMPING: Self = Self(1 << 6);
    /// Tangential force.
    pub const TANGENTIAL_FORCE: Self = Self(1 << 7);
    /// Rolling or torsion torque.
    pub const TORQUE: Self = Self(1 << 8);
    /// Normal velocity v_n.
    pub const NORMAL_VELOCITY: Self = Self(1 << 9);

    const NAMES: [&'static str; 10] = [
        "tangential velocity",
        "relative spin",
        "reduced mass",
        "reduced radius",
        "normal force",
        "normal stiffness",
        "normal damping",
        "tangential force",
        "torque",
        "normal velocity",
    ];

    /// Both sets together.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if every column of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The columns of this set that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// True for the empty set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Names of the columns, in the order of their declaration.
    pub fn names(self) -> Vec<&'static str> {
        Self::NAMES
            .iter()
            .enumerate()
            .filter(|(bit, _)| self.0 >> bit & 1 == 1)
            .map(|(_, name)| *name)
            .collect()
    }
}

/// What happens to a history column when the two bodies swap their roles i and j.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// It stays (a scalar memory such as the largest overlap).
    Even,
    /// It changes its sign (a vector from j's view to i's).
    Odd,
}

/// One quantity that a contact remembers from step to step. It is zero when a contact begins.
#[derive(Clone, Copy, Debug)]
pub struct HistoryColumn {
    /// Name, as in output files.
    pub name: &'static str,
    /// Number of components: 1 or 3.
    pub components: usize,
    /// What a swap of i and j does.
    pub parity: Parity,
    /// SI dimension.
    pub dimension: Dimension,
}

/// Where a formula comes from.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Author and year, or the short title of the work.
    pub work: &'static str,
    /// Equation or section of that work.
    pub place: &'static str,
    /// What differs from the printed form, or "" if nothing does.
    pub note: &'static str,
}

/// Everything that is known about a law without running it.
#[derive(Clone, Copy, Debug)]
pub struct LawInfo {
    /// Name in scenes: a CamelCase identifier, unique in the registry.
    pub name: &'static str,
    /// One line on what it models.
    pub summary: &'static str,
    /// The formula in plain text, with the symbols of the parameters.
    pub formula: &'static str,
    /// Where it comes from.
    pub sources: &'static [Source],
    /// Slot in the composition.
    pub slot: Slot,
    /// Columns that it reads besides the overlap and the normal, in whatever form
    /// ([`ContactLaw::reads`](crate::ContactLaw::reads) may say fewer).
    pub reads: Columns,
    /// Columns that it writes.
    pub writes: Columns,
    /// What a contact remembers for it.
    pub history: &'static [HistoryColumn],
    /// Every parameter of every form.
    pub parameters: &'static [&'static ParamSpec],
    /// The sets of parameters by which a user may choose it.
    pub forms: &'static [Form],
    /// Parameter sets that are typical in use: the conformance kit runs them, the manual shows them.
    pub examples: &'static [&'static [(&'static str, f64)]],
    /// Contact-end rules that it knows (empty: it does not care).
    pub contact_ends: &'static [ContactEnd],
    /// True if it promises never to create energy; the conformance kit holds it to that.
    pub dissipative: bool,
}

impl LawInfo {
    /// Number of scalar history columns.
    pub fn history_width(&self) -> usize {
        self.history.iter().map(|column| column.components).sum()
    }
}
