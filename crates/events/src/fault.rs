//! Collision rules at fault: which one panicked or gave a number that is not finite, and in which collision.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

use granule_law_api::{Collision, CollisionImpulse, CollisionRule};

use crate::engine::Rule;
use crate::setup::EventError;

/// What was wrong with a rule.
#[derive(Clone, Debug, PartialEq)]
pub enum RuleFault {
    /// It panicked, with these words.
    Panicked(String),
    /// It made an impulse that is not finite of numbers that are.
    NotFinite,
}

/// What unwinds from a rule at fault.
struct Fault {
    rule: usize,
    what: RuleFault,
    seen: Collision,
}

/// A rule that is looked after.
#[derive(Debug)]
struct Watched {
    rule: Arc<dyn CollisionRule>,
    index: usize,
}

impl CollisionRule for Watched {
    fn impulse(&self, seen: &Collision) -> CollisionImpulse {
        let fault = |what| -> ! { resume_unwind(Box::new(Fault { rule: self.index, what, seen: *seen })) };
        // Nothing of a rule is used after it has panicked.
        match catch_unwind(AssertUnwindSafe(|| self.rule.impulse(seen))) {
            Ok(impulse) if is_finite(&impulse) || !is_sensible(seen) => impulse,
            Ok(_) => fault(RuleFault::NotFinite),
            Err(payload) => {
                let text = payload.downcast_ref::<&str>().map(|text| text.to_string());
                let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
                fault(RuleFault::Panicked(text.unwrap_or_else(|| "no message".to_string())))
            }
        }
    }

    fn restitution(&self, normal_speed: f64) -> f64 {
        self.rule.restitution(normal_speed)
    }

    fn is_rough(&self) -> bool {
        self.rule.is_rough()
    }

    fn is_inelastic(&self) -> bool {
        self.rule.is_inelastic()
    }
}

fn is_finite(impulse: &CollisionImpulse) -> bool {
    let [x, y, z] = impulse.tangential;
    (impulse.normal + x + y + z).is_finite()
}

/// What the rule was given are numbers.
fn is_sensible(seen: &Collision) -> bool {
    let [x, y, z] = seen.tangential_velocity;
    (seen.normal_speed + seen.reduced_mass + seen.tangential_mass + x + y + z).is_finite()
}

/// Rules, looked after.
pub(crate) fn watched(rules: &[Arc<dyn CollisionRule>]) -> Vec<Rule> {
    let watch = |(index, rule): (usize, &Arc<dyn CollisionRule>)| {
        let rough = rule.is_rough();
        Rule { rule: Arc::new(Watched { rule: Arc::clone(rule), index }), rough }
    };
    rules.iter().enumerate().map(watch).collect()
}

/// Does a collision. A rule at fault is an error about the two that meet: the identity of a body, and that of another or a wall.
/// Every other panic goes on.
#[inline]
pub(crate) fn caught<E>(
    engine: &mut E,
    collide: impl FnOnce(&mut E) -> Result<(), EventError>,
    about: impl FnOnce(&E) -> (u32, Result<u32, usize>, f64),
) -> Result<(), EventError> {
    match catch_unwind(AssertUnwindSafe(|| collide(engine))) {
        Ok(done) => done,
        Err(payload) => {
            let Fault { rule, what, seen } =
                *payload.downcast::<Fault>().unwrap_or_else(|other| resume_unwind(other));
            let (id, other, time) = about(engine);
            Err(EventError::Rule { rule, fault: what, seen, id, other, time })
        }
    }
}
