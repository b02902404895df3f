//! The scenes.

use std::f64::consts::PI;

/// How a layer is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Model {
    /// (a): time steps on the substrate.
    TimeSteps,
    /// (c): from collision to collision along arcs.
    Arcs,
    /// (c) with the larger rolling friction for both species.
    Control,
}

/// All, and the dearest first.
pub(super) const MODELS: [Model; 3] = [Model::TimeSteps, Model::Arcs, Model::Control];

impl Model {
    /// For names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TimeSteps => "steps",
            Self::Arcs => "arcs",
            Self::Control => "control",
        }
    }

    /// For readers.
    pub fn label(self) -> &'static str {
        match self {
            Self::TimeSteps => "(a) time steps",
            Self::Arcs => "(c) arcs",
            Self::Control => "(c) arcs, equal rolling friction",
        }
    }
}

/// Radius of all beads \[m\].
pub(super) const RADIUS: f64 = 1e-3;
/// Share of the plate that the beads cover, but for the rim.
pub(super) const PACKING: f64 = 0.5;
/// Restitution between the beads, and with the frame.
pub(super) const RESTITUTION: f64 = 0.9;
/// Rolling friction of the two species.
pub(super) const ROLLING: [f64; 2] = [1e-3, 0.1];
/// Steps in a contact of (a).
pub(super) const STEPS: f64 = 20.0;
/// Amplitude \[m\] and frequency \[Hz\] of the plate along x.
pub(super) const SHAKING: (f64, f64) = (5e-3, 4.0);

/// One layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub model: Model,
    /// Beads of each species along a side.
    pub side: usize,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Duration of a contact of (a) \[s\].
    pub contact: f64,
    pub seed: u64,
}

/// A plate with a frame that shakes with it, and twice `side`² beads on it, mixed as the fields of a chessboard.
pub(super) fn scene(case: &Case) -> String {
    let Case { model, side, duration, contact, seed } = *case;
    let spacing = (2.0 * PI * RADIUS * RADIUS / PACKING).sqrt();
    let width = spacing * side as f64;
    let rolling = if model == Model::Control { [ROLLING[1]; 2] } else { ROLLING };
    let lattice = |species: usize| {
        let first = spacing * (0.25 + 0.5 * species as f64);
        format!(
            r#"Lattice(material: "{species}", radius: {RADIUS}, kind: Cubic, spacing: {spacing:e}, lo: ({first:e}, {first:e}, {RADIUS}),
            hi: ({width:e}, {width:e}, {:e}), jitter: 1e-4, velocity_spread: 0.02),"#,
            1.001 * RADIUS
        )
    };
    let law = |species: usize| {
        let friction = rolling[species];
        format!(
            r#""{species}": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: {friction:e}),"#
        )
    };
    let collision = match model {
        Model::TimeSteps => {
            format!(
                "normal: LinearSpringDashpot(restitution: {RESTITUTION}, contact_duration: {:e})",
                contact
            )
        }
        Model::Arcs | Model::Control => {
            format!("collision: HardSphere(restitution: {RESTITUTION})")
        }
    };
    let contacts: String = [(0, 0), (0, 1), (1, 1)]
        .map(|(one, other)| format!(r#"(between: ("{one}", "{other}"), {collision}),"#))
        .concat();
    let driver = match model {
        Model::TimeSteps => format!("TimeStep(step: {:e})", contact / STEPS),
        Model::Arcs | Model::Control => {
            "Event(step: 0.5, slides: Arcs(), contact_duration: 1e-4)".to_string()
        }
    };
    let motion = format!("Sinusoidal(amplitude: ({:e}, 0, 0), frequency: {:e})", SHAKING.0, SHAKING.1);
    // The frame keeps clear of the first beads and their jitter.
    let rim = (1.2 * RADIUS - 0.25 * spacing).max(0.0);
    format!(
        r#"(version: 1, seed: {seed}, gravity: (0, 0, -9.81), materials: {{ "0": (density: 7850), "1": (density: 7850) }},
        bodies: [{}{}],
        walls: {{ "frame": Box(lo: ({:e}, {:e}, -1), hi: ({:e}, {:e}, 1), open: ["z-", "z+"], material: "0", motion: {motion}) }},
        substrate: (motion: {motion}, laws: {{ {}{} }}),
        contacts: [{contacts}], driver: {driver}, run: (duration: {duration:e}))"#,
        lattice(0),
        lattice(1),
        -rim,
        -rim,
        width + rim,
        width + rim,
        law(0),
        law(1),
    )
}
