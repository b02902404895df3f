//! Reads a scene block by block.

mod accuracy;
mod bodies;
mod contacts;
mod guards;
mod run;
mod substrate;
mod walls;

use std::ops::Range;

use granule_units::Dimension;

use crate::reader::{Allowed, Reader};
use crate::scene::{
    CellBlock, ConventionsBlock, MaterialBlock, PrecisionChoice, Scene, Section, Spanned, StepChoice,
    TimeStepBlock,
};
use crate::syntax::Node;
use crate::{Diagnostic, Severity, spec, tidy};

/// A scene as far as it could be read, and what is wrong with it.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The scene; `None` if the text is not RON at all or not of this version.
    pub scene: Option<Scene>,
    /// All problems, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads the text of a scene.
pub fn parse(text: &str) -> Parsed {
    let mut reader = Reader::default();
    let scene = match Node::whole(text) {
        Ok(node) => scene(&mut reader, node),
        Err(error) => {
            reader.diagnostics.push(error);
            None
        }
    };
    let mut diagnostics = reader.diagnostics;
    let complete = diagnostics.iter().all(|diagnostic| diagnostic.severity != Severity::Error);
    tidy(&mut diagnostics);
    Parsed { scene: scene.map(|scene| Scene { complete: complete && scene.complete, ..scene }), diagnostics }
}

fn scene(r: &mut Reader, node: Node<'_>) -> Option<Scene> {
    let start = node.span().start;
    let at = start..start + 1;
    let f = r.block(Some(node), &spec::SCENE, at.clone())?;
    if let Some(version) = f.get("version")
        && version.whole_number() != Some(1)
    {
        r.error(
            version.span(),
            format!("version `{}` of the scene format is not known", version.quoted()),
            "this program reads version 1",
        );
        return None;
    }
    let dimensions = r.optional(&f, "dimensions", |r, name, node| r.whole(name, node, 2, 3));
    let title = r.optional(&f, "title", Reader::string);
    let seed = r.optional(&f, "seed", |r, name, node| r.whole(name, node, 0, u64::MAX));
    let gravity = r
        .optional(&f, "gravity", |r, name, node| r.vector(name, node, Dimension::ACCELERATION, Allowed::Any));
    let cell = r.optional(&f, "cell", |r, _, node| cell(r, node));
    let materials = section(r, f.get("materials"), &at, materials);
    let bodies = section(r, f.get("bodies"), &at, bodies::list);
    let walls = section(r, f.get("walls"), &at, walls::map);
    let surface = r.optional(&f, "substrate", |r, _, node| substrate::block(r, node));
    let contacts = section(r, f.get("contacts"), &at, contacts::list);
    let conventions = r.optional(&f, "conventions", |r, _, node| conventions(r, node));
    let precision = r.optional(&f, "precision", |r, name, node| {
        r.choice(name, node, &[("Double", PrecisionChoice::Double), ("Single", PrecisionChoice::Single)])
    });
    let impact_speed = r.optional(&f, "impact_speed", |r, name, node| {
        r.quantity(name, node, Dimension::VELOCITY, Allowed::Positive)
    });
    let allow_overlap = r.optional(&f, "allow_overlap", Reader::boolean);
    let driver = r.optional(&f, "driver", |r, _, node| run::driver(r, node));
    let (driver, event) = match driver {
        None => (None, None),
        Some(None) => (Some(None), None),
        Some(Some(run::DriverBlock::TimeStep(block))) => (Some(Some(block)), None),
        Some(Some(run::DriverBlock::Event(block))) => (Some(None), Some(block)),
    };
    let accuracy = accuracy::goal(r, &f);
    let run = r.required(&f, "run", |r, _, node| run::length(r, node));
    let outputs = section(r, f.get("outputs"), &at, run::outputs);
    let checkpoint = r.optional(&f, "checkpoint", |r, _, node| run::checkpoint(r, node));
    let guards = r.optional(&f, "guards", |r, _, node| guards::block(r, node));
    let ledger = r.optional(&f, "ledger", Reader::boolean);
    Some(Scene {
        title: title.flatten().map_or(String::new(), |title| title.value),
        seed: seed.flatten().map_or(0, |seed| seed.value),
        complete: dimensions.is_some()
            && gravity.is_some()
            && cell.is_some()
            && surface.is_some()
            && accuracy.is_some(),
        dimensions: dimensions
            .flatten()
            .map_or(Spanned::new(3, at.clone()), |d| Spanned::new(if d.value == 2 { 2 } else { 3 }, d.span)),
        gravity: gravity.flatten(),
        cell: cell.flatten(),
        materials,
        bodies,
        walls,
        substrate: surface.flatten(),
        contacts,
        conventions: conventions.flatten().unwrap_or(ConventionsBlock { preset: None, changes: Vec::new() }),
        precision: precision.flatten().map_or(PrecisionChoice::Double, |precision| precision.value),
        impact_speed: impact_speed.flatten(),
        allow_overlap: allow_overlap.flatten().unwrap_or(false),
        driver: driver.flatten().unwrap_or(TimeStepBlock {
            integrator: None,
            step: Spanned::new(StepChoice::Auto { steps_per_contact: run::STEPS_PER_CONTACT }, at),
            packing_limit: true,
            skin: None,
            threads: None,
        }),
        event,
        accuracy: accuracy.flatten(),
        run,
        outputs,
        checkpoint: checkpoint.flatten(),
        guards: guards.flatten().unwrap_or_default(),
        ledger: ledger.flatten().unwrap_or(false),
    })
}

