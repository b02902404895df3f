//! What the law says about itself.

use granule_law_api::{
    Columns, ContactEnd, ContactLaw, Dimension, DurationRule, HistoryColumn, Impact, LawError, LawInfo,
    NormalSummary, Oracle, PairContext, Params, Parity, Real, Slot, Source, Stage, TimeScale, register_law,
};

use crate::model::{FORMS, Model, PARAMETERS};
use crate::{impact, stage};

/// Linear loading with the stiffness k_1 and steeper un- and reloading with k_2 down to zero force, without a dashpot
/// (Walton and Braun 1986; Luding 1998, Eqs. (45)-(47) and Fig. 6): f_n = max(0, min(k_1 δ, k_2 (δ - δ_0))).
///
/// The contact remembers one length, the largest overlap δ_max; δ_0 = (1 - k_1/k_2) δ_max is the plastic overlap at which
/// the force vanishes. While a contact without force opens further, δ_max follows such that δ_0 = δ (erratum L-E25, which
/// Eq. (45) leaves implicit), so that a new approach is felt at once. The memory goes when the overlap vanishes. The force
/// never attracts; the two ends of contact name the same motion at different moments: `Force` when the force vanishes at
/// δ_0, `Overlap` when the bodies separate, the time δ_0/(e_n v_0) later.
///
/// With `plasticity_depth` k_2 grows with δ_max from k_1 to its largest value, reached at
/// δ_lim = k_2/(k_2 - k_1) φ 2 R*; beyond it the contact is elastic on that line (Luding 2008, Sec. 2.3, without adhesion;
/// LIGGGHTS `hooke/hysteresis`). The restitution then falls with the speed of impact.
///
/// Later stages see k_1 as the normal stiffness, whatever the branch, so that a tangential spring given as a share of it
/// keeps its stiffness.
///
/// The plastic power is that of the moment. Where a reloaded contact passes its old δ_max within a step, the ledger is off by
/// up to half a step of that power.
pub struct WaltonBraun;

impl ContactLaw for WaltonBraun {
    const INFO: LawInfo = LawInfo {
        name: "WaltonBraun",
        summary: "Hysteretic spring: loads softly, unloads steeply; loses energy by plastic deformation, not by speed.",
        formula: "f_n = max(0, min(k_1 delta, k_2 (delta - delta_0))), delta_0 = (1 - k_1/k_2) delta_max; \
                  delta_max: largest overlap so far, falling with delta while f_n = 0",
        sources: &[
            Source { work: "Walton and Braun 1986", place: "J. Rheol. 30, 949", note: "constant k_1, k_2" },
            Source {
                work: "Luding 1998",
                place: "Eqs. (45)-(47), Fig. 6",
                note: "errata L-E1, L-E2: k_1 = m12 pi^2 (1 + e_n)^2/(4 t_c^2), k_2 = k_1/e_n^2; L-E25: memory on reloading",
            },
            Source {
                work: "Luding 2008",
                place: "Granular Matter 10, 235, Sec. 2.3",
                note: "k_2 that grows with delta_max, without adhesion",
            },
        ],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY.and(Columns::REDUCED_MASS).and(Columns::REDUCED_RADIUS),
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[HistoryColumn {
            name: "largest_overlap",
            components: 1,
            parity: Parity::Even,
            dimension: Dimension::LENGTH,
        }],
        parameters: PARAMETERS,
        forms: FORMS,
        examples: &[
            &[("restitution", 0.6), ("contact_duration", 1e-4)],
            &[("restitution", 0.2), ("contact_duration", 1e-4)],
            &[("loading_stiffness", 1e5), ("restitution", 0.9)],
            &[("loading_stiffness", 1e5), ("restitution", 1.0)],
            &[("loading_stiffness", 1e5), ("unloading_stiffness", 2e5)],
            &[("loading_stiffness", 1e5), ("largest_unloading_stiffness", 5e5), ("plasticity_depth", 0.02)],
            &[("loading_stiffness", 1e5), ("largest_unloading_stiffness", 5e5), ("plasticity_depth", 0.002)],
        ],
        contact_ends: &[ContactEnd::Force, ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let model = Model::new(params, pair)?;
        let branches = model.at(pair.reduced_mass.max, pair.reduced_radius.max);
        LawError::unless_finite::<T>(&[
            ("loading stiffness", branches.loading),
            ("unloading stiffness", branches.largest),
            ("overlap of the largest stiffness", branches.limit),
        ])?;
        Ok(stage::compile(&model))
    }

    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let model = Model::new(params, pair)?;
        let outcome = impact::outcome(&model, impact, pair.contact_end);
        let overlap = outcome.maximum_overlap;
        let stiffness = model.at(impact.reduced_mass, impact.reduced_radius).unloading(overlap);
        Ok(Some(TimeScale { duration: outcome.duration, stiffness, damping: 0.0, overlap }))
    }

    fn summary(params: &Params, pair: &PairContext) -> Option<NormalSummary> {
        let impact = Impact {
            reduced_mass: pair.reduced_mass.min,
            reduced_radius: pair.reduced_radius.min,
            normal_speed: pair.impact_speed,
        };
        let scale = Self::time_scale(params, pair, &impact).ok().flatten();
        let model = Model::new(params, pair).ok()?;
        // From the plastic overlap on the bodies no longer press on each other, whichever end of contact was chosen.
        let duration = model.duration_factor(ContactEnd::Force).map_or(DurationRule::Unknown, |factor| {
            // What later stages see as normal stiffness is k_1.
            DurationRule::Oscillator(factor)
        });
        Some(NormalSummary { duration, scale })
    }

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        let Ok(model) = Model::new(params, pair) else {
            return Oracle::Missing;
        };
        let end = pair.contact_end;
        Oracle::Normal(Box::new(move |impact| impact::outcome(&model, impact, end)))
    }

    fn reads(params: &Params) -> Columns {
        Columns::NORMAL_VELOCITY.and(Model::extra_reads(params))
    }
}

register_law!(WaltonBraun);
