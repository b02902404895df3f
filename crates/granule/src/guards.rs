//! What is watched during a run from outside of the engine, and what can be said about a failure.

use std::fmt::Write as _;

use granule_drivers::{Alarm, AlarmKind, ContactPartner, EngineError, View};
use granule_observers::Energy;
use granule_plan::{Guard, Guards, Plan};

use crate::drift::EnergyDrift;

/// Steps between two looks.
const LOOK: u64 = 1024;

/// Guards of lost bodies and of the energy. What was told once is not told again.
pub(crate) struct Lookout {
    guards: Guards,
}

impl Lookout {
    /// For a run of a plan.
    pub fn new(plan: &Plan) -> Self {
        Self { guards: plan.guards }
    }

    /// The next step after `step` at which there is something to look at.
    pub fn next_due(&self, step: u64) -> u64 {
        (step / LOOK + 1).saturating_mul(LOOK)
    }

    /// Looks, if it is time to. What passes its limit for the first time is returned if the run goes on.
    ///
    /// # Errors
    /// [`EngineError::Guard`]: the run must end.
    pub fn look(&mut self, view: &View<'_>, start: Option<&Energy>) -> Result<Vec<Alarm>, EngineError> {
        let mut told = Vec::new();
        if !view.step().is_multiple_of(LOOK) {
            return Ok(told);
        }
        let lost = lost(view, self.guards.lost.limit());
        raise(&mut self.guards.lost, lost, &mut told)?;
        if let Some(start) = start.filter(|_| self.guards.energy != Guard::Off) {
            let value = EnergyDrift::between(start, &Energy::of(view)).relative().abs();
            let alarm = alarm(AlarmKind::Energy, None, value, self.guards.energy.limit(), view);
            raise(&mut self.guards.energy, (value > alarm.limit).then_some(alarm), &mut told)?;
        }
        Ok(told)
    }
}

fn raise(guard: &mut Guard, alarm: Option<Alarm>, told: &mut Vec<Alarm>) -> Result<(), EngineError> {
    let Some(alarm) = alarm else { return Ok(()) };
    if guard.stops() {
        return Err(EngineError::Guard(alarm));
    }
    *guard = Guard::Off;
    told.push(alarm);
    Ok(())
}

fn alarm(kind: AlarmKind, id: Option<u32>, value: f64, limit: f64, view: &View<'_>) -> Alarm {
    Alarm { kind, id, partner: None, value, limit, step: view.step(), time: view.time() }
}

/// The body that is farthest outside of the cell, in its radii, if that is more than `limit`.
fn lost(view: &View<'_>, limit: f64) -> Option<Alarm> {
    let cell = &view.plan().cell;
    let (lo, hi, periodic) = (cell.lo(), cell.hi(), cell.periodic());
    let bounded = |axis: &usize| !periodic[*axis] && (lo[*axis].is_finite() || hi[*axis].is_finite());
    let axes: Vec<usize> = (0..3).filter(bounded).collect();
    if axes.is_empty() || limit == f64::INFINITY {
        return None;
    }
    let bodies = view.bodies();
    let outside = |place: usize| {
        let row = bodies.position[place];
        let beyond = axes.iter().map(|axis| (lo[*axis] - row[*axis]).max(row[*axis] - hi[*axis]));
        beyond.fold(0.0, f64::max) / row[3]
    };
    let farthest = (0..bodies.len())
        .map(|place| (outside(place), bodies.id[place]))
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    farthest
        .filter(|(beyond, _)| *beyond > limit)
        .map(|(beyond, id)| alarm(AlarmKind::Lost, Some(id), beyond, limit, view))
}

/// The bodies that an error speaks of.
pub(crate) fn bodies_of(error: &EngineError) -> Vec<u32> {
    match error {
        EngineError::NotFinite { id, .. } | EngineError::Crushed { id, .. } => vec![*id],
        // A whole neighbourhood would tell nothing.
        EngineError::LawPanicked { among, .. } if among.len() <= 2 => among.clone(),
        EngineError::LawNotFinite { between, .. } => {
            let words: Vec<&str> = between.split_whitespace().collect();
            let named = words.windows(2).filter(|pair| pair[0] == "body");
            named.filter_map(|pair| pair[1].trim_end_matches(',').parse().ok()).collect()
        }
        EngineError::Guard(alarm) => {
            let other = match alarm.partner {
                Some(ContactPartner::Body(other)) => Some(other),
                _ => None,
            };
            alarm.id.into_iter().chain(other).collect()
        }
        _ => Vec::new(),
    }
}

