//! LIGGGHTS: `pair gran` and `fix wall/gran ... primitive`.
//!
//! The style and its switches are one for the run; numbers are matrices over pairs of types, elastic moduli one per type.

use super::inputs::{BODIES, boundary, put, shear, tail};
use super::{
    Engine, LiggghtsLaw, LiggghtsNormal, LiggghtsTangential, PeerError, PeerLaw, PeerMaterial, PeerScene,
};

/// Young's moduli outside are refused in SI units unless a command allows them.
const USUAL_YOUNGS_MODULUS: std::ops::RangeInclusive<f64> = 5e6..=1e9;

pub fn script(scene: &PeerScene) -> Result<String, PeerError> {
    let laws = matrix(scene)?;
    let style = style(&laws[0]);
    if laws.iter().any(|law| self::style(law) != style) {
        return unsupported("one model and one set of switches serves all pairs of types");
    }
    let materials = materials(scene, &laws)?;
    let mut text = format!("# {}\nunits si\n", scene.title);
    if materials.iter().any(|material| material.youngs_modulus > *USUAL_YOUNGS_MODULUS.end()) {
        text.push_str("hard_particles yes\n");
    }
    if materials.iter().any(|material| material.youngs_modulus < *USUAL_YOUNGS_MODULUS.start()) {
        text.push_str("soft_particles yes\n");
    }
    put(
        &mut text,
        format_args!(
            "atom_style granular\natom_modify map array\nboundary {}\nprocessors {}\nnewton off\n\
             communicate single vel yes\nread_data {BODIES}\nneighbor {:?} bin\n\
             neigh_modify delay 0 every 1 check {}\n",
            boundary(scene),
            scene.tuning.processors(),
            scene.skin,
            scene.tuning.check()
        ),
    );
    properties(&mut text, scene.kinds(), &laws, &materials);
    let (model, switches) = style;
    put(&mut text, format_args!("pair_style gran {model}{switches}\npair_coeff * *\n"));
    for (index, wall) in scene.walls.iter().enumerate() {
        // The plane acts from both sides, so the side is where the bodies are. The switches come last.
        put(
            &mut text,
            format_args!(
                "fix w{} all wall/gran {model} primitive type {} {}plane {:?}{}{switches}\n",
                index + 1,
                wall.kind,
                wall.axis.letter(),
                wall.position,
                shear(wall.velocity)
            ),
        );
    }
    // No `format float` here: one conversion per column.
    let columns = 3 * scene.quantities.len();
    let format = format!("\"%d{}\"", " %.17g".repeat(columns));
    text.push_str(&tail(scene, &format, "freeze"));
    Ok(text)
}

fn unsupported<T>(what: &str) -> Result<T, PeerError> {
    Err(PeerError::Unsupported(Engine::Liggghts, what.into()))
}

/// Laws of all pairs of types, row by row. Pairs that never meet (two walls) get the first law: the engine wants a number.
fn matrix(scene: &PeerScene) -> Result<Vec<LiggghtsLaw>, PeerError> {
    let liggghts = |law: &PeerLaw| match law {
        PeerLaw::Liggghts(law) => Ok(*law),
        _ => Err(PeerError::Scene("a law of LAMMPS in a scene for LIGGGHTS".into())),
    };
    let first = scene.laws.values().next().ok_or_else(|| PeerError::Scene("it has no laws".into()))?;
    let first = liggghts(first)?;
    let mut laws = Vec::new();
    for i in 1..=scene.kinds() {
        for j in 1..=scene.kinds() {
            laws.push(scene.law(i, j).map_or(Ok(first), liggghts)?);
        }
    }
    Ok(laws)
}

