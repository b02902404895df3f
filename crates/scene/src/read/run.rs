//! Driver, length of the run, outputs.

use granule_units::Dimension;

use super::{Blocks, keep};
use crate::reader::{Allowed, Fields, Reader, Variant};
use crate::scene::{
    CheckpointChoice, EventBlock, EveryChoice, IntegratorChoice, OutputBlock, OutputChoice, RunBlock,
    SlidesChoice, Spanned, StepChoice, TimeStepBlock,
};
use crate::spec::{self, Block};
use crate::syntax::Node;

/// Default number of steps in the shortest contact.
pub const STEPS_PER_CONTACT: f64 = 50.0;

/// Either driver.
pub enum DriverBlock {
    TimeStep(TimeStepBlock),
    Event(EventBlock),
}

/// `driver: TimeStep(..)` or `driver: Event(..)`.
pub fn driver(r: &mut Reader, node: Node<'_>) -> Option<DriverBlock> {
    let variant = r.variant("driver", node, &["TimeStep", "Event"])?;
    if variant.name == "TimeStep" {
        return time_step(r, variant).map(DriverBlock::TimeStep);
    }
    let f = r.block(variant.content, &spec::EVENT, variant.span)?;
    let positive = |r: &mut Reader, name: &str, node: Node<'_>| {
        r.quantity(name, node, Dimension::TIME, Allowed::Positive)
    };
    let step = r.optional(&f, "step", positive);
    let contact_duration = r.optional(&f, "contact_duration", positive);
    let slides = r.optional(&f, "slides", slides);
    Some(DriverBlock::Event(EventBlock {
        step: step?,
        contact_duration: contact_duration?,
        slides: slides?,
        span: node.span(),
    }))
}

