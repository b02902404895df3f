//! What each target is told, form by form, and what is refused.

use std::f64::consts::PI;
use std::sync::Arc;

use super::laws::tsuji;
use super::*;
use crate::ours::SceneFile;
use crate::peers::{
    ClassicStyle, GranularDamping, GranularNormal, GranularTangential, LiggghtsNormal, PeerMaterial,
};

/// Two spheres of 1 mm radius and 1 g that meet under these laws.
fn pair(laws: &str) -> Arc<Plan> {
    scene(
        "materials: { \"a\": () },",
        "Sphere(material: \"a\", radius: 1e-3, mass: 1e-3, position: (0, 0, 0)),
         Sphere(material: \"a\", radius: 1e-3, mass: 1e-3, position: (2.1e-3, 0, 0), velocity: (-0.1, 0, 0)),",
        &format!("(between: (\"a\", \"a\"), {laws})"),
        "",
    )
}

fn scene(materials: &str, bodies: &str, contacts: &str, more: &str) -> Arc<Plan> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    let text = format!(
        "(version: 1, {materials} bodies: [{bodies}], contacts: [{contacts}], {more} driver: TimeStep(step: 1e-7), \
         run: (steps: 10))"
    );
    std::fs::write(&path, text).unwrap();
    SceneFile::read(&path).and_then(|scene| scene.plan()).unwrap_or_else(|problems| panic!("{problems}"))
}

fn classic(laws: &str) -> crate::peers::ClassicLaw {
    match translate(&pair(laws), Target::LammpsClassic).unwrap().laws[&(1, 1)] {
        PeerLaw::Classic(law) => law,
        other => panic!("{other:?}"),
    }
}

fn granular(laws: &str) -> crate::peers::GranularLaw {
    match translate(&pair(laws), Target::LammpsGranular).unwrap().laws[&(1, 1)] {
        PeerLaw::Granular(law) => law,
        other => panic!("{other:?}"),
    }
}

fn liggghts(laws: &str) -> (crate::peers::LiggghtsLaw, Option<PeerMaterial>) {
    let scene = translate(&pair(laws), Target::Liggghts).unwrap();
    match scene.laws[&(1, 1)] {
        PeerLaw::Liggghts(law) => (law, scene.materials[0]),
        other => panic!("{other:?}"),
    }
}

fn refusal(plan: &Plan, target: Target) -> String {
    translate(plan, target).unwrap_err().to_string()
}

/// Equal but for a few roundings.
fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-13 * b.abs(), "{a} {b}");
}

const MASS: f64 = 0.5e-3;

/// γ/m12 = 2 |ln e| sqrt(k/m12) / sqrt(π² + ln² e) for a contact that ends with the overlap (Luding 1998, Eq. (32)).
#[test]
fn restitution_and_duration_become_stiffness_and_damping() {
    let log = 0.8_f64.ln();
    let law = classic("normal: LinearSpringDashpot(stiffness: 1000, restitution: 0.8), contact_end: Overlap");
    let expected = -2.0 * log * (1000.0 / MASS).sqrt() / (PI * PI + log * log).sqrt();
    close(law.gamma_n, expected);
    assert_eq!((law.kn, law.friction, law.style), (1000.0, 0.0, ClassicStyle::HookeNoHistory));
    assert!(!law.limit_damping);

    // ω = π/t_c and γ/m12 = -2 ln e / t_c for the same end.
    let law = classic(
        "normal: LinearSpringDashpot(restitution: 0.8, contact_duration: 1e-4), contact_end: Overlap",
    );
    close(law.gamma_n, -2.0 * log / 1e-4);
    close(law.kn, MASS * ((PI / 1e-4).powi(2) + (0.5 * law.gamma_n).powi(2)));

    let law = classic("normal: LinearSpringDashpot(stiffness: 1000, damping: 0.5)");
    close(law.gamma_n, 0.5 / MASS);
    assert!(law.limit_damping);
}

