//! Scene and registry to a plan.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use granule_geometry::{Cell, GeometryError};
use granule_law_api::{Columns, Conventions, Registry, VelocityRule};
use granule_scene::{
    Diagnostic, IntegratorChoice, PrecisionChoice, Scene, Severity, Vector, suggestion, tidy,
};

use crate::allowance::Allowance;
use crate::bodies::Draft;
use crate::model::{Decision, Dimensions, Guards, MaterialPlan, Plan, Precision, Scheme};
use crate::{bodies, checks, laws, outputs, schedule, substrate, walls};

/// Plans a scene. `base` is the folder that imported files are relative to.
///
/// The plan is absent if there is any error, or if some part of the scene could not be read. All problems are reported
/// at once, in the order of their places; those of reading are in [`granule_scene::Parsed`].
///
/// A scene that somebody else wrote may ask for anything: [`build_within`] bounds it.
pub fn build(scene: &Scene, registry: &Registry, base: &Path) -> (Option<Plan>, Vec<Diagnostic>) {
    build_within(scene, registry, base, &Allowance::UNBOUNDED)
}

/// The same for a scene that may use no more than `allowance`: what asks for more is an error of the scene.
pub fn build_within(
    scene: &Scene,
    registry: &Registry,
    base: &Path,
    allowance: &Allowance,
) -> (Option<Plan>, Vec<Diagnostic>) {
    let dimensions = if scene.dimensions.value == 2 { Dimensions::Two } else { Dimensions::Three };
    let (diagnostics, decisions) = (Vec::new(), Vec::new());
    let mut materials = BTreeMap::new();
    for (index, material) in scene.materials.items.iter().enumerate() {
        // Of two with one name, which is an error, the first.
        materials.entry(material.name.value.as_str()).or_insert(index);
    }
    let mut builder = Builder {
        scene,
        registry,
        base,
        allowance,
        materials,
        dimensions,
        diagnostics,
        decisions,
        bodies: 0.0,
    };
    let plan = builder.plan();
    let mut diagnostics = builder.diagnostics;
    tidy(&mut diagnostics);
    let failed = diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    (plan.filter(|_| scene.complete && !failed), diagnostics)
}

/// What the pieces of the planning share.
pub(crate) struct Builder<'a> {
    pub scene: &'a Scene,
    pub registry: &'a Registry,
    pub base: &'a Path,
    pub allowance: &'a Allowance,
    /// Place of each material, by name.
    pub materials: BTreeMap<&'a str, usize>,
    pub dimensions: Dimensions,
    pub diagnostics: Vec<Diagnostic>,
    pub decisions: Vec<Decision>,
    /// Bodies that lattices, fills and files have asked for.
    pub bodies: f64,
}

