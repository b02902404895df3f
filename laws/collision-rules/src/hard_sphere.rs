//! Constant restitution.

use granule_law_api::{
    Collision, CollisionImpulse, CollisionLaw, CollisionRule, Columns, Dimension, Form, LawError, LawInfo,
    ParamSpec, Params, Slot, Source, ValueRange, register_collision_law,
};

use crate::impulse::{FRICTION, Surface, TANGENTIAL_RESTITUTION};

const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Normal restitution: normal speed after the collision over that before it.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::UNIT,
};

/// The three-parameter collision rule (Luding 1998, Eqs. (16)-(21)).
///
/// Contacts stick with tangential restitution e_t0 while the impulse that this takes is below μ times the normal impulse,
/// and slide beyond: e_t = min(e_t0, e_t1). Two bodies of the same inertia factor q change over at
/// Ψ1 = tan of the impact angle = μ (1 + e_n)(1 + 1/q)/(1 + e_t0). Energy changes by
/// -(1 - e_n²) m12 v_n²/2 - (1 - e_t²) m_t v_t²/2, never upwards for the allowed parameters.
pub struct HardSphere;

impl CollisionLaw for HardSphere {
    const INFO: LawInfo = LawInfo {
        name: "HardSphere",
        summary: "Instantaneous collision with constant normal restitution, friction and tangential restitution.",
        formula: "J_n = (1 + e_n) m12 v_n; J_t = -min(mu J_n, (1 + e_t0) m_t |v_t|) v_t/|v_t|,\n\
                  1/m_t = (1 + 1/q1)/m1 + (1 + 1/q2)/m2",
        sources: &[
            Source {
                work: "Luding 1998",
                place: "Eqs. (16)-(21)",
                note: "errata L-E10 and L-E18: magnitudes in the Coulomb bound, general masses and inertia factors",
            },
            Source { work: "Walton 1993", place: "three-parameter model", note: "" },
        ],
        slot: Slot::Collision,
        reads: Columns::NORMAL_VELOCITY.and(Columns::TANGENTIAL_VELOCITY).and(Columns::REDUCED_MASS),
        writes: Columns::NONE,
        history: &[],
        parameters: &[&RESTITUTION, &FRICTION, &TANGENTIAL_RESTITUTION],
        forms: &[
            Form { doc: "Smooth spheres: spins do not exist.", required: &[&RESTITUTION], optional: &[] },
            Form {
                doc: "Rough spheres; by default a sticking contact stops.",
                required: &[&RESTITUTION, &FRICTION],
                optional: &[(&TANGENTIAL_RESTITUTION, 0.0)],
            },
        ],
        examples: &[
            &[("restitution", 0.9)],
            &[("restitution", 0.9), ("friction", 0.3), ("tangential_restitution", 0.5)],
            &[("restitution", 1.0), ("friction", f64::INFINITY), ("tangential_restitution", 1.0)],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile(params: &Params) -> Result<Box<dyn CollisionRule>, LawError> {
        Ok(Box::new(Constant {
            restitution: params.value(&RESTITUTION)?,
            surface: Surface {
                friction: params.get(&FRICTION).unwrap_or(0.0),
                tangential_restitution: params.get(&TANGENTIAL_RESTITUTION).unwrap_or(-1.0),
            },
        }))
    }
}

register_collision_law!(HardSphere);

#[derive(Clone, Copy, Debug)]
struct Constant {
    restitution: f64,
    surface: Surface,
}

impl CollisionRule for Constant {
    #[inline]
    fn impulse(&self, collision: &Collision) -> CollisionImpulse {
        let e_n = if collision.elastic { 1.0 } else { self.restitution };
        self.surface.impulse(e_n, collision)
    }

    fn restitution(&self, _normal_speed: f64) -> f64 {
        self.restitution
    }

    fn is_rough(&self) -> bool {
        self.surface.is_rough()
    }

    fn is_inelastic(&self) -> bool {
        self.restitution < 1.0
    }
}
