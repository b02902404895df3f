//! Laws of the scene, looked up, checked and compiled for the pairs of materials that can meet.

pub(crate) mod check;
pub(crate) mod meeting;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use granule_law_api::{Columns, Conventions, PairContext, Slot};
use granule_scene::{ContactBlock, PrecisionChoice};

use self::check::{Chosen, check_laws, contact_end, law_error};
use self::meeting::{Meeting, meetings};
use crate::bodies::Draft;
use crate::build::Builder;
use crate::model::WallPlan;
use crate::model::{Composition, MaterialPlan, StagePlan};
use crate::speed::{self, SpeedReason};

/// Most pairs of materials, and of materials and walls, that can meet.
pub(crate) const MOST_MEETINGS: usize = 200_000;

/// What the laws are compiled for.
pub(crate) struct Setting<'a> {
    pub bodies: &'a [Draft],
    pub walls: &'a [WallPlan],
    pub materials: &'a [MaterialPlan],
    pub gravity: [f64; 3],
    pub conventions: Conventions,
    /// Nothing of the above is missing: absence means absence.
    pub whole: bool,
}

impl Setting<'_> {
    /// Largest impact speed, and where the number comes from.
    pub fn impact_speed(&self, builder: &Builder<'_>) -> (f64, SpeedReason) {
        match &builder.scene.impact_speed {
            Some(speed) => (speed.value, SpeedReason::Given),
            None => speed::estimate(self, builder.scene),
        }
    }
}

/// One contact block, checked as far as that is possible without bodies.
struct Checked<'s> {
    pair: (u16, u16),
    block: &'s ContactBlock,
    laws: Vec<Chosen<'s>>,
}

/// Compositions of all pairs that can meet.
pub(crate) fn compositions(builder: &mut Builder<'_>, setting: &Setting<'_>) -> Vec<Composition> {
    let scene = builder.scene;
    let mut checked: Vec<Checked<'_>> = Vec::new();
    // Place of the block of a pair.
    let mut block_of: BTreeMap<(u16, u16), usize> = BTreeMap::new();
    let mut whole = scene.contacts.complete && scene.materials.complete;
    for block in &scene.contacts.items {
        let first = builder.material(&block.between.0);
        let second = builder.material(&block.between.1);
        let laws = check_laws(builder, block);
        let (Some(first), Some(second)) = (first, second) else {
            whole = false;
            continue;
        };
        let pair = (first.min(second), first.max(second));
        if block_of.contains_key(&pair) {
            let (a, b) = (&block.between.0, &block.between.1);
            builder.error(
                a.span.start..b.span.end,
                format!("laws between `{}` and `{}` are given twice", a.value, b.value),
            );
            continue;
        }
        block_of.insert(pair, checked.len());
        match laws {
            Some(laws) => checked.push(Checked { pair, block, laws }),
            None => {
                whole = false;
                checked.push(Checked { pair, block, laws: Vec::new() });
            }
        }
    }
    if !setting.whole || scene.event.is_some() {
        return Vec::new();
    }
    let (speed, reason) = setting.impact_speed(builder);
    let meetings = meetings(setting);
    if meetings.len() > MOST_MEETINGS {
        let message =
            format!("more than {MOST_MEETINGS} pairs of materials, or materials and walls, can meet");
        builder.error(scene.materials.span.clone(), message);
        return Vec::new();
    }
    if !meetings.is_empty() {
        builder.decide_one("impact speed", true, format!("{speed:.6e} m/s: {}", reason.text()));
    }
    let mut compositions = Vec::new();
    let mut missing: BTreeSet<(u16, u16)> = BTreeSet::new();
    let mut met: BTreeSet<(u16, u16)> = BTreeSet::new();
    for meeting in &meetings {
        let pair = (meeting.material.min(meeting.other), meeting.material.max(meeting.other));
        let names = || [pair.0, pair.1].map(|index| setting.materials[usize::from(index)].name.as_str());
        met.insert(pair);
        let Some(checked) =
            block_of.get(&pair).and_then(|at| checked.get(*at)).filter(|found| found.pair == pair)
        else {
            // Once for each pair of materials.
            if whole && missing.insert(pair) {
                let [a, b] = names();
                builder.error_help(
                    scene.contacts.span.clone(),
                    format!("no law between `{a}` and `{b}`, which can meet: {}", meeting.example),
                    format!(
                        "add (between: (\"{a}\", \"{b}\"), normal: ..) to `contacts`; without laws in it they pass through \
                         each other"
                    ),
                );
            }
            continue;
        };
        if checked.laws.is_empty() {
            if checked.block.laws.is_empty() && checked.block.collision.is_some() {
                let [a, b] = names();
                builder.error_help(
                    checked.block.span.clone(),
                    format!(
                        "{a} and {b} have a collision rule only, which the driver `TimeStep` does not use"
                    ),
                    "add a `normal` law, or choose `driver: Event()`",
                );
            } else if checked.block.laws.is_empty() {
                let [a, b] = names();
                let why =
                    format!("{a} and {b} have no laws: they pass through each other ({})", meeting.example);
                builder.decide_one("contact", false, why);
            }
            continue;
        }
        compositions.extend(compile(builder, setting, checked, meeting, speed));
    }
    for checked in &checked {
        if !met.contains(&checked.pair) {
            let [a, b] =
                [checked.pair.0, checked.pair.1].map(|k| setting.materials[usize::from(k)].name.clone());
            builder.decide_one("contact", false, format!("{a} and {b} cannot meet: their laws are left out"));
        }
    }
    compositions
}

