//! Parameters, and how stiffness and damping of the tangential spring follow from them.

use granule_law_api::{Dimension, DurationRule, Form, LawError, PairContext, ParamSpec, Params, ValueRange};

pub(crate) const TANGENTIAL_RESTITUTION: ParamSpec = ParamSpec {
    name: "tangential_restitution",
    symbol: "e_t0",
    doc: "Tangential restitution of a sticking contact, from -1 (no effect) through 0 to 1 (full reversal).",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange {
        low: granule_law_api::Bound::Inclusive(-1.0),
        high: granule_law_api::Bound::Inclusive(1.0),
        infinite: false,
    },
};
pub(crate) const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k_t",
    doc: "Tangential stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
pub(crate) const STIFFNESS_RATIO: ParamSpec = ParamSpec {
    name: "stiffness_ratio",
    symbol: "k_t/k_n",
    doc: "Tangential stiffness over the secant stiffness of the normal law.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE,
};
pub(crate) const EFFECTIVE_SHEAR_MODULUS: ParamSpec = ParamSpec {
    name: "effective_shear_modulus",
    symbol: "G*",
    doc: "Effective shear modulus, 1/G* = (2-nu_i)/G_i + (2-nu_j)/G_j: k_t = 8 G* sqrt(R* delta).",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
pub(crate) const STIFFNESS_PRESSURE: ParamSpec = ParamSpec {
    name: "stiffness_pressure",
    symbol: "K_t",
    doc: "Tangential stiffness per contact radius: k_t = K_t sqrt(R* delta) (K_t of LAMMPS gran/hertz).",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
pub(crate) const DAMPING: ParamSpec = ParamSpec {
    name: "damping",
    symbol: "gamma_t",
    doc: "Tangential damping coefficient, the same for every pair.",
    dimension: Dimension::DAMPING,
    range: ValueRange::NON_NEGATIVE,
};
pub(crate) const DAMPING_RATE: ParamSpec = ParamSpec {
    name: "damping_rate",
    symbol: "gamma_t/m12",
    doc: "Tangential damping coefficient per reduced mass (gamma_t of LAMMPS gran/hooke, gammat of LIGGGHTS hooke/stiffness).",
    dimension: Dimension::RATE,
    range: ValueRange::NON_NEGATIVE,
};
pub(crate) const DAMPING_RATIO: ParamSpec = ParamSpec {
    name: "damping_ratio",
    symbol: "gamma_t/gamma_n",
    doc: "Tangential over normal damping coefficient (x_gammat of LAMMPS pair granular).",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
pub(crate) const DAMPING_COEFFICIENT: ParamSpec = ParamSpec {
    name: "damping_coefficient",
    symbol: "alpha_t",
    doc: "gamma_t = alpha_t sqrt(k_t m12); LIGGGHTS hertz has alpha_t = 2 sqrt(5/6) |ln e|/sqrt(pi^2 + ln^2 e).",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
pub(crate) const DAMPING_RATE_PER_LENGTH: ParamSpec = ParamSpec {
    name: "damping_rate_per_length",
    symbol: "gamma_t",
    doc: "gamma_t of LAMMPS gran/hertz: damping coefficient m12 gamma_t sqrt(R* delta).",
    dimension: Dimension::new(-1, 0, -1),
    range: ValueRange::NON_NEGATIVE,
};
pub(crate) const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "mu",
    doc: "Friction coefficient of the Coulomb limit; inf for a contact that never slides.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { infinite: true, ..ValueRange::NON_NEGATIVE },
};

pub(crate) const PARAMETERS: &[&ParamSpec] = &[
    &TANGENTIAL_RESTITUTION,
    &STIFFNESS,
    &STIFFNESS_RATIO,
    &EFFECTIVE_SHEAR_MODULUS,
    &STIFFNESS_PRESSURE,
    &FRICTION,
    &DAMPING,
    &DAMPING_RATE,
    &DAMPING_RATIO,
    &DAMPING_COEFFICIENT,
    &DAMPING_RATE_PER_LENGTH,
];

const RESTITUTION_FORM: usize = 0;
const RATIO_FORM: usize = 1;
const STIFFNESS_FORM: usize = 2;
const STIFFNESS_RATE_FORM: usize = 3;
const STIFFNESS_RATIO_FORM: usize = 4;
const MINDLIN_FORM: usize = 5;
const MINDLIN_COEFFICIENT_FORM: usize = 6;

pub(crate) const FORMS: &[Form] = &[
    Form {
        doc: "Physical intent: an undamped spring that gives a sticking contact exactly this tangential restitution in the \
              hard limit. Needs a normal law whose contact duration has a closed form, and one inertia factor.",
        required: &[&TANGENTIAL_RESTITUTION, &FRICTION],
        optional: &[],
    },
    Form {
        doc: "Stiffness and damping as fractions of those of the normal law.",
        required: &[&STIFFNESS_RATIO, &FRICTION],
        optional: &[(&DAMPING_RATIO, 0.0)],
    },
    Form {
        doc: "One stiffness and one damping coefficient for every pair.",
        required: &[&STIFFNESS, &FRICTION],
        optional: &[(&DAMPING, 0.0)],
    },
    Form {
        doc: "As LAMMPS gran/hooke/history and LIGGGHTS hooke/stiffness: damping in proportion to the reduced mass.",
        required: &[&STIFFNESS, &DAMPING_RATE, &FRICTION],
        optional: &[],
    },
    Form {
        doc: "As LAMMPS pair granular linear_history: damping as a fraction of that of the normal law.",
        required: &[&STIFFNESS, &DAMPING_RATIO, &FRICTION],
        optional: &[],
    },
    Form {
        doc: "Mindlin stiffness without slip; damping as a fraction of that of the normal law (LAMMPS pair granular mindlin).",
        required: &[&EFFECTIVE_SHEAR_MODULUS, &FRICTION],
        optional: &[(&DAMPING_RATIO, 0.0)],
    },
    Form {
        doc: "Mindlin stiffness without slip with the damping of LIGGGHTS hertz.",
        required: &[&EFFECTIVE_SHEAR_MODULUS, &DAMPING_COEFFICIENT, &FRICTION],
        optional: &[],
    },
    Form {
        doc: "As LAMMPS gran/hertz/history and LIGGGHTS hertz/stiffness.",
        required: &[&STIFFNESS_PRESSURE, &DAMPING_RATE_PER_LENGTH, &FRICTION],
        optional: &[],
    },
];

/// Tangential stiffness k_t of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stiffness {
    /// The same for every pair.
    Fixed(f64),
    /// Factor times m12.
    Mass(f64),
    /// Factor times the secant stiffness of the normal law.
    Normal(f64),
    /// Factor times sqrt(R* δ).
    ContactRadius(f64),
}

/// Tangential damping coefficient γ_t of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Damping {
    /// No damper.
    Zero,
    /// The same for every pair.
    Fixed(f64),
    /// Factor times m12.
    Mass(f64),
    /// Factor times the damping of the normal law.
    Normal(f64),
    /// Factor times m12 sqrt(R* δ).
    MassContactRadius(f64),
    /// Factor times sqrt(k_t m12).
    Critical(f64),
}

impl Damping {
    fn unless_zero(value: f64, make: fn(f64) -> Self) -> Self {
        if value == 0.0 { Self::Zero } else { make(value) }
    }
}

/// The law as it is for one pair of materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Model {
    pub stiffness: Stiffness,
    pub damping: Damping,
    pub friction: f64,
}