/// Where the bodies of an error are, what they touch, what the cause probably is, and what can be done: further lines of its
/// message.
pub(crate) fn about(error: &EngineError, view: &View<'_>) -> String {
    let mut out = String::new();
    let contacts = view.contacts();
    for id in bodies_of(error) {
        let bodies = view.bodies();
        let rank = view.order().binary_search_by_key(&id, |&place| bodies.id[place as usize]);
        let Ok(rank) = rank else { continue };
        let place = view.order()[rank] as usize;
        let touched = contacts.iter().filter_map(|contact| {
            let partner = match contact.partner {
                ContactPartner::Body(other) if other == id => format!("body {}", contact.id),
                _ if contact.id != id => return None,
                ContactPartner::Body(other) => format!("body {other}"),
                ContactPartner::Wall(wall) => wall_name(view.plan(), wall),
            };
            Some(format!("{partner} (overlap {:.4e} m)", contact.overlap))
        });
        let touched: Vec<String> = touched.collect();
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "\n  body {id}: position {} m, velocity {} m/s, radius {:.4e} m; touches {}",
            vector(bodies.position[place].vector()),
            vector(bodies.velocity_of(place)),
            bodies.position[place][3],
            if touched.is_empty() { "nothing".to_string() } else { touched.join(", ") }
        );
    }
    let (cause, remedy) = cause(error);
    if !cause.is_empty() {
        let _ = write!(out, "\n  likely cause: {cause}\n  remedy: {remedy}");
    }
    out
}

/// Name of a wall as the scene has it.
fn wall_name(plan: &Plan, wall: u32) -> String {
    plan.walls
        .get(wall as usize)
        .map_or_else(|| format!("wall {wall}"), |wall| format!("wall `{}`", wall.name))
}

fn vector(v: [f64; 3]) -> String {
    format!("({:.6e}, {:.6e}, {:.6e})", v[0], v[1], v[2])
}

/// Likely cause and remedy.
fn cause(error: &EngineError) -> (&'static str, &'static str) {
    match error {
        EngineError::NotFinite { .. } | EngineError::LawNotFinite { .. } => (
            "the time step is too long for the stiffest contact, bodies that overlapped by much at the start, or a law that \
             divides by zero",
            "a shorter `step` (or `step: Auto()`), no overlaps at the start, `granule law check SCENE` for the laws",
        ),
        EngineError::Crushed { .. } => (
            "walls that close on a body, or bodies that are pressed together harder than a rebound parts them",
            "room between the walls, or bodies that give way: `driver: TimeStep()`",
        ),
        EngineError::Guard(alarm) => match alarm.kind {
            AlarmKind::Overlap => (
                "contacts too soft for the speeds or loads that occur, or a time step so long that contacts are missed",
                "a larger stiffness or shorter contact duration, `impact_speed` as it is, a shorter step; or another limit, \
                 `guards: (overlap: ..)`",
            ),
            AlarmKind::Travel => (
                "a body is faster than expected, often after a contact with a step that is too long, or because nothing holds it",
                "a shorter step, `impact_speed` as it is; or another limit, `guards: (travel: ..)`",
            ),
            AlarmKind::Lost => (
                "a gap between walls, a wall that lacks, or a body that went through a wall in one step",
                "walls that close, a larger cell, a shorter step; or `guards: (lost: Off)` where bodies may leave",
            ),
            AlarmKind::Energy => (
                "the time step is too long for the contacts, or a law gives or takes energy that it does not account for",
                "a shorter step or `integrator: ContactResolved`; `granule law check SCENE` for the laws; or another limit, \
                 `guards: (energy: ..)`",
            ),
        },
        _ => ("", ""),
    }
}
