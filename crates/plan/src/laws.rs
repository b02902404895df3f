//! Laws of the scene, looked up, checked and compiled for the pairs of materials that can meet.

use std::sync::Arc;

use granule_law_api::{
    Columns, ContactEnd, Conventions, LawEntry, LawError, PairContext, Params, RegistryError, Slot, Span,
};
use granule_scene::{ContactBlock, ContactEndChoice, LawBlock, ParameterValue, PrecisionChoice, suggestion};
use granule_units::parse_as;

use crate::bodies::Draft;
use crate::build::Builder;
use crate::model::WallPlan;
use crate::model::{Composition, MaterialPlan, Partner, StagePlan};
use crate::speed::{self, SpeedReason};

/// Columns that exist for every contact.
const GEOMETRY: Columns = Columns::NORMAL_VELOCITY
    .and(Columns::TANGENTIAL_VELOCITY)
    .and(Columns::RELATIVE_SPIN)
    .and(Columns::REDUCED_MASS)
    .and(Columns::REDUCED_RADIUS);

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

/// A law with checked parameters, and where it stands.
struct Chosen<'s> {
    entry: &'static LawEntry,
    params: Params,
    block: &'s LawBlock,
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
        if checked.iter().any(|earlier| earlier.pair == pair) {
            let (a, b) = (&block.between.0, &block.between.1);
            builder.error(
                a.span.start..b.span.end,
                format!("laws between `{}` and `{}` are given twice", a.value, b.value),
            );
            continue;
        }
        match laws {
            Some(laws) => checked.push(Checked { pair, block, laws }),
            None => {
                whole = false;
                checked.push(Checked { pair, block, laws: Vec::new() });
            }
        }
    }
    if !setting.whole {
        return Vec::new();
    }
    let (speed, reason) = setting.impact_speed(builder);
    let meetings = meetings(setting);
    if !meetings.is_empty() {
        builder.decide_one("impact speed", true, format!("{speed:.6e} m/s: {}", reason.text()));
    }
    let mut compositions = Vec::new();
    let mut missing: Vec<(u16, u16)> = Vec::new();
    for meeting in &meetings {
        let pair = (meeting.material.min(meeting.other), meeting.material.max(meeting.other));
        let names = || [pair.0, pair.1].map(|index| setting.materials[usize::from(index)].name.as_str());
        let Some(checked) = checked.iter().find(|checked| checked.pair == pair) else {
            // Once for each pair of materials.
            if whole && !missing.contains(&pair) {
                missing.push(pair);
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
            if checked.block.laws.is_empty() {
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
        let used = meetings.iter().any(|meeting| {
            (meeting.material.min(meeting.other), meeting.material.max(meeting.other)) == checked.pair
        });
        if !used {
            let [a, b] =
                [checked.pair.0, checked.pair.1].map(|k| setting.materials[usize::from(k)].name.clone());
            builder.decide_one("contact", false, format!("{a} and {b} cannot meet: their laws are left out"));
        }
    }
    compositions
}

/// Two sides that can meet.
struct Meeting {
    material: u16,
    other: u16,
    partner: Partner,
    /// Who, in words.
    example: String,
    reduced_mass: Span,
    reduced_radius: Span,
    inertia_factor: Span,
}

/// What the bodies of one material span.
#[derive(Clone, Copy)]
struct Extent {
    count: usize,
    movable: usize,
    /// Inverse mass, zero where frozen.
    inverse_mass: Span,
    radius: Span,
    inertia_factor: Span,
}

fn extents(setting: &Setting<'_>) -> Vec<Option<Extent>> {
    let mut extents: Vec<Option<Extent>> = vec![None; setting.materials.len()];
    for body in setting.bodies {
        let inverse = if body.frozen { 0.0 } else { 1.0 / body.mass };
        let Some(slot) = extents.get_mut(usize::from(body.material)) else { continue };
        let extent = slot.get_or_insert(Extent {
            count: 0,
            movable: 0,
            inverse_mass: Span::of(inverse),
            radius: Span::of(body.radius),
            inertia_factor: Span::of(body.inertia_factor),
        });
        extent.count += 1;
        extent.movable += usize::from(!body.frozen);
        extent.inverse_mass = widen(extent.inverse_mass, inverse);
        extent.radius = widen(extent.radius, body.radius);
        extent.inertia_factor = widen(extent.inertia_factor, body.inertia_factor);
    }
    extents
}

fn widen(span: Span, value: f64) -> Span {
    Span { min: span.min.min(value), max: span.max.max(value) }
}

fn meetings(setting: &Setting<'_>) -> Vec<Meeting> {
    let extents = extents(setting);
    let mut meetings = Vec::new();
    let name = |index: usize| setting.materials[index].name.as_str();
    for (a, one) in extents.iter().enumerate() {
        let Some(one) = one else { continue };
        for (b, other) in extents.iter().enumerate().skip(a) {
            let Some(other) = other else { continue };
            let enough = if a == b { one.count >= 2 } else { true };
            if !enough || one.movable + other.movable == 0 {
                continue;
            }
            // Two frozen bodies never interact, so at least one inverse mass is not zero.
            let lightest = one.inverse_mass.max + other.inverse_mass.max;
            let least = smallest_sum(one, other);
            meetings.push(Meeting {
                material: a as u16,
                other: b as u16,
                partner: Partner::Body(b as u16),
                example: format!("bodies of `{}` and bodies of `{}`", name(a), name(b)),
                reduced_mass: Span { min: 1.0 / lightest, max: 1.0 / least },
                reduced_radius: Span {
                    min: reduced(one.radius.min, other.radius.min),
                    max: reduced(one.radius.max, other.radius.max),
                },
                inertia_factor: widen(
                    widen(one.inertia_factor, other.inertia_factor.min),
                    other.inertia_factor.max,
                ),
            });
        }
        if one.movable == 0 {
            continue;
        }
        let mut mass: Option<Span> = None;
        let mut radius: Option<Span> = None;
        let mut inertia: Option<Span> = None;
        for body in setting.bodies.iter().filter(|body| usize::from(body.material) == a && !body.frozen) {
            mass = Some(mass.map_or(Span::of(body.mass), |span| widen(span, body.mass)));
            radius = Some(radius.map_or(Span::of(body.radius), |span| widen(span, body.radius)));
            inertia =
                Some(inertia.map_or(Span::of(body.inertia_factor), |span| widen(span, body.inertia_factor)));
        }
        let (Some(mass), Some(radius), Some(inertia)) = (mass, radius, inertia) else { continue };
        for (index, wall) in setting.walls.iter().enumerate() {
            let surface = wall.wall.surface_at(0.0);
            let curvature = surface.contact(nalgebra::Vector3::zeros()).curvature_radius;
            let at_wall = |radius: f64| 1.0 / (1.0 / radius + 1.0 / curvature);
            meetings.push(Meeting {
                material: a as u16,
                other: wall.material,
                partner: Partner::Wall(index as u16),
                example: format!("bodies of `{}` and wall `{}`", name(a), wall.name),
                reduced_mass: mass,
                reduced_radius: Span { min: at_wall(radius.min), max: at_wall(radius.max) },
                inertia_factor: inertia,
            });
        }
    }
    meetings
}

/// Smallest sum of inverse masses of a pair that interacts.
fn smallest_sum(one: &Extent, other: &Extent) -> f64 {
    let sum = one.inverse_mass.min + other.inverse_mass.min;
    if sum > 0.0 {
        return sum;
    }
    // The heaviest of both are frozen: the heaviest movable body against a frozen one.
    let movable = |extent: &Extent| extent.heaviest_movable();
    movable(one).min(movable(other))
}

impl Extent {
    /// Inverse mass of the heaviest movable body, infinite if none moves. A lower bound is enough: the span of reduced
    /// masses is what laws may have to cope with.
    fn heaviest_movable(&self) -> f64 {
        if self.movable == 0 {
            f64::INFINITY
        } else if self.inverse_mass.min > 0.0 {
            self.inverse_mass.min
        } else {
            self.inverse_mass.max
        }
    }
}

fn reduced(a: f64, b: f64) -> f64 {
    a * b / (a + b)
}

fn slot_of(name: &str) -> Option<Slot> {
    Slot::ALL.into_iter().find(|slot| slot.name() == name)
}

/// The laws of a block; `None` if any is wrong.
fn check_laws<'s>(builder: &mut Builder<'_>, block: &'s ContactBlock) -> Option<Vec<Chosen<'s>>> {
    let mut chosen = Vec::new();
    let mut good = true;
    for (slot, law) in &block.laws {
        match check_law(builder, slot, law) {
            Some(law) => chosen.push(law),
            None => good = false,
        }
    }
    if !good {
        return None;
    }
    let mut written = GEOMETRY;
    for law in &chosen {
        let info = law.entry.info;
        let missing = (law.entry.reads)(&law.params).without(written);
        if !missing.is_empty() {
            let message = format!(
                "{} reads the {}, which no law before it computes",
                info.name,
                missing.names().join(" and the ")
            );
            let help = if written.contains(Columns::NORMAL_FORCE) {
                "choose another normal law, or other parameters"
            } else {
                "a contact with this law needs a `normal` law too"
            };
            builder.error_help(law.block.name.span.clone(), message, help);
            good = false;
        }
        written = written.and(info.writes);
        let end = contact_end(block);
        if !info.contact_ends.is_empty() && !info.contact_ends.contains(&end) {
            let span = block.contact_end.as_ref().map_or(&law.block.name.span, |end| &end.span);
            let known: Vec<&str> = info.contact_ends.iter().map(|end| end_name(*end)).collect();
            builder.error_help(
                span.clone(),
                format!("{} cannot have the contact end {}", info.name, end_name(end)),
                format!("set `contact_end: {}`", known.join("` or `")),
            );
            good = false;
        }
    }
    let turns = Columns::TANGENTIAL_FORCE.and(Columns::TORQUE).and(Columns::NORMAL_FORCE);
    let idle = chosen.iter().all(|law| law.entry.info.writes.without(turns) == law.entry.info.writes);
    if good && idle && !chosen.is_empty() {
        builder.error(block.span.clone(), "none of these laws makes a force");
        good = false;
    }
    good.then_some(chosen)
}

fn contact_end(block: &ContactBlock) -> ContactEnd {
    match block.contact_end.as_ref().map(|end| end.value) {
        Some(ContactEndChoice::Overlap) => ContactEnd::Overlap,
        Some(ContactEndChoice::Force) | None => ContactEnd::Force,
    }
}

fn end_name(end: ContactEnd) -> &'static str {
    match end {
        ContactEnd::Force => "Force",
        ContactEnd::Overlap => "Overlap",
    }
}

fn check_law<'s>(builder: &mut Builder<'_>, slot: &str, law: &'s LawBlock) -> Option<Chosen<'s>> {
    let entry = match builder.registry.get(&law.name.value) {
        Ok(entry) => entry,
        Err(RegistryError::Unknown { name, known, .. }) => {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = suggestion("laws", &name, &known);
            builder.error_help(law.name.span.clone(), format!("there is no law `{name}`"), help);
            return None;
        }
        Err(error) => {
            builder.error(law.name.span.clone(), error.to_string());
            return None;
        }
    };
    let info = entry.info;
    if slot_of(slot) != Some(info.slot) {
        let fitting: Vec<&str> = builder
            .registry
            .entries()
            .iter()
            .filter(|entry| slot_of(slot) == Some(entry.info.slot))
            .map(|entry| entry.info.name)
            .collect();
        builder.error_help(
            law.name.span.clone(),
            format!("{} is a {} law, not a {slot} law", info.name, info.slot.name()),
            format!(
                "{slot} laws: {}",
                if fitting.is_empty() { "none".to_string() } else { fitting.join(", ") }
            ),
        );
        return None;
    }
    let mut given: Vec<(&'static str, f64)> = Vec::new();
    let mut good = true;
    for (index, (name, value)) in law.parameters.iter().enumerate() {
        let Some(spec) = info.parameters.iter().find(|spec| spec.name == name.value) else {
            let known: Vec<&str> = info.parameters.iter().map(|spec| spec.name).collect();
            let help = suggestion("parameters", &name.value, &known);
            builder.error_help(
                name.span.clone(),
                format!("{} has no parameter `{}`", info.name, name.value),
                help,
            );
            good = false;
            continue;
        };
        if law.parameters[..index].iter().any(|(earlier, _)| earlier.value == name.value) {
            builder.error(name.span.clone(), format!("parameter `{}` is given twice", name.value));
            good = false;
            continue;
        }
        let (number, text) = match &value.value {
            ParameterValue::Number(number) => (*number, number.to_string()),
            ParameterValue::Text(text) => match parse_as(text, spec.dimension) {
                Ok(number) => (number, format!("\"{text}\"")),
                Err(error) => {
                    builder.error(value.span.clone(), format!("`{}`: {error}", spec.name));
                    good = false;
                    continue;
                }
            },
        };
        if !spec.range.contains(number) {
            let range =
                if number.is_finite() { spec.range.describe() } else { finite(spec.range.describe()) };
            builder.error_help(
                value.span.clone(),
                format!("`{}` must be {range}, not {text}", spec.name),
                format!("{} in {}: {}", spec.symbol, spec.dimension, spec.doc),
            );
            good = false;
            continue;
        }
        given.push((spec.name, number));
    }
    if !good {
        return None;
    }
    match Params::new(info, &given) {
        Ok(params) => Some(Chosen { entry, params, block: law }),
        Err(errors) => {
            for error in errors {
                law_error(builder, law, info.name, &error);
            }
            None
        }
    }
}

fn finite(range: String) -> String {
    if range.contains("finite") { range } else { format!("finite and {range}") }
}

/// Reports what a law says, at the parameter that it blames.
fn law_error(builder: &mut Builder<'_>, law: &LawBlock, name: &str, error: &LawError) {
    let blamed = error
        .parameter
        .as_ref()
        .and_then(|parameter| law.parameters.iter().find(|(name, _)| name.value == *parameter));
    let span = blamed.map_or(&law.name.span, |(_, value)| &value.span);
    let message = match &error.parameter {
        Some(parameter) => format!("{name}: `{parameter}` {}", error.message),
        None if error.message.starts_with(name) => error.message.clone(),
        None => format!("{name}: {}", error.message),
    };
    let diagnostic = granule_scene::Diagnostic::error(span.clone(), message);
    builder.diagnostics.push(match &error.help {
        Some(help) => diagnostic.help(help.clone()),
        None => diagnostic,
    });
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