fn slides(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<SlidesChoice>> {
    let variant = r.variant(name, node, &["Arcs", "EffectiveRestitution"])?;
    if variant.name == "EffectiveRestitution" {
        r.block(variant.content, &spec::EFFECTIVE_RESTITUTION, variant.span)?;
        return Some(Spanned::new(SlidesChoice::EffectiveRestitution, node.span()));
    }
    let f = r.block(variant.content, &spec::ARCS, variant.span)?;
    let error = r.optional(&f, "error", |r, name, node| {
        r.quantity(name, node, Dimension::LENGTH, Allowed::Positive)
    })?;
    Some(Spanned::new(SlidesChoice::Arcs { error: error.map(|error| error.value) }, node.span()))
}

fn time_step(r: &mut Reader, variant: Variant<'_>) -> Option<TimeStepBlock> {
    let at = variant.span.clone();
    let f = r.block(variant.content, &spec::TIME_STEP, variant.span)?;
    let integrator = r.optional(&f, "integrator", |r, name, node| {
        r.choice(
            name,
            node,
            &[
                ("VelocityVerlet", IntegratorChoice::VelocityVerlet),
                ("ClassicVelocityVerlet", IntegratorChoice::ClassicVelocityVerlet),
                ("ContactResolved", IntegratorChoice::ContactResolved),
                ("Leapfrog", IntegratorChoice::Leapfrog),
                ("SymplecticEuler", IntegratorChoice::SymplecticEuler),
            ],
        )
    });
    let step = r.optional(&f, "step", step);
    let packing_limit = r.optional(&f, "packing_limit", Reader::boolean);
    let skin =
        r.optional(&f, "skin", |r, name, node| r.quantity(name, node, Dimension::LENGTH, Allowed::Positive));
    let threads = r.optional(&f, "threads", |r, name, node| r.whole(name, node, 1, 4096));
    Some(TimeStepBlock {
        integrator: integrator?,
        step: step?.unwrap_or(Spanned::new(StepChoice::Auto { steps_per_contact: STEPS_PER_CONTACT }, at)),
        packing_limit: packing_limit?.unwrap_or(true),
        skin: skin?,
        threads: threads?
            .map(|threads| Spanned::new(u32::try_from(threads.value).unwrap_or(1), threads.span)),
    })
}

fn step(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<StepChoice>> {
    if node.variant().is_none() || node.number().is_some() {
        let step = r.quantity(name, node, Dimension::TIME, Allowed::Positive)?;
        return Some(Spanned::new(StepChoice::Fixed(step.value), step.span));
    }
    let variant = r.variant(name, node, &["Auto"])?;
    let f = r.block(variant.content, &spec::AUTO, variant.span)?;
    let steps = r.optional(&f, "steps_per_contact", |r, name, node| {
        r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::AtLeast(10.0))
    })?;
    let steps_per_contact = steps.map_or(STEPS_PER_CONTACT, |steps| steps.value);
    Some(Spanned::new(StepChoice::Auto { steps_per_contact }, node.span()))
}

/// `run: (duration: ..)` or `run: (steps: ..)`.
pub fn length(r: &mut Reader, node: Node<'_>) -> Option<RunBlock> {
    let f = r.block(Some(node), &spec::RUN, node.span())?;
    let duration = r.optional(&f, "duration", |r, name, node| {
        r.quantity(name, node, Dimension::TIME, Allowed::NonNegative)
    });
    let steps = r.optional(&f, "steps", |r, name, node| r.whole(name, node, 0, 1 << 53));
    match (duration?, steps?) {
        (Some(duration), None) => Some(RunBlock::Duration(duration)),
        (None, Some(steps)) => Some(RunBlock::Steps(steps)),
        _ => {
            r.error(
                node.span(),
                "`run` takes exactly one of duration, steps",
                "as in run: (duration: \"1 s\")",
            );
            None
        }
    }
}

/// `checkpoint: (every: .., keep: ..)` or `checkpoint: Never`.
pub fn checkpoint(r: &mut Reader, node: Node<'_>) -> Option<CheckpointChoice> {
    if node.variant().is_some_and(|(name, _, _)| !name.is_empty()) {
        r.choice("checkpoint", node, &[("Never", ())])?;
        return Some(CheckpointChoice::Never);
    }
    let f = r.block(Some(node), &spec::CHECKPOINT, node.span())?;
    let every = r.optional(&f, "every", every);
    let wall =
        r.optional(&f, "wall", |r, name, node| r.quantity(name, node, Dimension::TIME, Allowed::Positive));
    let keep = r.optional(&f, "keep", |r, name, node| r.whole(name, node, 1, 1000));
    Some(CheckpointChoice::Kept {
        every: every?,
        wall: wall?.map(|wall| wall.value),
        keep: keep?.map_or(2, |keep| keep.value as u32),
    })
}

const OUTPUTS: &[&str] = &[
    "Series",
    "Bodies",
    "LammpsDump",
    "Vtk",
    "LammpsData",
    "Contacts",
    "Layer",
    "PairCorrelation",
    "Impacts",
];

/// The list of outputs.
pub fn outputs(r: &mut Reader, node: Node<'_>) -> Option<Blocks<OutputBlock>> {
    let items = r.list("outputs", node)?;
    Some(keep(items.into_iter().map(|item| output(r, item)).collect()))
}

fn output(r: &mut Reader, node: Node<'_>) -> Option<OutputBlock> {
    let variant = r.variant("outputs", node, OUTPUTS)?;
    let spec: &'static Block = match variant.name {
        "Series" => &spec::SERIES_OUTPUT,
        "Bodies" => &spec::BODIES_OUTPUT,
        "LammpsDump" => &spec::DUMP_OUTPUT,
        "Vtk" => &spec::VTK_OUTPUT,
        "Layer" => &spec::LAYER_OUTPUT,
        "PairCorrelation" => &spec::PAIR_CORRELATION_OUTPUT,
        "Contacts" => &spec::CONTACTS_OUTPUT,
        "Impacts" => &spec::IMPACTS_OUTPUT,
        _ => &spec::DATA_OUTPUT,
    };
    let f = r.block(variant.content, spec, variant.span)?;
    let path = r.required(&f, "path", Reader::string);
    let every = if variant.name == "LammpsData" { Some(None) } else { r.optional(&f, "every", every) };
    let what = match variant.name {
        "Series" => series(r, &f),
        "Bodies" => {
            let ids = r.required(&f, "ids", |r, name, node| {
                let ids: Vec<Option<Spanned<u32>>> = r
                    .list(name, node)?
                    .into_iter()
                    .map(|item| {
                        let id = r.whole("id", item, 1, u64::from(u32::MAX))?;
                        u32::try_from(id.value).ok().map(|value| Spanned::new(value, id.span))
                    })
                    .collect();
                ids.into_iter().collect::<Option<Vec<_>>>()
            });
            ids.map(|ids| OutputChoice::Bodies { ids })
        }
        "LammpsDump" => Some(OutputChoice::LammpsDump),
        "Vtk" => r
            .optional(&f, "compressed", Reader::boolean)
            .map(|compressed| OutputChoice::Vtk { compressed: compressed.unwrap_or(true) }),
        "Layer" => {
            let (gap, neighbours) = (r.optional(&f, "gap", distance), r.optional(&f, "neighbours", distance));
            gap.zip(neighbours).map(|(gap, neighbours)| OutputChoice::Layer { gap, neighbours })
        }
        "PairCorrelation" => {
            let range = r.required(&f, "range", distance);
            let bins = r.optional(&f, "bins", |r, name, node| r.whole(name, node, 1, 10_000));
            let bins = bins.map(|bins| bins.map_or(100, |bins| bins.value as u32));
            range.zip(bins).map(|(range, bins)| OutputChoice::PairCorrelation { range, bins })
        }
        "Contacts" => Some(OutputChoice::Contacts),
        "Impacts" => r.optional(&f, "reach", distance).map(|reach| OutputChoice::Impacts { reach }),
        _ => Some(OutputChoice::LammpsData),
    };
    Some(OutputBlock { path: path?, what: what?, every: every?, span: node.span() })
}

fn distance(r: &mut Reader, name: &str, node: Node<'_>) -> Option<f64> {
    r.quantity(name, node, Dimension::LENGTH, Allowed::Positive).map(|length| length.value)
}

fn series(r: &mut Reader, f: &Fields<'_>) -> Option<OutputChoice> {
    let columns = r.optional(f, "columns", |r, name, node| {
        let columns: Vec<Option<Spanned<String>>> =
            r.list(name, node)?.into_iter().map(|item| r.string("column", item)).collect();
        columns.into_iter().collect::<Option<Vec<_>>>()
    });
    columns.map(|columns| OutputChoice::Series { columns })
}

fn every(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<EveryChoice>> {
    if node.string().is_some() {
        let time = r.quantity(name, node, Dimension::TIME, Allowed::Positive)?;
        return Some(Spanned::new(EveryChoice::Time(time.value), time.span));
    }
    let steps = r.whole(name, node, 1, u64::MAX)?;
    Some(Spanned::new(EveryChoice::Steps(steps.value), steps.span))
}