impl Builder<'_> {
    fn plan(&mut self) -> Option<Plan> {
        let scene = self.scene;
        if let Some(block) = &scene.accuracy {
            let message =
                format!("`{}` must be replaced by a setting before a plan is made", block.goal.field());
            self.error(block.span.clone(), message);
        }
        let gravity = match &scene.gravity {
            Some(gravity) => self.vector(gravity, "gravity"),
            None => Some([0.0; 3]),
        };
        let gravity = gravity.and_then(|gravity| substrate::tilted(self, gravity));
        let cell = self.cell();
        let materials: Vec<MaterialPlan> = scene
            .materials
            .items
            .iter()
            .map(|material| MaterialPlan { name: material.name.value.clone() })
            .collect();
        if materials.len() > usize::from(u16::MAX) {
            self.error(scene.materials.span.clone(), "at most 65535 materials");
            return None;
        }
        let conventions = self.conventions();
        let before = self.errors();
        let walls = walls::walls(self, cell.as_ref());
        let walls_whole = scene.walls.complete && self.errors() == before;
        // Without the walls and the cell it is not known which places are free.
        let room = cell.as_ref().filter(|_| walls_whole);
        let before = self.errors();
        let drafts = bodies::drafts(self, room, &walls);
        let bodies_whole = scene.bodies.complete && room.is_some() && self.errors() == before;
        checks::unused_materials(self, &walls);

        let whole = bodies_whole && walls_whole && gravity.is_some() && scene.complete;
        let (gravity, cell) = (gravity.unwrap_or([0.0; 3]), cell.unwrap_or(Cell::unbounded()));
        let scheme = self.scheme(&conventions);
        let conventions =
            conventions.map(|conventions| Conventions { velocity: velocity_rule(scheme), ..conventions });
        let setting = laws::Setting {
            bodies: &drafts,
            walls: &walls,
            materials: &materials,
            gravity,
            conventions: conventions.unwrap_or(Conventions::PHYSICAL),
            whole: whole && conventions.is_some(),
        };
        let compositions = laws::compositions(self, &setting);
        if whole {
            checks::places(self, &drafts, &walls, &cell);
        }
        let rotation = compositions.iter().any(|composition| {
            let turns = Columns::TANGENTIAL_VELOCITY
                .and(Columns::RELATIVE_SPIN)
                .and(Columns::TANGENTIAL_FORCE)
                .and(Columns::TORQUE);
            composition.reads.and(composition.writes).without(turns)
                != composition.reads.and(composition.writes)
        });
        let event = crate::event::event(self, &setting);
        let rotation = match &event {
            Some(event) => event.collisions.iter().any(|collision| collision.rule.is_rough()),
            None => rotation,
        };
        let bodies = bodies::table(&drafts);
        let substrate = substrate::substrate(self, &drafts, &cell, gravity, scheme);
        if let Some(substrate) = &substrate {
            crate::event::check_substrate(self, substrate);
        }
        let mut plan = Plan {
            title: scene.title.clone(),
            dimensions: self.dimensions,
            rotation: rotation || substrate.is_some(),
            ledger: false,
            precision: match scene.precision {
                PrecisionChoice::Double => Precision::Double,
                PrecisionChoice::Single => Precision::Single,
            },
            conventions: setting.conventions,
            gravity,
            cell,
            materials: materials.clone(),
            bodies,
            walls: walls.clone(),
            substrate,
            compositions,
            driver: schedule::blank(scheme),
            event,
            outputs: Vec::new(),
            checkpoint: None,
            guards: Guards::default(),
            decisions: Vec::new(),
            fingerprint: String::new(),
        };
        // A step can be judged only if every law and every body is known.
        let judged = whole && conventions.is_some() && scene.contacts.complete && self.errors() == 0;
        schedule::driver(self, &mut plan, judged)?;
        if judged && self.errors() == 0 {
            crate::impacts::warn(self, &plan);
            crate::resolution::check(self, &plan);
        }
        outputs::outputs(self, &mut plan);
        crate::checkpoint::checkpoint(self, &mut plan);
        crate::guards::guards(self, &mut plan);
        self.decide(&plan, &drafts);
        plan.decisions = std::mem::take(&mut self.decisions);
        plan.fingerprint = crate::fingerprint::fingerprint(&plan);
        Some(plan)
    }

    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>) {
        self.diagnostics.push(Diagnostic::error(span, message));
    }

    pub fn error_help(&mut self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::error(span, message).help(help));
    }

    pub fn warning(&mut self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::warning(span, message).help(help));
    }

    pub fn errors(&self) -> usize {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).count()
    }

    pub fn decide_one(&mut self, topic: &'static str, included: bool, why: impl Into<String>) {
        self.decisions.push(Decision { topic, included, why: why.into() });
    }

    /// Three components; in the plane the third is 0.
    pub fn vector(&mut self, vector: &Vector, name: &str) -> Option<[f64; 3]> {
        let value = |axis: usize| vector.components.get(axis).map_or(0.0, |component| component.value);
        match (self.dimensions, vector.components.len()) {
            (Dimensions::Three, 3) => {}
            (Dimensions::Three, _) => {
                self.error_help(
                    vector.span.clone(),
                    format!("`{name}` needs three components"),
                    "or set `dimensions: 2`",
                );
                return None;
            }
            (Dimensions::Two, 2) => {}
            (Dimensions::Two, _) => {
                if value(2) != 0.0 {
                    let span = vector.components[2].span.clone();
                    self.error(
                        span,
                        format!("the z component of `{name}` must be 0 in 2 dimensions, not {}", value(2)),
                    );
                    return None;
                }
            }
        }
        Some([value(0), value(1), value(2)])
    }

    /// A spin: three components, or one about z in the plane.
    pub fn spin(&mut self, vector: &Vector) -> Option<[f64; 3]> {
        let value = |axis: usize| vector.components.get(axis).map_or(0.0, |component| component.value);
        match (self.dimensions, vector.components.len()) {
            (Dimensions::Three, 3) => Some([value(0), value(1), value(2)]),
            (Dimensions::Three, _) => {
                self.error(vector.span.clone(), "`spin` needs three components");
                None
            }
            (Dimensions::Two, 1) => Some([0.0, 0.0, value(0)]),
            (Dimensions::Two, 3) if value(0) == 0.0 && value(1) == 0.0 => Some([0.0, 0.0, value(2)]),
            (Dimensions::Two, _) => {
                self.error_help(
                    vector.span.clone(),
                    "in 2 dimensions `spin` is about z",
                    "a single number, as in `spin: 10`",
                );
                None
            }
        }
    }

    /// Index of a material.
    pub fn material(&mut self, name: &granule_scene::Spanned<String>) -> Option<u16> {
        if let Some(index) = self.materials.get(name.value.as_str()) {
            return u16::try_from(*index).ok();
        }
        let items = &self.scene.materials.items;
        // A material that could not be read is reported already.
        if self.scene.materials.complete {
            let known: Vec<&str> = items.iter().map(|material| material.name.value.as_str()).collect();
            let help = suggestion("materials", &name.value, &known);
            self.error_help(name.span.clone(), format!("there is no material `{}`", name.value), help);
        }
        None
    }

    fn cell(&mut self) -> Option<Cell> {
        let Some(block) = &self.scene.cell else {
            return Some(Cell::unbounded());
        };
        let planar = self.dimensions == Dimensions::Two;
        let (lo, hi) = (self.vector(&block.lo, "lo"), self.vector(&block.hi, "hi"));
        let flags = &block.periodic.value;
        let enough = if planar { flags.len() == 2 || !flags[2] } else { flags.len() == 3 };
        if !enough {
            let message = if planar {
                "in 2 dimensions only x and y can be periodic"
            } else {
                "`periodic` needs three components"
            };
            self.error(block.periodic.span.clone(), message);
            return None;
        }
        let (mut lo, mut hi) = (lo?, hi?);
        if planar {
            (lo[2], hi[2]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let periodic = [flags[0], flags[1], !planar && flags[2]];
        match Cell::new(lo, hi, periodic) {
            Ok(cell) => Some(cell),
            Err(error) => {
                let span = match error {
                    GeometryError::EmptyExtent { axis, .. } | GeometryError::UnboundedPeriod { axis } => {
                        block.hi.components.get(axis).map(|component| component.span.clone())
                    }
                    _ => None,
                };
                self.error(span.unwrap_or(block.span.clone()), error.to_string());
                None
            }
        }
    }

    fn conventions(&mut self) -> Option<Conventions> {
        let block = &self.scene.conventions;
        let mut conventions = match &block.preset {
            None => Conventions::PHYSICAL,
            Some(name) => match Conventions::preset(&name.value) {
                Some(conventions) => conventions,
                None => {
                    let known: Vec<&str> = Conventions::PRESETS.iter().map(|(name, _)| *name).collect();
                    let help = suggestion("presets", &name.value, &known);
                    self.error_help(name.span.clone(), format!("there is no preset `{}`", name.value), help);
                    return None;
                }
            },
        };
        let mut good = true;
        for (name, choice) in &block.changes {
            if let Err(known) = crate::conventions::change(&mut conventions, &name.value, &choice.value) {
                let message = format!("`{}` cannot be `{}`", name.value, choice.value);
                self.error_help(choice.span.clone(), message, suggestion("allowed", &choice.value, &known));
                good = false;
            }
        }
        good.then_some(conventions)
    }

    /// The scheme asked for, or the one that the conventions imply.
    fn scheme(&mut self, conventions: &Option<Conventions>) -> Scheme {
        let implied = match conventions.map(|conventions| conventions.velocity) {
            Some(VelocityRule::HalfStep) => Scheme::ClassicVelocityVerlet,
            _ => Scheme::VelocityVerlet,
        };
        let Some(choice) = &self.scene.driver.integrator else {
            return implied;
        };
        let scheme = match choice.value {
            IntegratorChoice::VelocityVerlet => Scheme::VelocityVerlet,
            IntegratorChoice::ClassicVelocityVerlet => Scheme::ClassicVelocityVerlet,
            IntegratorChoice::ContactResolved => Scheme::ContactResolved,
            IntegratorChoice::Leapfrog => Scheme::Leapfrog,
            IntegratorChoice::SymplecticEuler => Scheme::SymplecticEuler,
        };
        if let Some(conventions) = conventions
            && (conventions.velocity == VelocityRule::HalfStep)
                != (velocity_rule(scheme) == VelocityRule::HalfStep)
            && (self.scene.conventions.preset.is_some() || !self.scene.conventions.changes.is_empty())
        {
            let (rule, other) = match conventions.velocity {
                VelocityRule::Synchronised | VelocityRule::Extrapolated => {
                    ("synchronised velocities", "VelocityVerlet")
                }
                VelocityRule::HalfStep => ("half-step velocities", "ClassicVelocityVerlet"),
            };
            self.warning(
                choice.span.clone(),
                format!("the conventions ask for {rule} in forces, which this integrator does not have"),
                format!("the integrator decides; `{other}` agrees with the conventions"),
            );
        }
        scheme
    }

    fn decide(&mut self, plan: &Plan, drafts: &[Draft]) {
        let (included, why) = match self.dimensions {
            Dimensions::Two => (false, "dimensions: 2, so no z column exists".to_string()),
            Dimensions::Three => (true, "dimensions: 3".to_string()),
        };
        self.decide_one("third dimension", included, why);
        if plan.substrate.is_some() {
            self.decide_one("rotation", true, "bodies roll on the substrate");
        } else if plan.rotation {
            self.decide_one("rotation", true, "a law acts on or reads the motion of the contact points");
        } else {
            let spinning = drafts.iter().filter(|draft| draft.spin != [0.0; 3]).count();
            let spins = match spinning {
                0 => String::new(),
                1 => "; the spin of one body never acts and stays as it is".to_string(),
                count => format!("; the spins of {count} bodies never act and stay as they are"),
            };
            self.decide_one("rotation", false, format!("no law has a tangential force or a torque{spins}"));
        }
        let width = plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0);
        if width > 0 {
            self.decide_one("contact history", true, format!("laws remember {width} numbers per contact"));
        } else {
            self.decide_one("contact history", false, "no law remembers anything");
        }
        let gravity = plan.gravity != [0.0; 3];
        let why = if gravity {
            format!("{:?} m/s^2", plan.gravity)
        } else {
            "the scene has none, or it is zero".to_string()
        };
        self.decide_one("gravity", gravity, why);
        let walls = plan.walls.len();
        let moving = plan.walls.iter().filter(|wall| !wall.wall.motion().is_fixed()).count();
        let why = match walls {
            0 => "the scene has none".to_string(),
            1 => format!("1 surface, {}", if moving == 0 { "fixed" } else { "moving" }),
            _ => format!("{walls} surfaces, {moving} of them moving"),
        };
        self.decide_one("walls", walls > 0, why);
        let periodic: Vec<&str> = ["x", "y", "z"]
            .into_iter()
            .zip(plan.cell.periodic())
            .filter_map(|(axis, periodic)| periodic.then_some(axis))
            .collect();
        let why = if periodic.is_empty() { "no direction".to_string() } else { periodic.join(", ") };
        self.decide_one("periodic directions", !periodic.is_empty(), why);
        substrate::decide(self, plan);
        let frozen = drafts.iter().filter(|draft| draft.frozen).count();
        self.decide_one("frozen bodies", frozen > 0, format!("{frozen} of {}", drafts.len()));
    }
}

/// Time of the velocities in forces under a scheme.
fn velocity_rule(scheme: Scheme) -> VelocityRule {
    match scheme {
        Scheme::VelocityVerlet | Scheme::SymplecticEuler => VelocityRule::Synchronised,
        Scheme::ContactResolved => VelocityRule::Extrapolated,
        Scheme::ClassicVelocityVerlet | Scheme::Leapfrog => VelocityRule::HalfStep,
    }
}
