//! What the law says about itself.

use granule_law_api::{
    Columns, ContactLaw, CoulombTest, Dimension, HistoryColumn, Impact, LawError, LawInfo, Oracle,
    PairContext, Params, Parity, Real, Slot, Source, Stage, TimeScale, register_law,
};

use crate::forms::{Damping, FORMS, Model, PARAMETERS, Stiffness, constant_stiffness, extra_reads};
use crate::{prediction, stage};

/// Tangential spring and damper under a Coulomb limit, with history (Cundall and Strack 1979; Luding 1998, Sec. 7.3).
///
/// The spring ξ is the slip accumulated since the contact began, turned with the contact. The force on i is
/// -(k_t ξ + γ_t v_t), held to the Coulomb limit. How the spring turns, which force is held to the limit and what
/// the limit is computed from are [conventions](granule_law_api::Conventions) of the run:
///
/// | convention | what happens |
/// |---|---|
/// | `SpringThenTotal` | ξ is cut to limit/k_t, then the force to the limit |
/// | `Total` (LAMMPS) | the force is cut to the limit; ξ becomes what, with the damper, gives that force. With a limit of the `Magnitude` kind an unstretched spring that would slide carries no force, as in LAMMPS at the start of a run |
/// | `SpringOnly` (LIGGGHTS) | ξ is cut to limit/k_t; the damper acts only while the spring holds |
///
/// The Mindlin forms let k_t follow the contact radius without rescaling ξ, as the peers do. That is not consistent with
/// energy conservation (Elata and Berryman 1996): ξ²/2 dk_t/dt enters the ledger as viscous power of either sign,
/// and these forms do not promise to be dissipative. A stiffness ratio to a non-linear normal law shares this flaw; there
/// the ledger shows it as residual.
pub struct TangentialSpring;

impl ContactLaw for TangentialSpring {
    const INFO: LawInfo = LawInfo {
        name: "TangentialSpring",
        summary: "Tangential spring with history and damper under a Coulomb limit: static and dynamic friction.",
        formula: "f_t = -(k_t xi + gamma_t v_t), d(xi)/dt = v_t in the turning tangent plane, |f_t| <= mu f_n",
        sources: &[
            Source { work: "Cundall and Strack 1979", place: "Sec. 2", note: "" },
            Source {
                work: "Luding 1998",
                place: "Sec. 7.3, Eqs. (53)-(57)",
                note: "errata L-E5, L-E6: tangential restitution with the true contact duration",
            },
            Source {
                work: "Mindlin 1949",
                place: "stiffness without slip",
                note: "not rescaled on unloading",
            },
        ],
        slot: Slot::Tangential,
        reads: Columns::TANGENTIAL_VELOCITY
            .and(Columns::NORMAL_FORCE)
            .and(Columns::NORMAL_VELOCITY)
            .and(Columns::NORMAL_STIFFNESS)
            .and(Columns::NORMAL_DAMPING)
            .and(Columns::REDUCED_MASS)
            .and(Columns::REDUCED_RADIUS),
        writes: Columns::TANGENTIAL_FORCE,
        history: &[HistoryColumn {
            name: "tangential_spring",
            components: 3,
            parity: Parity::Odd,
            dimension: Dimension::LENGTH,
        }],
        parameters: PARAMETERS,
        forms: FORMS,
        examples: &[
            &[("tangential_restitution", 0.5), ("friction", f64::INFINITY)],
            &[("tangential_restitution", 1.0), ("friction", 0.3)],
            &[("stiffness_ratio", 2.0 / 7.0), ("friction", 0.5)],
            &[("stiffness_ratio", 0.8), ("friction", 0.1), ("damping_ratio", 0.5)],
            &[("stiffness", 5e4), ("friction", 0.5), ("damping", 5.0)],
            &[("stiffness", 5e4), ("friction", f64::INFINITY), ("damping", 2.0)],
            &[("stiffness", 285.0), ("damping_rate", 1310.0), ("friction", 0.5)],
            &[("stiffness", 5e4), ("damping_ratio", 0.5), ("friction", 0.5)],
            &[("effective_shear_modulus", 1e7), ("friction", 0.5), ("damping_ratio", 0.5)],
            &[("effective_shear_modulus", 1e7), ("friction", f64::INFINITY)],
            &[("effective_shear_modulus", 1e7), ("damping_coefficient", 0.06), ("friction", f64::INFINITY)],
            &[("stiffness_pressure", 9e7), ("damping_rate_per_length", 1e6), ("friction", 0.5)],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        Ok(stage::compile(&Model::new(params, pair)?, &pair.conventions))
    }

    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        Ok(prediction::time_scale(&Model::new(params, pair)?, pair, impact))
    }

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        match Model::new(params, pair) {
            Ok(model) => {
                // The other rules differ where a damper meets the limit.
                let known = pair.conventions.coulomb_test == CoulombTest::SpringThenTotal
                    || model.damping == Damping::Zero
                    || model.friction == f64::INFINITY;
                Oracle::Tangential(Box::new(move |impact| {
                    known.then(|| prediction::after(&model, impact))?
                }))
            }
            Err(_) => Oracle::Missing,
        }
    }

    fn reads(params: &Params) -> Columns {
        Columns::TANGENTIAL_VELOCITY
            .and(Columns::NORMAL_FORCE)
            .and(Columns::NORMAL_VELOCITY)
            .and(extra_reads(params))
    }

    fn dissipative(params: &Params) -> bool {
        constant_stiffness(params)
    }
}

register_law!(TangentialSpring);

impl Model {
    /// Stiffness and damping at a contact; the normal stiffness and damping are those of the normal law.
    pub(crate) fn at(&self, contact: &Contact) -> (f64, f64) {
        let contact_radius = (contact.reduced_radius * contact.overlap).sqrt();
        let mass = contact.reduced_mass;
        let stiffness = match self.stiffness {
            Stiffness::Fixed(value) => value,
            Stiffness::Mass(factor) => factor * mass,
            Stiffness::Normal(ratio) => ratio * contact.normal_stiffness,
            Stiffness::ContactRadius(factor) => factor * contact_radius,
        };
        let damping = match self.damping {
            Damping::Zero => 0.0,
            Damping::Fixed(value) => value,
            Damping::Mass(rate) => rate * mass,
            Damping::Normal(ratio) => ratio * contact.normal_damping,
            Damping::MassContactRadius(rate) => rate * mass * contact_radius,
            Damping::Critical(factor) => factor * (stiffness * mass).sqrt(),
        };
        (stiffness, damping)
    }
}

/// What stiffness and damping of a contact may depend on.
pub(crate) struct Contact {
    pub overlap: f64,
    pub reduced_mass: f64,
    pub reduced_radius: f64,
    pub normal_stiffness: f64,
    pub normal_damping: f64,
}