/// Model words and switches.
fn style(law: &LiggghtsLaw) -> (String, String) {
    let normal = match law.normal {
        LiggghtsNormal::HookeStiffness { .. } => "hooke/stiffness",
        LiggghtsNormal::HertzStiffness { .. } => "hertz/stiffness",
        LiggghtsNormal::HookeHysteresis { .. } => "hooke/hysteresis",
        LiggghtsNormal::Hertz { .. } => "hertz",
    };
    let tangential = match law.tangential {
        LiggghtsTangential::NoHistory => "no_history",
        LiggghtsTangential::History => "history",
    };
    let on_off = |on: bool| if on { "on" } else { "off" };
    (
        format!("model {normal} tangential {tangential}"),
        format!(
            " tangential_damping {} limitForce {}",
            on_off(law.tangential_damping),
            on_off(law.limit_force)
        ),
    )
}

fn needs_materials(law: &LiggghtsLaw) -> bool {
    matches!(law.normal, LiggghtsNormal::Hertz { .. } | LiggghtsNormal::HookeHysteresis { .. })
}

/// One material per type, or none if no law needs them.
fn materials(scene: &PeerScene, laws: &[LiggghtsLaw]) -> Result<Vec<PeerMaterial>, PeerError> {
    if !needs_materials(&laws[0]) {
        return Ok(Vec::new());
    }
    let complete: Option<Vec<PeerMaterial>> = scene.materials.iter().copied().collect();
    complete.ok_or_else(|| PeerError::Scene("this model of LIGGGHTS needs a material for every type".into()))
}

fn properties(text: &mut String, kinds: usize, laws: &[LiggghtsLaw], materials: &[PeerMaterial]) {
    let mut per_pair = |name: &str, value: &dyn Fn(&LiggghtsLaw) -> f64| {
        put(text, format_args!("fix {name} all property/global {name} peratomtypepair {kinds}"));
        for law in laws {
            put(text, format_args!(" {:?}", value(law)));
        }
        text.push('\n');
    };
    per_pair("coefficientFriction", &|law| law.friction);
    let restitution = |law: &LiggghtsLaw| match law.normal {
        LiggghtsNormal::Hertz { restitution } => restitution,
        // No dashpot beside the hysteresis.
        LiggghtsNormal::HookeHysteresis { .. } => 1.0,
        _ => f64::NAN,
    };
    let hysteresis = |law: &LiggghtsLaw| match law.normal {
        LiggghtsNormal::HookeHysteresis { ratio, depth } => [ratio, 0.0, depth],
        _ => [f64::NAN; 3],
    };
    let stiffness = |law: &LiggghtsLaw| match law.normal {
        LiggghtsNormal::HookeStiffness { kn, kt, gamma_n, gamma_t }
        | LiggghtsNormal::HertzStiffness { kn, kt, gamma_n, gamma_t } => [kn, kt, gamma_n, gamma_t],
        LiggghtsNormal::Hertz { .. } | LiggghtsNormal::HookeHysteresis { .. } => [f64::NAN; 4],
    };
    // The script writer has made sure that all laws are of one model.
    if !needs_materials(&laws[0]) {
        for (index, name) in ["kn", "kt", "gamman", "gammat"].iter().enumerate() {
            per_pair(name, &|law| stiffness(law)[index]);
        }
        return;
    }
    per_pair("coefficientRestitution", &restitution);
    if matches!(laws[0].normal, LiggghtsNormal::HookeHysteresis { .. }) {
        let names =
            ["coefficientMaxElasticStiffness", "coefficientAdhesionStiffness", "coefficientPlasticityDepth"];
        for (index, name) in names.iter().enumerate() {
            per_pair(name, &|law| hysteresis(law)[index]);
        }
    }
    for (name, value) in [
        ("youngsModulus", (|material| material.youngs_modulus) as fn(&PeerMaterial) -> f64),
        ("poissonsRatio", |material| material.poisson_ratio),
    ] {
        put(text, format_args!("fix {name} all property/global {name} peratomtype"));
        for material in materials {
            put(text, format_args!(" {:?}", value(material)));
        }
        text.push('\n');
    }
    if matches!(laws[0].normal, LiggghtsNormal::HookeHysteresis { .. }) {
        text.push_str("fix characteristicVelocity all property/global characteristicVelocity scalar 1.0\n");
    }
}
