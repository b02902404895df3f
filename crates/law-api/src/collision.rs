//! Collision rules: what an instantaneous impact of two hard bodies does to their velocities.
//!
//! A rule sees the relative motion of the contact points in the frame of the contact, and answers with an impulse. Masses
//! and inertia enter through two effective masses alone, so one rule serves bodies of any masses, radii and inertia
//! factors, and walls, which are infinitely heavy.

use crate::{API_VERSION, LawError, LawInfo, Params, RegistryError, nearest};

/// Two bodies at the moment in which they touch and approach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Speed of approach v_n = -v_c·n \[m/s\], greater than zero.
    pub normal_speed: f64,
    /// Tangential velocity of the contact points, spins included \[m/s\]; zero for a smooth rule.
    pub tangential_velocity: [f64; 3],
    /// Reduced mass m12 = 1/(1/m1 + 1/m2) \[kg\].
    pub reduced_mass: f64,
    /// Mass that a tangential impulse feels, 1/m_t = (1 + 1/q1)/m1 + (1 + 1/q2)/m2 \[kg\] (erratum L-E18).
    pub tangential_mass: f64,
    /// The contact-duration model lets this collision lose no energy along the normal: e_n = 1.
    pub elastic: bool,
}

/// Impulse of a collision on the first body; the second gets the opposite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CollisionImpulse {
    /// Along the normal that points to the first body \[kg m/s\], at least zero.
    pub normal: f64,
    /// In the tangent plane \[kg m/s\].
    pub tangential: [f64; 3],
}

/// A rule with its parameters folded in.
pub trait CollisionRule: std::fmt::Debug + Send + Sync {
    /// Impulse on the first body.
    fn impulse(&self, collision: &Collision) -> CollisionImpulse;
    /// Normal restitution at a speed of approach \[m/s\].
    fn restitution(&self, normal_speed: f64) -> f64;
    /// True if the tangential motion and the spins matter.
    fn is_rough(&self) -> bool;
    /// True if some collision loses energy along the normal.
    fn is_inelastic(&self) -> bool;
}

/// A law of instantaneous collisions. Implement it for a unit type and call
/// [`register_collision_law!`](crate::register_collision_law).
pub trait CollisionLaw: 'static {
    /// What the law says about itself; its slot is [`Slot::Collision`](crate::Slot::Collision).
    const INFO: LawInfo;

    /// Folds parameters into a rule.
    ///
    /// # Errors
    /// Parameters that would create energy, or that contradict each other.
    fn compile(params: &Params) -> Result<Box<dyn CollisionRule>, LawError>;
}

/// One registered collision law.
pub struct CollisionEntry {
    /// What the law says about itself.
    pub info: &'static LawInfo,
    /// Crate that registered it.
    pub crate_name: &'static str,
    /// Version of that crate.
    pub crate_version: &'static str,
    /// [`API_VERSION`] that it was built against.
    pub api_version: u32,
    /// [`CollisionLaw::compile`].
    pub compile: fn(&Params) -> Result<Box<dyn CollisionRule>, LawError>,
}

impl CollisionEntry {
    /// The entry of a law.
    pub const fn of<L: CollisionLaw>(crate_name: &'static str, crate_version: &'static str) -> Self {
        Self { info: &L::INFO, crate_name, crate_version, api_version: API_VERSION, compile: L::compile }
    }
}

impl std::fmt::Debug for CollisionEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} {})", self.info.name, self.crate_name, self.crate_version)
    }
}

inventory::collect!(CollisionEntry);

/// Registers a collision law: `register_collision_law!(MyRule);` at the top level of its module.
#[macro_export]
macro_rules! register_collision_law {
    ($law:ty) => {
        $crate::reexport::inventory::submit! {
            $crate::CollisionEntry::of::<$law>(env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
        }
    };
}

/// Orders collision laws by name, and refuses two of one name or one of another interface version.
pub(crate) fn order(entries: &mut [&'static CollisionEntry]) -> Result<(), RegistryError> {
    entries.sort_by_key(|entry| (entry.info.name, entry.crate_name));
    for pair in entries.windows(2) {
        if pair[0].info.name == pair[1].info.name {
            return Err(RegistryError::Duplicate {
                name: pair[0].info.name.to_string(),
                crates: [pair[0].crate_name.to_string(), pair[1].crate_name.to_string()],
            });
        }
    }
    match entries.iter().find(|entry| entry.api_version != API_VERSION) {
        Some(entry) => {
            Err(RegistryError::ApiVersion { name: entry.info.name.to_string(), found: entry.api_version })
        }
        None => Ok(()),
    }
}

/// The collision law of that name among `entries`.
pub(crate) fn find(
    entries: &[&'static CollisionEntry],
    name: &str,
) -> Result<&'static CollisionEntry, RegistryError> {
    entries.iter().copied().find(|entry| entry.info.name == name).ok_or_else(|| RegistryError::Unknown {
        name: name.to_string(),
        nearest: nearest(name, entries.iter().map(|entry| entry.info.name)).map(str::to_string),
        known: entries.iter().map(|entry| entry.info.name.to_string()).collect(),
    })
}