/// k_t = q/(1 + q) m12 (arccos(-e_t)/t_c)² (Luding 1998, Eqs. (55)-(57)).
#[test]
fn tangential_restitution_becomes_a_stiffness() {
    let law = classic(
        "normal: LinearSpringDashpot(restitution: 0.8, contact_duration: 1e-4),
         tangential: TangentialSpring(tangential_restitution: 0.6, friction: 0.3), contact_end: Overlap",
    );
    close(law.kt, 0.4 / 1.4 * MASS * ((-0.6_f64).acos() / 1e-4).powi(2));
    assert_eq!((law.gamma_t, law.friction, law.style), (0.0, 0.3, ClassicStyle::HookeHistory));
}

#[test]
fn ratios_to_the_normal_law_are_spelt_out() {
    let laws = "normal: LinearSpringDashpot(stiffness: 1000, damping_rate: 400),
                tangential: TangentialSpring(stiffness_ratio: 0.25, friction: 0.3, damping_ratio: 0.5)";
    let law = classic(laws);
    assert_eq!((law.kt, law.gamma_t), (250.0, 200.0));
    let law = granular(laws);
    assert_eq!(law.tangential, GranularTangential::LinearHistory(250.0));
    assert_eq!((law.tangential_damping, law.damping), (0.5, GranularDamping::MassVelocity(400.0)));
    let (law, materials) = liggghts(laws);
    let normal = LiggghtsNormal::HookeStiffness { kn: 1000.0, kt: 250.0, gamma_n: 400.0, gamma_t: 200.0 };
    assert_eq!((law.normal, materials), (normal, None));
}

#[test]
fn hertz_with_damping_in_proportion_to_the_contact_radius() {
    let laws = "normal: Hertz(stiffness_pressure: 7e7, damping_rate_per_length: 1e6),
                tangential: TangentialSpring(stiffness_pressure: 9e7, damping_rate_per_length: 5e5, friction: 0.5)";
    let law = classic(laws);
    assert_eq!((law.kn, law.kt, law.gamma_n, law.gamma_t), (7e7, 9e7, 1e6, 5e5));
    let law = granular(laws);
    assert_eq!(law.normal, GranularNormal::Hertz(7e7));
    assert_eq!((law.tangential, law.tangential_damping), (GranularTangential::Mindlin(9e7), 0.5));
    let (law, _) = liggghts(laws);
    let normal = LiggghtsNormal::HertzStiffness { kn: 7e7, kt: 9e7, gamma_n: 1e6, gamma_t: 5e5 };
    assert_eq!(law.normal, normal);
}

/// Young's modulus, Poisson's ratio and restitution come back from the effective numbers of a scene.
#[test]
fn hertz_with_one_restitution() {
    let (youngs, poisson, restitution) = (1e7, 0.3, 0.7_f64);
    let b = -restitution.ln() / (PI * PI + restitution.ln().powi(2)).sqrt();
    let shear = youngs / (4.0 * (2.0 - poisson) * (1.0 + poisson));
    let laws = format!(
        "normal: Hertz(youngs_modulus: {youngs:?}, poisson_ratio: {poisson:?}, restitution: {restitution:?}),
         tangential: TangentialSpring(effective_shear_modulus: {shear:?}, damping_coefficient: {:?}, friction: 0.5),
         contact_end: Overlap",
        2.0 * (5.0_f64 / 6.0).sqrt() * b
    );
    let (law, material) = liggghts(&laws);
    let LiggghtsNormal::Hertz { restitution: found } = law.normal else { panic!("{law:?}") };
    close(found, restitution);
    assert!(law.tangential_damping);
    let material = material.unwrap();
    close(material.youngs_modulus, youngs);
    assert!((material.poisson_ratio - poisson).abs() < 1e-13, "{material:?}");

    let law = granular(&laws);
    let GranularDamping::Tsuji(asked) = law.damping else { panic!("{law:?}") };
    // The polynomial has terms of up to 27, so its value carries 27 · 1e-16.
    assert!((tsuji(asked) - 5.0_f64.sqrt() * b).abs() < 1e-14);
    let GranularNormal::Hertz(kn) = law.normal else { panic!("{law:?}") };
    // γ_t/γ_n = sqrt(2/3 k_t/k_n), both dampers as LIGGGHTS has them.
    close(law.tangential_damping, (2.0 / 3.0 * (8.0 * shear / kn)).sqrt());
    let message = refusal(&pair(&laws), Target::LammpsClassic);
    assert!(message.contains("not to its root"), "{message}");

    // Other tangential damping than LIGGGHTS derives.
    let other = laws.replace("damping_coefficient: 0", "damping_coefficient: 1");
    assert_ne!(other, laws);
    assert!(refusal(&pair(&other), Target::Liggghts).contains("derives the tangential damping"), "{other}");
}