fn compile(
    builder: &mut Builder<'_>,
    setting: &Setting<'_>,
    checked: &Checked<'_>,
    meeting: &Meeting,
    impact_speed: f64,
) -> Option<Composition> {
    let mut context = PairContext {
        contact_end: contact_end(checked.block),
        conventions: setting.conventions,
        wanted: Columns::NONE,
        reduced_mass: meeting.reduced_mass,
        reduced_radius: meeting.reduced_radius,
        inertia_factor: meeting.inertia_factor,
        impact_speed,
        normal: None,
    };
    let single = builder.scene.precision == PrecisionChoice::Single;
    let mut stages: Vec<StagePlan> = Vec::new();
    let (mut history_width, mut reach) = (0, 0.0f64);
    let (mut reads, mut writes) = (Columns::NONE, Columns::NONE);
    for (index, law) in checked.laws.iter().enumerate() {
        let (entry, params) = (law.entry, &law.params);
        context.wanted = checked.laws[index + 1..]
            .iter()
            .fold(Columns::NONE, |wanted, later| wanted.and((later.entry.reads)(&later.params)));
        let compiled = (entry.compile_f64)(params, &context);
        let narrow = if single { Some((entry.compile_f32)(params, &context)) } else { None };
        let (double, narrow) = match (compiled, narrow.transpose()) {
            (Ok(double), Ok(narrow)) => (double, narrow),
            (Err(error), _) | (_, Err(error)) => {
                law_error(builder, law.block, entry.info.name, &error);
                return None;
            }
        };
        check::keeps_its_promises(builder, law.block, entry, params, &context);
        let stage_reads = (entry.reads)(params);
        stages.push(StagePlan {
            slot: entry.info.slot,
            law: entry,
            params: params.clone(),
            reads: stage_reads,
            history_offset: history_width,
            history_width: entry.info.history_width(),
            double: Arc::from(double),
            single: narrow.map(Arc::from),
        });
        history_width += entry.info.history_width();
        reach = reach.max((entry.reach)(params, &context));
        reads = reads.and(stage_reads);
        writes = writes.and(entry.info.writes);
        if entry.info.slot == Slot::Normal {
            context.normal = (entry.summary)(params, &context);
        }
    }
    context.wanted = Columns::NONE;
    Some(Composition {
        material: meeting.material,
        partner: meeting.partner,
        stages,
        contact_end: context.contact_end,
        context,
        history_width,
        reach,
        reads,
        writes,
    })
}
