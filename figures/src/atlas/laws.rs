//! The laws and integrators of the atlas: one line each.

/// A normal law whose restitution can be chosen.
pub struct NormalLaw {
    /// Name of the law.
    pub name: &'static str,
    /// Contact block for a stiffness scale (1 is the usual one) and a restitution in (0, 1].
    pub block: fn(stiffness: f64, restitution: f64) -> String,
}

/// A tangential law.
pub struct TangentialLaw {
    /// Name of the law.
    pub name: &'static str,
    /// Contact fields for a friction coefficient.
    pub fields: fn(friction: f64) -> String,
}

/// Every normal law of the shipped catalog.
pub const NORMAL: &[NormalLaw] = &[
    NormalLaw {
        name: "LinearSpringDashpot",
        block: |k, e| format!("normal: LinearSpringDashpot(stiffness: {:?}, restitution: {e:?})", 1e5 * k),
    },
    NormalLaw {
        name: "Hertz",
        block: |k, e| format!("normal: Hertz(effective_modulus: {:?}, restitution: {e:?})", 1e7 * k),
    },
    NormalLaw {
        name: "PowerLaw",
        block: |k, e| format!("normal: PowerLaw(modulus: {:?}, exponent: 1, restitution: {e:?})", 1e8 * k),
    },
    NormalLaw {
        name: "Viscoelastic",
        block: |k, e| {
            format!(
                "normal: Viscoelastic(effective_modulus: {:?}, restitution: {e:?}, reference_speed: 1)",
                1e7 * k
            )
        },
    },
    NormalLaw {
        name: "WaltonBraun",
        block: |k, e| format!("normal: WaltonBraun(loading_stiffness: {:?}, restitution: {e:?})", 1e5 * k),
    },
    NormalLaw {
        name: "KondicNormal",
        block: |k, e| {
            format!(
                "contact_end: Overlap, normal: KondicNormal(young_modulus: {:?}, poisson_ratio: 0.3, reference_speed: 1, \
                 restitution: {e:?})",
                2e7 * k
            )
        },
    },
];

/// Every tangential law of the shipped catalog.
pub const TANGENTIAL: &[TangentialLaw] = &[
    TangentialLaw {
        name: "TangentialSpring",
        fields: |friction| {
            format!(
                "tangential: TangentialSpring(stiffness_ratio: 0.2857142857142857, friction: {friction:?})"
            )
        },
    },
    TangentialLaw {
        name: "Coulomb",
        fields: |friction| format!("tangential: Coulomb(friction: {friction:?})"),
    },
    TangentialLaw {
        name: "ViscousTangential",
        fields: |friction| {
            format!("tangential: ViscousTangential(tangential_restitution: -0.5, friction: {friction:?})")
        },
    },
    TangentialLaw {
        name: "KondicFriction",
        fields: |friction| format!("tangential: KondicFriction(damping_rate: 2000, friction: {friction:?})"),
    },
];

/// Names of the integrators, the default first.
pub const SCHEMES: [&str; 5] =
    ["VelocityVerlet", "ClassicVelocityVerlet", "ContactResolved", "Leapfrog", "SymplecticEuler"];