impl Model {
    pub fn new(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        let value = |spec: &ParamSpec| params.value(spec);
        let ratio =
            || -> Result<_, LawError> { Ok(Damping::unless_zero(value(&DAMPING_RATIO)?, Damping::Normal)) };
        let (stiffness, damping) = match params.form() {
            RESTITUTION_FORM => (stiffness_for(value(&TANGENTIAL_RESTITUTION)?, pair)?, Damping::Zero),
            RATIO_FORM => (Stiffness::Normal(value(&STIFFNESS_RATIO)?), ratio()?),
            STIFFNESS_FORM => {
                (Stiffness::Fixed(value(&STIFFNESS)?), Damping::unless_zero(value(&DAMPING)?, Damping::Fixed))
            }
            STIFFNESS_RATE_FORM => (
                Stiffness::Fixed(value(&STIFFNESS)?),
                Damping::unless_zero(value(&DAMPING_RATE)?, Damping::Mass),
            ),
            STIFFNESS_RATIO_FORM => (Stiffness::Fixed(value(&STIFFNESS)?), ratio()?),
            MINDLIN_FORM => (Stiffness::ContactRadius(8.0 * value(&EFFECTIVE_SHEAR_MODULUS)?), ratio()?),
            MINDLIN_COEFFICIENT_FORM => (
                Stiffness::ContactRadius(8.0 * value(&EFFECTIVE_SHEAR_MODULUS)?),
                Damping::unless_zero(value(&DAMPING_COEFFICIENT)?, Damping::Critical),
            ),
            _ => (
                Stiffness::ContactRadius(value(&STIFFNESS_PRESSURE)?),
                Damping::unless_zero(value(&DAMPING_RATE_PER_LENGTH)?, Damping::MassContactRadius),
            ),
        };
        Ok(Self { stiffness, damping, friction: value(&FRICTION)? })
    }
}

