//! LAMMPS: `pair gran/hooke`, `gran/hooke/history`, `gran/hertz/history` and `pair granular`, with `fix wall/gran`.
//!
//! Two-sided walls of `fix wall/gran` keep one history per body and see the nearer plane only, so each plane gets a fix
//! of its own. `pair granular` mixes unset pairs wrongly, so every pair is set.

use std::collections::BTreeSet;

use super::inputs::{BODIES, boundary, put, shear, tail};
use super::{
    ClassicLaw, ClassicStyle, Engine, GranularDamping, GranularLaw, GranularNormal, GranularTangential,
    PeerError, PeerLaw, PeerScene, Side,
};

pub fn script(scene: &PeerScene) -> Result<String, PeerError> {
    let mut text = format!(
        "# {}\nunits si\natom_style sphere\nboundary {}\nprocessors {}\nnewton off\ncomm_modify vel yes\n\
         read_data {BODIES}\nneighbor {:?} {}\nneigh_modify delay 0 every 1 check {}\n",
        scene.title,
        boundary(scene),
        scene.tuning.processors(),
        scene.skin,
        if scene.tuning.size_classes.is_empty() { "bin" } else { "multi" },
        scene.tuning.check()
    );
    if !scene.tuning.size_classes.is_empty() {
        text.push_str("comm_modify mode multi vel yes\n");
        put(&mut text, format_args!("neigh_modify collection/interval {}", scene.tuning.size_classes.len()));
        for diameter in &scene.tuning.size_classes {
            put(&mut text, format_args!(" {diameter:?}"));
        }
        text.push('\n');
    }
    text.push_str(&pair(scene)?);
    text.push_str(&walls(scene)?);
    text.push_str(&tail(scene, "float %.17g", "freeze"));
    Ok(text)
}

fn unsupported<T>(what: &str) -> Result<T, PeerError> {
    Err(PeerError::Unsupported(Engine::Lammps, what.into()))
}

fn pair(scene: &PeerScene) -> Result<String, PeerError> {
    let kinds = scene.body_kinds();
    let between_bodies =
        || scene.laws.iter().filter(|((i, j), _)| kinds.contains(i) && kinds.contains(j)).map(|(_, law)| law);
    match between_bodies().next() {
        Some(PeerLaw::Classic(law)) => {
            if between_bodies().any(|other| *other != PeerLaw::Classic(*law)) {
                return unsupported("`pair gran/*` has one law for all pairs of bodies");
            }
            Ok(format!("pair_style gran/{}\npair_coeff * *\n", classic(law)))
        }
        Some(PeerLaw::Granular(_)) => {
            let mut text = String::from("pair_style granular\n");
            // Types without bodies (of walls) never meet another one, but LAMMPS wants a coefficient for every pair.
            let mut stand_in = None;
            for i in 1..=scene.kinds() {
                for j in i..=scene.kinds() {
                    match scene.law(i, j) {
                        Some(PeerLaw::Granular(law)) => {
                            stand_in.get_or_insert(*law);
                            put(&mut text, format_args!("pair_coeff {i} {j} {}\n", granular(law)));
                        }
                        Some(_) => return unsupported("`pair granular` does not mix with `pair gran/*`"),
                        None => {
                            let law = stand_in
                                .or_else(|| scene.laws.values().find_map(as_granular))
                                .ok_or_else(|| PeerError::Scene("it has no laws".into()))?;
                            put(&mut text, format_args!("pair_coeff {i} {j} {}\n", granular(&law)));
                        }
                    }
                }
            }
            Ok(text)
        }
        Some(PeerLaw::Liggghts(_)) | None => {
            Err(PeerError::Scene("it has no LAMMPS law between bodies".into()))
        }
    }
}

fn as_granular(law: &PeerLaw) -> Option<GranularLaw> {
    match law {
        PeerLaw::Granular(law) => Some(*law),
        _ => None,
    }
}

fn walls(scene: &PeerScene) -> Result<String, PeerError> {
    let mut text = String::new();
    let mut groups = BTreeSet::new();
    let kinds = scene.body_kinds();
    for (index, wall) in scene.walls.iter().enumerate() {
        let mut fixes: Vec<(PeerLaw, Option<usize>)> = Vec::new();
        for kind in &kinds {
            let law = scene.law(*kind, wall.kind).copied();
            let law = law.ok_or_else(|| PeerError::Scene(format!("type {kind} has no law at a wall")))?;
            fixes.push((law, Some(*kind)));
        }
        if fixes.iter().all(|(law, _)| *law == fixes[0].0) {
            fixes.truncate(1);
            fixes[0].1 = None;
        }
        for (law, kind) in fixes {
            let group = match kind {
                None => "all".to_owned(),
                Some(kind) => {
                    if groups.insert(kind) {
                        put(&mut text, format_args!("group type{kind} type {kind}\n"));
                    }
                    format!("type{kind}")
                }
            };
            let model = match law {
                PeerLaw::Classic(law) => classic(&law),
                PeerLaw::Granular(law) => format!("granular {}", granular(&law)),
                PeerLaw::Liggghts(_) => {
                    return Err(PeerError::Scene("a law of LIGGGHTS at a LAMMPS wall".into()));
                }
            };
            let planes = match wall.side {
                Side::Above => format!("{:?} NULL", wall.position),
                Side::Below => format!("NULL {:?}", wall.position),
            };
            put(
                &mut text,
                format_args!(
                    "fix w{}{group} {group} wall/gran {model} {}plane {planes}{}\n",
                    index + 1,
                    wall.axis.letter(),
                    shear(wall.velocity)
                ),
            );
        }
    }
    Ok(text)
}

/// Style and arguments, as `pair_style gran/...` and `fix wall/gran ...` share them.
fn classic(law: &ClassicLaw) -> String {
    let style = match law.style {
        ClassicStyle::HookeNoHistory => "hooke",
        ClassicStyle::HookeHistory => "hooke/history",
        ClassicStyle::HertzHistory => "hertz/history",
    };
    format!(
        "{style} {:?} {:?} {:?} {:?} {:?} {}{}",
        law.kn,
        law.kt,
        law.gamma_n,
        law.gamma_t,
        law.friction,
        u8::from(law.tangential_damping),
        if law.limit_damping { " limit_damping" } else { "" }
    )
}

/// Model words, as `pair_coeff` and `fix wall/gran granular` share them.
fn granular(law: &GranularLaw) -> String {
    let (damping, coefficient) = match law.damping {
        GranularDamping::Velocity(value) => ("velocity", value),
        GranularDamping::MassVelocity(value) => ("mass_velocity", value),
        GranularDamping::Viscoelastic(value) => ("viscoelastic", value),
        GranularDamping::Tsuji(value) => ("tsuji", value),
    };
    let normal = match law.normal {
        GranularNormal::Hooke(k) => format!("hooke {k:?} {coefficient:?}"),
        GranularNormal::Hertz(k) => format!("hertz {k:?} {coefficient:?}"),
    };
    let (multiple, friction) = (law.tangential_damping, law.friction);
    let tangential = match law.tangential {
        GranularTangential::LinearNoHistory => format!("linear_nohistory {multiple:?} {friction:?}"),
        GranularTangential::LinearHistory(k) => format!("linear_history {k:?} {multiple:?} {friction:?}"),
        GranularTangential::Mindlin(k) => format!("mindlin {k:?} {multiple:?} {friction:?}"),
    };
    let limit = if law.limit_damping { " limit_damping" } else { "" };
    format!("{normal} tangential {tangential} damping {damping}{limit}")
}
