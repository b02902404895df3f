//! What is watched during a run: overlaps, and how far bodies move in one step.

use granule_plan::{Guard, Plan};
use nalgebra::Vector3;

use crate::engine::Engine;
use crate::error::EngineError;
use crate::tally::ContactPartner;

/// Steps between two looks at the overlaps: more often than a contact lasts.
pub(crate) const LOOK: u64 = 16;

/// What has passed its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlarmKind {
    /// Overlap over the radius of the smaller body.
    Overlap,
    /// Distance moved in one step over the smallest radius.
    Travel,
    /// Distance of a centre from the cell over its radius.
    Lost,
    /// Residual of the energy ledger over the energy turned over.
    Energy,
}

/// A limit that was passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// What.
    pub kind: AlarmKind,
    /// Identity of the body; `None` where it is of no single one.
    pub id: Option<u32>,
    /// What it is in contact with, if that matters.
    pub partner: Option<ContactPartner>,
    /// How large it is.
    pub value: f64,
    /// How large it may be.
    pub limit: f64,
    /// Step.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
}

impl std::fmt::Display for Alarm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { value, limit, step, time, .. } = self;
        let body = self.id.map_or_else(|| "a body".to_string(), |id| format!("body {id}"));
        match (self.kind, self.partner) {
            (AlarmKind::Overlap, Some(ContactPartner::Body(other))) => {
                write!(f, "body {other} and {body} overlap by {value:.3} of the smaller radius")
            }
            (AlarmKind::Overlap, Some(ContactPartner::Wall(wall))) => {
                write!(f, "{body} overlaps wall {wall} by {value:.3} of its radius")
            }
            (AlarmKind::Overlap, None) => {
                write!(f, "{body} overlaps another by {value:.3} of the smaller radius")
            }
            (AlarmKind::Travel, _) => write!(f, "{body} moves {value:.3} of the smallest radius in one step"),
            (AlarmKind::Lost, _) => write!(f, "the centre of {body} is {value:.3} radii outside of the cell"),
            (AlarmKind::Energy, _) => {
                write!(f, "the energy ledger misses {value:.3} of the energy that was turned over")
            }
        }?;
        write!(f, ", more than {limit}, at step {step} (time {time:e} s)")
    }
}

/// Limits of a run; those of which was told once are infinite.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    overlap: f64,
    /// \[m\].
    travel: f64,
    smallest: f64,
    pub told: Vec<Alarm>,
}

impl Watch {
    pub fn new(plan: &Plan) -> Self {
        let smallest = plan.bodies.radius.iter().copied().fold(f64::INFINITY, f64::min);
        let travel = plan.guards.travel.limit();
        Self {
            overlap: plan.guards.overlap.limit(),
            travel: if travel.is_finite() { travel * smallest } else { f64::INFINITY },
            smallest,
            told: Vec::new(),
        }
    }

    /// True if overlaps are looked for in the step that ends as number `step`.
    pub fn looks(&self, step: u64) -> bool {
        self.overlap < f64::INFINITY && step.is_multiple_of(LOOK)
    }
}

impl Engine {
    /// Compares the largest overlap of the evaluation with its limit.
    pub(crate) fn watch_overlap(&mut self) -> Result<(), EngineError> {
        if self.tally().relative_overlap <= self.watch.overlap {
            return Ok(());
        }
        let radius_of = |id: u32| {
            let table = &self.plan().bodies;
            table.id.binary_search(&id).map_or(f64::INFINITY, |index| table.radius[index])
        };
        let worst = self
            .contacts()
            .into_iter()
            .map(|contact| {
                let radius = match contact.partner {
                    ContactPartner::Body(other) => radius_of(contact.id).min(radius_of(other)),
                    ContactPartner::Wall(_) => radius_of(contact.id),
                };
                (contact.overlap / radius, contact)
            })
            .max_by(|(a, _), (b, _)| a.total_cmp(b));
        let alarm = Alarm {
            kind: AlarmKind::Overlap,
            id: worst.as_ref().map(|(_, contact)| contact.id),
            partner: worst.as_ref().map(|(_, contact)| contact.partner),
            value: self.tally().relative_overlap,
            limit: self.watch.overlap,
            step: self.step() + 1,
            time: (self.step() + 1) as f64 * self.plan().driver.step,
        };
        self.watch.overlap = f64::INFINITY;
        self.raise(self.plan().guards.overlap, alarm)
    }

    /// Compares the longest way of a pass with its limit.
    pub(crate) fn watch_travel(&mut self, travelled: f64) -> Result<(), EngineError> {
        if travelled <= self.watch.travel {
            return Ok(());
        }
        let speed = |place: &usize| Vector3::from(self.bodies().velocity_of(*place)).norm_squared();
        let fastest = (0..self.bodies().len()).max_by(|a, b| speed(a).total_cmp(&speed(b)));
        let alarm = Alarm {
            kind: AlarmKind::Travel,
            id: fastest.map(|place| self.bodies().id[place]),
            partner: None,
            value: travelled / self.watch.smallest,
            limit: self.watch.travel / self.watch.smallest,
            step: self.step(),
            time: self.time(),
        };
        self.watch.travel = f64::INFINITY;
        self.raise(self.plan().guards.travel, alarm)
    }

    fn raise(&mut self, guard: Guard, alarm: Alarm) -> Result<(), EngineError> {
        if guard.stops() {
            return Err(EngineError::Guard(alarm));
        }
        self.watch.told.push(alarm);
        Ok(())
    }

    /// Limits that were passed since the last call and end no run.
    pub fn alarms(&mut self) -> Vec<Alarm> {
        std::mem::take(&mut self.watch.told)
    }
}