/// Columns that a form reads beyond those that every form needs.
pub(crate) fn extra_reads(params: &Params) -> granule_law_api::Columns {
    use granule_law_api::Columns;
    let damps = params.get(&DAMPING_RATIO).is_some_and(|ratio| ratio != 0.0);
    let by_damping = if damps { Columns::NORMAL_DAMPING } else { Columns::NONE };
    match params.form() {
        // Whether the ratio to the normal stiffness or the mass is needed depends on the normal law.
        RESTITUTION_FORM => Columns::NORMAL_STIFFNESS.and(Columns::REDUCED_MASS),
        RATIO_FORM => Columns::NORMAL_STIFFNESS.and(by_damping),
        STIFFNESS_FORM => Columns::NONE,
        STIFFNESS_RATE_FORM => Columns::REDUCED_MASS,
        STIFFNESS_RATIO_FORM => by_damping,
        MINDLIN_FORM => Columns::REDUCED_RADIUS.and(by_damping),
        _ => Columns::REDUCED_RADIUS.and(Columns::REDUCED_MASS),
    }
}

/// True if k_t cannot change during a contact with a linear normal law.
pub(crate) fn constant_stiffness(params: &Params) -> bool {
    params.form() < MINDLIN_FORM
}

/// The spring that gives a sticking contact the tangential restitution `restitution`: ω_t t_c = arccos(-e_t0), with the
/// true duration of the contact (Luding 1998, Eqs. (55)-(57), errata L-E5 and L-E6).
fn stiffness_for(restitution: f64, pair: &PairContext) -> Result<Stiffness, LawError> {
    let blame = |message: String, help: &str| LawError::new(message).at("tangential_restitution").help(help);
    let q = pair.inertia_factor;
    if !q.is_single() {
        return Err(blame(
            format!(
                "one tangential restitution needs one inertia factor, but the bodies have {} to {}",
                q.min, q.max
            ),
            "give tangential_restitution per pair of materials with one shape each, or give stiffness_ratio or stiffness",
        ));
    }
    let inertia = q.max / (1.0 + q.max);
    let phase = (-restitution).acos();
    match pair.normal.map(|normal| normal.duration) {
        Some(DurationRule::Constant(duration)) => {
            let omega = phase / duration;
            Ok(Stiffness::Mass(inertia * omega * omega))
        }
        Some(DurationRule::Oscillator(factor)) => {
            let ratio = phase / factor;
            Ok(Stiffness::Normal(inertia * ratio * ratio))
        }
        Some(DurationRule::Unknown) | None => Err(blame(
            "needs a normal law whose contact duration is the same at every speed".to_string(),
            "use LinearSpringDashpot with (restitution, contact_duration) or (stiffness, restitution), \
             or give stiffness_ratio instead",
        )),
    }
}