#[test]
fn moduli_of_pairs_must_follow_from_their_materials() {
    let mut moduli = Moduli::default();
    // Two materials with compliances 1/E* of 2 and 6, each half of that of its own pair.
    moduli.ask((1, 1), 1.0 / 2.0, Some(1.0 / 10.0));
    moduli.ask((2, 2), 1.0 / 6.0, None);
    moduli.ask((2, 1), 1.0 / 4.0, None);
    // A third one, known through the second alone, and a fourth that meets only itself and a fifth.
    moduli.ask((2, 3), 1.0 / 5.0, None);
    moduli.ask((4, 5), 1.0 / 8.0, None);
    let found = moduli.materials(6).unwrap();
    let compliance =
        |kind: usize| found[kind - 1].map(|m| (1.0 - m.poisson_ratio.powi(2)) / m.youngs_modulus);
    for (kind, expected) in [(1, 1.0), (2, 3.0), (3, 2.0), (4, 4.0), (5, 4.0)] {
        close(compliance(kind).unwrap(), expected);
    }
    // The shear compliance of the first is 5 times as large: r = 2 (2 - ν)/(1 - ν) = 5.
    close(found[0].unwrap().poisson_ratio, 1.0 / 3.0);
    assert!(found[5].is_none());
    moduli.ask((1, 3), 1.0 / 3.1, None);
    assert!(moduli.materials(6).unwrap_err().to_string().contains("materials 1 and 3"));

    let mut soft = Moduli::default();
    soft.ask((1, 1), 1.0, Some(1.0));
    assert!(soft.materials(1).unwrap_err().to_string().contains("Poisson ratio"));
}

#[test]
fn what_no_peer_has_is_refused_with_the_reason() {
    let linear = "normal: LinearSpringDashpot(stiffness: 1000, damping_rate: 100)";
    let spring = "tangential: TangentialSpring(stiffness: 300, damping_rate: 50, friction: 0.5)";
    for (laws, word) in [
        (
            format!("{linear}, tangential: Coulomb(friction: 0.5)"),
            "Coulomb: no engine has this tangential law",
        ),
        (format!("{linear}, tangential: TangentialSpring(stiffness: 300, friction: inf)"), "finite friction"),
    ] {
        for target in Target::ALL {
            let message = refusal(&pair(&laws), target);
            assert!(message.contains(word), "{message}");
        }
    }
    let hertz = "normal: Hertz(effective_modulus: 1e7, damping_coefficient: 1.5)";
    assert!(refusal(&pair(hertz), Target::LammpsGranular).contains("`tsuji` reaches"));
    let mixed = format!("normal: Hertz(stiffness_pressure: 7e7, damping_rate_per_length: 1e6), {spring}");
    assert!(refusal(&pair(&mixed), Target::LammpsClassic).contains("grows with the contact radius"));

    let laws = format!("(between: (\"a\", \"a\"), {linear}, {spring})");
    let ball = "Sphere(material: \"a\", radius: 1e-3, mass: 1e-3, position: (0, 0, 0)),";
    let materials = "materials: { \"a\": () },";
    let wall = |wall: &str| format!("walls: {{ \"w\": {wall} }},");
    for (bodies, more, word) in [
        (
            "HollowSphere(material: \"a\", radius: 1e-3, mass: 1e-3, position: (0, 0, 0)),",
            String::new(),
            "body 1: ",
        ),
        (
            ball,
            wall("Cylinder(point: (0, 0, 0), radius: 1e-2, material: \"a\")"),
            "wall `w`: the peers are told planes only",
        ),
        (
            ball,
            wall("Plane(point: (0, 0, -1e-2), normal: (1, 0, 1), material: \"a\")"),
            "wall `w`: the planes of the peers are perpendicular",
        ),
        (
            ball,
            wall(
                "Plane(point: (0, 0, -1e-2), normal: (0, 0, 1), material: \"a\",
                 motion: Sinusoidal(amplitude: (1e-4, 0, 0), angular_frequency: 10))",
            ),
            "wall `w`: the peers' walls move with a constant velocity",
        ),
        (
            ball,
            wall(
                "Plane(point: (0, 0, -1e-2), normal: (0, 0, 1), material: \"a\",
                 motion: Constant(velocity: (0, 0, 1e-3)))",
            ),
            "wall `w`: the peers' walls slide",
        ),
    ] {
        let message = refusal(&scene(materials, bodies, &laws, &more), Target::Liggghts);
        assert!(message.contains(word), "{message}");
    }
}

