//! Restitution that falls with the speed of approach.

use granule_law_api::{
    Bound, Collision, CollisionImpulse, CollisionLaw, CollisionRule, Columns, Dimension, Form, LawError,
    LawInfo, ParamSpec, Params, Slot, Source, ValueRange, register_collision_law,
};

use crate::impulse::{FRICTION, Surface, TANGENTIAL_RESTITUTION};

const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_0",
    doc: "Normal restitution at the transition speed.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};

const TRANSITION_SPEED: ParamSpec = ParamSpec {
    name: "transition_speed",
    symbol: "v_0",
    doc: "Speed of approach between the viscoelastic and the plastic branch; 0.3 m/s for steel.",
    dimension: Dimension::VELOCITY,
    range: ValueRange::POSITIVE,
};

const VISCOUS_EXPONENT: ParamSpec = ParamSpec {
    name: "viscous_exponent",
    symbol: "a",
    doc: "Growth of the loss 1 - e_n below the transition speed: 1/5 for viscoelastic spheres, 3/4 as fitted by Bizon.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};

const PLASTIC_EXPONENT: ParamSpec = ParamSpec {
    name: "plastic_exponent",
    symbol: "b",
    doc: "Fall of e_n above the transition speed: 1/4 for plastic deformation, 0 for a constant.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(0.0), high: Bound::Open, infinite: false },
};

/// Normal restitution with a viscoelastic branch at low and a plastic one at high speed (McNamara and Falcon 2005); with
/// the exponents 3/4 and 0 the form of Bizon et al. 1998. Slow collisions are elastic. Tangential as
/// [`HardSphere`](crate::HardSphere).
pub struct SpeedDependentHardSphere;

impl CollisionLaw for SpeedDependentHardSphere {
    const INFO: LawInfo = LawInfo {
        name: "SpeedDependentHardSphere",
        summary: "Instantaneous collision whose normal restitution falls with the speed of approach.",
        formula: "e_n = 1 - (1 - e_0)(v_n/v_0)^a for v_n < v_0, e_0 (v_n/v_0)^-b above;\n\
                  J_n = (1 + e_n) m12 v_n; J_t = -min(mu J_n, (1 + e_t0) m_t |v_t|) v_t/|v_t|",
        sources: &[
            Source {
                work: "McNamara and Falcon 2005",
                place: "Sec. II",
                note: "exponents 1/5 and 1/4, which are the defaults here",
            },
            Source {
                work: "Bizon et al. 1998",
                place: "velocity-dependent restitution",
                note: "exponents 3/4 and 0",
            },
            Source {
                work: "Luding 1998",
                place: "Eqs. (16)-(21), (42)-(44)",
                note: "errata L-E10 and L-E18",
            },
        ],
        slot: Slot::Collision,
        reads: Columns::NORMAL_VELOCITY.and(Columns::TANGENTIAL_VELOCITY).and(Columns::REDUCED_MASS),
        writes: Columns::NONE,
        history: &[],
        parameters: &[
            &RESTITUTION,
            &TRANSITION_SPEED,
            &VISCOUS_EXPONENT,
            &PLASTIC_EXPONENT,
            &FRICTION,
            &TANGENTIAL_RESTITUTION,
        ],
        forms: &[
            Form {
                doc: "Smooth spheres: spins do not exist.",
                required: &[&RESTITUTION, &TRANSITION_SPEED],
                optional: &[(&VISCOUS_EXPONENT, 0.2), (&PLASTIC_EXPONENT, 0.25)],
            },
            Form {
                doc: "Rough spheres; by default a sticking contact stops.",
                required: &[&RESTITUTION, &TRANSITION_SPEED, &FRICTION],
                optional: &[
                    (&VISCOUS_EXPONENT, 0.2),
                    (&PLASTIC_EXPONENT, 0.25),
                    (&TANGENTIAL_RESTITUTION, 0.0),
                ],
            },
        ],
        examples: &[
            &[("restitution", 0.95), ("transition_speed", 0.3)],
            &[
                ("restitution", 0.7),
                ("transition_speed", 0.5),
                ("viscous_exponent", 0.75),
                ("plastic_exponent", 0.0),
                ("friction", 0.3),
            ],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile(params: &Params) -> Result<Box<dyn CollisionRule>, LawError> {
        Ok(Box::new(Branches {
            restitution: params.value(&RESTITUTION)?,
            transition: params.value(&TRANSITION_SPEED)?,
            viscous: params.value(&VISCOUS_EXPONENT)?,
            plastic: params.value(&PLASTIC_EXPONENT)?,
            surface: Surface {
                friction: params.get(&FRICTION).unwrap_or(0.0),
                tangential_restitution: params.get(&TANGENTIAL_RESTITUTION).unwrap_or(-1.0),
            },
        }))
    }
}

register_collision_law!(SpeedDependentHardSphere);

#[derive(Clone, Copy, Debug)]
struct Branches {
    restitution: f64,
    transition: f64,
    viscous: f64,
    plastic: f64,
    surface: Surface,
}

impl CollisionRule for Branches {
    fn impulse(&self, collision: &Collision) -> CollisionImpulse {
        let e_n = if collision.elastic { 1.0 } else { self.restitution(collision.normal_speed) };
        self.surface.impulse(e_n, collision)
    }

    fn restitution(&self, normal_speed: f64) -> f64 {
        let ratio = normal_speed / self.transition;
        if ratio < 1.0 {
            1.0 - (1.0 - self.restitution) * ratio.powf(self.viscous)
        } else {
            self.restitution * ratio.powf(-self.plastic)
        }
    }

    fn is_rough(&self) -> bool {
        self.surface.is_rough()
    }

    fn is_inelastic(&self) -> bool {
        self.restitution < 1.0 || self.plastic > 0.0
    }
}
