//! Parameters, and the stiffnesses that follow from them.

use std::f64::consts::FRAC_PI_2;

use granule_law_api::{
    Columns, ContactEnd, Dimension, Form, LawError, PairContext, ParamSpec, Params, ValueRange,
};

const LOADING_STIFFNESS: ParamSpec = ParamSpec {
    name: "loading_stiffness",
    symbol: "k_1",
    doc: "Stiffness of the first loading.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const UNLOADING_STIFFNESS: ParamSpec = ParamSpec {
    name: "unloading_stiffness",
    symbol: "k_2",
    doc: "Stiffness of un- and reloading, at least k_1. The restitution is sqrt(k_1/k_2).",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const LARGEST_UNLOADING_STIFFNESS: ParamSpec = ParamSpec {
    name: "largest_unloading_stiffness",
    symbol: "k_2",
    doc: "Stiffness of un- and reloading at and beyond the overlap delta_lim = k_2/(k_2 - k_1) phi 2 R*, more than k_1.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const PLASTICITY_DEPTH: ParamSpec = ParamSpec {
    name: "plasticity_depth",
    symbol: "phi",
    doc: "Plastic overlap at delta_lim over 2 R*.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE,
};
const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Restitution of a head-on impact; k_2 = k_1/e_n^2 would be infinite for zero.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};
const CONTACT_DURATION: ParamSpec = ParamSpec {
    name: "contact_duration",
    symbol: "t_c",
    doc: "Duration of a head-on contact under the chosen end of contact, the same for every pair.",
    dimension: Dimension::TIME,
    range: ValueRange::POSITIVE,
};

pub(crate) const PARAMETERS: &[&ParamSpec] = &[
    &RESTITUTION,
    &CONTACT_DURATION,
    &LOADING_STIFFNESS,
    &UNLOADING_STIFFNESS,
    &LARGEST_UNLOADING_STIFFNESS,
    &PLASTICITY_DEPTH,
];

pub(crate) const FORMS: &[Form] = &[
    Form {
        doc: "Physical intent: k_1 and k_2 in proportion to the reduced mass, so that every pair has exactly this restitution \
              and duration at every speed.",
        required: &[&RESTITUTION, &CONTACT_DURATION],
        optional: &[],
    },
    Form {
        doc: "One stiffness of loading, and exactly this restitution.",
        required: &[&LOADING_STIFFNESS, &RESTITUTION],
        optional: &[],
    },
    Form { doc: "Both stiffnesses.", required: &[&LOADING_STIFFNESS, &UNLOADING_STIFFNESS], optional: &[] },
    Form {
        doc: "As LIGGGHTS hooke/hysteresis without adhesion and dashpot: k_2 grows with the largest overlap; the restitution \
              falls with the speed.",
        required: &[&LOADING_STIFFNESS, &LARGEST_UNLOADING_STIFFNESS, &PLASTICITY_DEPTH],
        optional: &[],
    },
];

/// How the stiffnesses follow from mass and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Model {
    /// k_1 the same for every pair, k_1/k_2 constant.
    Fixed { loading: f64, ratio: f64 },
    /// k_1 = `per_mass` · m12, k_1/k_2 constant.
    Proportional { per_mass: f64, ratio: f64 },
    /// k_2 grows linearly with δ_max up to `largest` at k_2/(k_2 - k_1) φ 2 R*.
    Growing { loading: f64, largest: f64, depth: f64 },
}

/// Stiffnesses of one pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Branches {
    /// k_1 \[N/m\].
    pub loading: f64,
    /// k_2, the largest if it grows \[N/m\].
    pub largest: f64,
    /// Overlap at which k_2 is the largest \[m\]; zero if it is constant.
    pub limit: f64,
}

impl Branches {
    /// k_2 of a contact with this largest overlap.
    pub fn unloading(&self, largest_overlap: f64) -> f64 {
        if largest_overlap < self.limit {
            self.loading + (self.largest - self.loading) * largest_overlap / self.limit
        } else {
            self.largest
        }
    }
}

/// Duration over sqrt(m12/k_1): up to zero force (Luding 1998, Eq. (46), with k_2 = k_1/e²), or up to zero overlap, δ_0/(e v_0)
/// later.
pub(crate) fn duration_factor(restitution: f64, end: ContactEnd) -> f64 {
    let e = restitution;
    let force = FRAC_PI_2 * (1.0 + e);
    match end {
        ContactEnd::Force => force,
        ContactEnd::Overlap => force + (1.0 - e) * (1.0 + e) / e,
    }
}

impl Model {
    pub fn new(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        let value = |spec: &ParamSpec| params.value(spec);
        match params.form() {
            0 => {
                let e = value(&RESTITUTION)?;
                let root = duration_factor(e, pair.contact_end) / value(&CONTACT_DURATION)?;
                Ok(Self::Proportional { per_mass: root * root, ratio: e * e })
            }
            1 => {
                let e = value(&RESTITUTION)?;
                Ok(Self::Fixed { loading: value(&LOADING_STIFFNESS)?, ratio: e * e })
            }
            2 => {
                let (loading, unloading) = (value(&LOADING_STIFFNESS)?, value(&UNLOADING_STIFFNESS)?);
                if unloading < loading {
                    return Err(smaller(unloading, loading, &UNLOADING_STIFFNESS)
                        .help("give unloading_stiffness >= loading_stiffness, or restitution instead"));
                }
                Ok(Self::Fixed { loading, ratio: loading / unloading })
            }
            _ => {
                let (loading, largest) = (value(&LOADING_STIFFNESS)?, value(&LARGEST_UNLOADING_STIFFNESS)?);
                if largest <= loading {
                    return Err(smaller(largest, loading, &LARGEST_UNLOADING_STIFFNESS)
                        .help("give largest_unloading_stiffness > loading_stiffness"));
                }
                Ok(Self::Growing { loading, largest, depth: value(&PLASTICITY_DEPTH)? })
            }
        }
    }

    /// Columns that a form reads beyond those that every form needs.
    pub fn extra_reads(params: &Params) -> Columns {
        match params.form() {
            0 => Columns::REDUCED_MASS,
            1 | 2 => Columns::NONE,
            _ => Columns::REDUCED_RADIUS,
        }
    }

    pub fn at(&self, reduced_mass: f64, reduced_radius: f64) -> Branches {
        match *self {
            Self::Fixed { loading, ratio } => Branches { loading, largest: loading / ratio, limit: 0.0 },
            Self::Proportional { per_mass, ratio } => {
                let loading = per_mass * reduced_mass;
                Branches { loading, largest: loading / ratio, limit: 0.0 }
            }
            Self::Growing { loading, largest, depth } => Branches {
                loading,
                largest,
                limit: limit_per_radius(loading, largest, depth) * reduced_radius,
            },
        }
    }

    /// Duration over sqrt(m12/k_1), if it does not depend on the speed.
    pub fn duration_factor(&self, end: ContactEnd) -> Option<f64> {
        match *self {
            Self::Fixed { ratio, .. } | Self::Proportional { ratio, .. } => {
                Some(duration_factor(ratio.sqrt(), end))
            }
            Self::Growing { .. } => None,
        }
    }
}

/// δ_lim/R*.
pub(crate) fn limit_per_radius(loading: f64, largest: f64, depth: f64) -> f64 {
    largest / (largest - loading) * depth * 2.0
}

fn smaller(unloading: f64, loading: f64, at: &ParamSpec) -> LawError {
    LawError::new(format!(
        "{unloading} N/m is not more than the stiffness of loading, {loading} N/m: the contact would create energy"
    ))
    .at(at.name)
}