/// What the reader of a section returns: the blocks, and whether all of them could be read.
type Blocks<T> = (Vec<T>, bool);

fn section<'a, T>(
    r: &mut Reader,
    node: Option<Node<'a>>,
    at: &Range<usize>,
    read: impl FnOnce(&mut Reader, Node<'a>) -> Option<Blocks<T>>,
) -> Section<T> {
    match node {
        None => Section { items: Vec::new(), complete: true, span: at.clone() },
        Some(node) => {
            let (items, complete) = read(r, node).unwrap_or((Vec::new(), false));
            Section { items, complete, span: node.span() }
        }
    }
}

/// Keeps the blocks that could be read.
fn keep<T>(blocks: Vec<Option<T>>) -> Blocks<T> {
    let complete = blocks.iter().all(Option::is_some);
    (blocks.into_iter().flatten().collect(), complete)
}

fn cell(r: &mut Reader, node: Node<'_>) -> Option<CellBlock> {
    let f = r.block(Some(node), &spec::CELL, node.span())?;
    let corner = |r: &mut Reader, name: &str, node: Node<'_>| {
        r.vector(name, node, Dimension::LENGTH, Allowed::Infinite)
    };
    let lo = r.required(&f, "lo", corner);
    let hi = r.required(&f, "hi", corner);
    let periodic = r.optional(&f, "periodic", |r, name, node| {
        let items = node.items().filter(|items| (2..=3).contains(&items.len()));
        let flags = items.and_then(|items| items.iter().map(Node::boolean).collect::<Option<Vec<bool>>>());
        match flags {
            Some(flags) => Some(Spanned::new(flags, node.span())),
            None => {
                let message =
                    format!("`{name}` must be (true, true, false) or the like, not `{}`", node.quoted());
                r.error(node.span(), message, "one of true, false for each direction");
                None
            }
        }
    });
    let (lo, hi) = (lo?, hi?);
    let periodic =
        periodic?.unwrap_or_else(|| Spanned::new(vec![false; lo.components.len()], lo.span.clone()));
    Some(CellBlock { lo, hi, periodic, span: node.span() })
}

fn materials(r: &mut Reader, node: Node<'_>) -> Option<Blocks<MaterialBlock>> {
    let named = r.named("materials", node)?;
    let blocks = named.into_iter().map(|(name, node)| {
        let f = r.block(Some(node), &spec::MATERIAL_BLOCK, node.span())?;
        let density = r.optional(&f, "density", |r, name, node| {
            r.quantity(name, node, Dimension::DENSITY, Allowed::Positive)
        })?;
        Some(MaterialBlock { name, density })
    });
    Some(keep(blocks.collect()))
}

fn conventions(r: &mut Reader, node: Node<'_>) -> Option<ConventionsBlock> {
    if let Some(preset) = node.string() {
        return Some(ConventionsBlock {
            preset: Some(Spanned::new(preset, node.span())),
            changes: Vec::new(),
        });
    }
    let f = r.block(Some(node), &spec::CONVENTIONS, node.span())?;
    let preset = r.optional(&f, "preset", Reader::string);
    let mut changes = Vec::new();
    let mut good = true;
    for entry in f.entries().iter().filter(|entry| entry.name != "preset") {
        match r.variant(&entry.name, entry.value, &[]) {
            Some(variant) => changes.push((
                Spanned::new(entry.name.clone(), entry.span.clone()),
                Spanned::new(variant.name.to_string(), variant.span),
            )),
            None => good = false,
        }
    }
    if !good {
        return None;
    }
    Some(ConventionsBlock { preset: preset?, changes })
}