/// One restitution for several masses is a law per pair, which only the classic numbers of one mass can stand for.
#[test]
fn one_restitution_for_several_masses_is_refused() {
    let plan = scene(
        "materials: { \"a\": () },",
        "Sphere(material: \"a\", radius: 1e-3, mass: 1e-3, position: (0, 0, 0)),
         Sphere(material: \"a\", radius: 1e-3, mass: 2e-3, position: (2.1e-3, 0, 0)),
         Sphere(material: \"a\", radius: 1e-3, mass: 2e-3, position: (4.2e-3, 0, 0)),",
        "(between: (\"a\", \"a\"), normal: LinearSpringDashpot(stiffness: 1000, restitution: 0.8))",
        "",
    );
    for target in Target::ALL {
        assert!(refusal(&plan, target).contains("reduced masses from"));
    }
}

#[test]
fn bodies_keep_mass_and_place_and_get_a_box() {
    let scene = translate(
        &pair("normal: LinearSpringDashpot(stiffness: 1000, damping_rate: 100)"),
        Target::LammpsClassic,
    )
    .unwrap();
    for body in &scene.bodies {
        close(body.mass(), 1e-3);
        for axis in 0..3 {
            assert!(scene.lower[axis] < body.position[axis] && body.position[axis] < scene.upper[axis]);
        }
    }
    assert_eq!(scene.bodies[1].position, [2.1e-3, 0.0, 0.0]);
    assert_eq!(density(4.0 * PI / 3.0 * 1e-3 * 1e-3 * 1e-3 * 2500.0, 1e-3), 2500.0);
}

/// LIGGGHTS derives the stiffness of loading from a modulus at a characteristic velocity of 1 m/s:
/// k = 16/15 sqrt(R*) E* (15 m12 V²/(16 sqrt(R*) E*))^(1/5).
#[test]
fn hysteretic_contacts_get_the_modulus_of_their_stiffness() {
    let laws = "normal: WaltonBraun(loading_stiffness: 1000, largest_unloading_stiffness: 4000, plasticity_depth: 0.05)";
    let (law, material) = liggghts(laws);
    assert_eq!(law.normal, LiggghtsNormal::HookeHysteresis { ratio: 4.0, depth: 0.05 });
    let material = material.unwrap();
    let effective = material.youngs_modulus / (2.0 * (1.0 - material.poisson_ratio * material.poisson_ratio));
    let (mass, root): (f64, f64) = (5e-4, f64::sqrt(5e-4));
    let stiffness = 16.0 / 15.0 * root * effective * (15.0 * mass / (16.0 * root * effective)).powf(0.2);
    // Two fractional powers.
    assert!((stiffness / 1000.0 - 1.0).abs() < 1e-14, "{stiffness}");
    let constant = pair("normal: WaltonBraun(loading_stiffness: 1000, restitution: 0.6)");
    assert!(refusal(&constant, Target::Liggghts).contains("here it is constant"));
    assert!(refusal(&pair(laws), Target::LammpsGranular).contains("no hysteretic normal law"));
    let ratio = format!("{laws}, tangential: TangentialSpring(stiffness_ratio: 0.5, friction: 0.5)");
    assert!(refusal(&pair(&ratio), Target::Liggghts).contains("has the stiffness of loading"));
}
