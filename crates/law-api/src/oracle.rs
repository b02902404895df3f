//! What a law promises about a single impact: closed forms that the conformance kit holds it to.

/// A head-on impact of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Reduced mass m12 \[kg\].
    pub reduced_mass: f64,
    /// Reduced radius R* \[m\].
    pub reduced_radius: f64,
    /// Normal speed on approach v_0 \[m/s\].
    pub normal_speed: f64,
}

/// What comes out of a head-on impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactOutcome {
    /// Duration of the contact t_c \[s\].
    pub duration: f64,
    /// Largest overlap \[m\].
    pub maximum_overlap: f64,
    /// Restitution e_n: ratio of the normal speeds after and before.
    pub restitution: f64,
}

/// An oblique impact in the hard limit (the normal does not turn during the contact), with an *elastic linear* normal
/// force f_n = k δ that the conformance kit supplies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObliqueImpact {
    /// Normal part of the impact.
    pub impact: Impact,
    /// Stiffness k of the elastic normal force \[N/m\].
    pub normal_stiffness: f64,
    /// Duration of the contact, π sqrt(m12/k) \[s\].
    pub duration: f64,
    /// Tangential speed of the contact point before the impact \[m/s\].
    pub tangential_speed: f64,
    /// Tangential mass m_t: 1/m_t = (1/m1)(1+1/q1) + (1/m2)(1+1/q2) \[kg\] (erratum L-E18).
    pub tangential_mass: f64,
}

/// Closed form of [`ImpactOutcome`] for a head-on impact.
pub type NormalOracle = Box<dyn Fn(&Impact) -> ImpactOutcome + Send + Sync>;
/// Closed form of the tangential velocity of the contact point after an oblique impact \[m/s\]; `None` where there is none.
pub type TangentialOracle = Box<dyn Fn(&ObliqueImpact) -> Option<f64> + Send + Sync>;

/// How a law can be checked without trusting it.
pub enum Oracle {
    /// For normal laws. The contact-end rule is that of the context.
    Normal(NormalOracle),
    /// For tangential laws.
    Tangential(TangentialOracle),
    /// Nothing given. The conformance kit fails such a law.
    Missing,
}

/// Time scale of a contact, from which the plan chooses or refuses a time step.
///
/// A tangential law gives stiffness and damping as the reduced mass m12 feels them, that is multiplied by m12/m_t, so that
/// sqrt(stiffness/m12) is a frequency for every law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeScale {
    /// Duration of the contact \[s\].
    pub duration: f64,
    /// Largest tangent stiffness during it \[N/m\].
    pub stiffness: f64,
    /// Largest damping during it \[kg/s\].
    pub damping: f64,
    /// Largest overlap during it \[m\]; zero if the law does not bound it.
    pub overlap: f64,
}
