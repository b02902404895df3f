//! Rolling without slip while |f| <= μ_s N; else slip with f = -μ_k N u/|u|; rolling friction that stops and never
//! reverses.

use granule_law_api::{
    Dimension, Footing, Form, LawError, ParamSpec, Params, Source, SubstrateContact, SubstrateContext,
    SubstrateInfo, SubstrateLaw, SubstrateStage, SurfaceFriction, ValueRange, register_substrate_law,
};

const COEFFICIENT: ValueRange = ValueRange { infinite: true, ..ValueRange::NON_NEGATIVE };

const STATIC: ParamSpec = ParamSpec {
    name: "static_friction",
    symbol: "mu_s",
    doc: "A rolling body starts to slip where the friction that keeps it rolling exceeds mu_s times the normal force; inf \
          for no slip at all.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};
const KINETIC: ParamSpec = ParamSpec {
    name: "kinetic_friction",
    symbol: "mu_k",
    doc: "Friction on a slipping body per normal force, against the slip; at most mu_s.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};
const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "mu",
    doc: "Static and kinetic friction coefficient where both are the same.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};
const ROLLING: ParamSpec = ParamSpec {
    name: "rolling_friction",
    symbol: "mu_r",
    doc: "Deceleration of a body that rolls without slip, per normal force and inverse mass; about 1e-3 for steel on copper.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
const DRILLING: ParamSpec = ParamSpec {
    name: "drilling_friction",
    symbol: "mu_d",
    doc: "Torque against the spin about the normal of the surface, per normal force and radius.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
const RESISTANCES: &[(&ParamSpec, f64)] = &[(&ROLLING, 0.0), (&DRILLING, 0.0)];

/// Static and kinetic friction of a surface with rolling and drilling friction (Kondic 1999, Eqs. (11)-(28)).
///
/// Forces are averages over the step, so the switch from slip to rolling is exact in the impulse where the slip passes zero
/// inside a step, and neither slip nor rolling ever changes its sign because of friction.
pub struct StickSlip;

impl SubstrateLaw for StickSlip {
    const INFO: SubstrateInfo = SubstrateInfo {
        name: "StickSlip",
        summary: "Rolling without slip up to a limit of static friction, slip under kinetic friction, rolling and drilling \
                  friction.",
        formula: "rolling: f = -[F + (k x T)/R - m a_S/Q] Q/(1 + Q) of all other forces F and torques T, while |f| <= mu_s N\n\
                  slipping: f = -mu_k N u/|u|, until u = 0\n\
                  rolling friction: a = -mu_r N/m w/|w| with the rolling velocity w = v - v_S, until w = 0\n\
                  drilling friction: T_z = -mu_d N R sign(spin_z), until spin_z = 0",
        sources: &[
            Source {
                work: "Kondic 1999",
                place: "Eqs. (11)-(19)",
                note: "Eq. (15) with 1 + mR^2/I (erratum K-E16); rolling friction takes speed and spin together and stops \
                       at rest (erratum K-E39)",
            },
            Source {
                work: "Kondic 1999",
                place: "Eqs. (20)-(28)",
                note: "5/7 acts on the weight, too, in Eq. (24) (erratum K-E17); the limit in Eq. (25) is mu_s times the \
                       force of the surface, not of the collision (erratum K-E18)",
            },
        ],
        parameters: &[&STATIC, &KINETIC, &FRICTION, &ROLLING, &DRILLING],
        forms: &[
            Form {
                doc: "Different static and kinetic friction.",
                required: &[&STATIC, &KINETIC],
                optional: RESISTANCES,
            },
            Form {
                doc: "The same coefficient for static and kinetic friction.",
                required: &[&FRICTION],
                optional: RESISTANCES,
            },
        ],
        examples: &[
            &[("static_friction", 0.5), ("kinetic_friction", 0.1), ("rolling_friction", 1e-3)],
            &[("friction", 0.3), ("drilling_friction", 1e-3)],
            &[("friction", f64::INFINITY)],
        ],
    };

    fn compile(params: &Params, context: &SubstrateContext<'_>) -> Result<Box<dyn SubstrateStage>, LawError> {
        let (static_friction, kinetic_friction) = if params.form() == 0 {
            (params.value(&STATIC)?, params.value(&KINETIC)?)
        } else {
            (params.value(&FRICTION)?, params.value(&FRICTION)?)
        };
        if kinetic_friction > static_friction {
            return Err(LawError::new(format!(
                "of {kinetic_friction} is larger than the static friction of {static_friction}"
            ))
            .at(KINETIC.name)
            .help("kinetic friction is at most static friction"));
        }
        let constant = params.value(&ROLLING)?;
        let table = context.rolling_friction;
        if !table.is_empty() && constant != 0.0 {
            return Err(LawError::new("is given, and a table of rolling friction, too").at(ROLLING.name));
        }
        let bad = |(speed, friction): &(f64, f64)| {
            !(speed.is_finite() && friction.is_finite() && *speed >= 0.0 && *friction >= 0.0)
        };
        if table.iter().any(bad) || table.windows(2).any(|pair| pair[1].0 <= pair[0].0) {
            return Err(LawError::new(
                "a table of rolling friction needs increasing speeds of at least 0 and coefficients of at least 0",
            ));
        }
        let rolling = if table.is_empty() { vec![(0.0, constant)] } else { table.to_vec() };
        let drilling = params.value(&DRILLING)?;
        Ok(Box::new(Compiled(SurfaceFriction { static_friction, kinetic_friction, rolling, drilling })))
    }
}

register_substrate_law!(StickSlip);

struct Compiled(SurfaceFriction);

/// Slips below this share of the velocities that make it are rounding.
const ROUNDING: f64 = 1e-9;

impl SubstrateStage for Compiled {
    fn run(&self, contacts: &mut [SubstrateContact]) {
        for contact in contacts {
            self.answer(contact);
        }
    }

    fn friction(&self) -> Option<&SurfaceFriction> {
        Some(&self.0)
    }
}

impl Compiled {
    fn answer(&self, c: &mut SubstrateContact) {
        let normal = c.normal_impulse.max(0.0);
        // Not 0 · inf: without a normal force there is no friction, however rough the surface.
        let limit = |friction: f64| if normal > 0.0 { friction * normal } else { 0.0 };
        let inertia = limit(self.0.drilling * c.radius);
        let moment = c.mass * c.radius * c.radius / c.inertia_number;
        c.drilling_impulse = -c.drilling.signum() * inertia.min(c.drilling.abs() * moment);
        let sticks = match c.footing {
            Footing::Rolling | Footing::Resting => true,
            Footing::Sliding | Footing::Airborne => false,
            Footing::Unknown => {
                let spin = [c.slip_before[0] - c.rolling_before[0], c.slip_before[1] - c.rolling_before[1]];
                norm(c.slip_before) <= ROUNDING * (norm(c.rolling_before) + norm(spin))
            }
        };
        // What slips by u is stopped by -u m/(1 + Q).
        let mobility = (1.0 + c.inertia_number) / c.mass;
        let stop = [-c.slip[0] / mobility, -c.slip[1] / mobility];
        let most = limit(if sticks { self.0.static_friction } else { self.0.kinetic_friction });
        if norm(stop) <= most && (normal > 0.0 || norm(c.slip) == 0.0) {
            let rolling = [c.rolling[0] + stop[0] / c.mass, c.rolling[1] + stop[1] / c.mass];
            let middle = 0.5 * (norm(c.rolling_before) + norm(rolling));
            // The speed in the middle of the step with the friction itself, so that a table is followed to second order.
            let first = limit(self.0.rolling_at(middle)) / c.mass;
            let friction = self.0.rolling_at((middle - 0.5 * first).max(0.0));
            // Rolling friction acts through the contact, too: no more of it than the surface can hold.
            let most_change = limit(friction).min(most - norm(stop)) / c.mass;
            let change = resist(c.rolling_before, rolling, most_change);
            // The couple keeps s = -w while w changes.
            let share = -c.mass * (1.0 + 1.0 / c.inertia_number);
            c.impulse = [stop[0] + c.mass * change[0], stop[1] + c.mass * change[1]];
            c.couple = [share * change[0], share * change[1]];
            let rests = change[0] == -rolling[0] && change[1] == -rolling[1];
            c.footing = if rests { Footing::Resting } else { Footing::Rolling };
            return;
        }
        let change = resist(c.slip_before, c.slip, limit(self.0.kinetic_friction) * mobility);
        c.impulse = [change[0] / mobility, change[1] / mobility];
        c.couple = [0.0; 2];
        c.footing = Footing::Sliding;
    }
}

fn norm(v: [f64; 2]) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

/// Change of a velocity by a friction that can change it by `most`: against its mean direction over the step, and to zero
/// where that is within reach.
fn resist(before: [f64; 2], free: [f64; 2], most: f64) -> [f64; 2] {
    let speed = norm(free);
    if speed <= most {
        return [-free[0], -free[1]];
    }
    let along = [free[0] / speed, free[1] / speed];
    let middle = [before[0] + free[0] - most * along[0], before[1] + free[1] - most * along[1]];
    let size = norm(middle);
    let forward = middle[0] * along[0] + middle[1] * along[1] > 0.0;
    let direction = if forward { [middle[0] / size, middle[1] / size] } else { along };
    [-most * direction[0], -most * direction[1]]
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
