use super::*;
use crate::load_text;

fn checks(contact: &str, speed: Option<f64>) -> Vec<LawCheck> {
    let scene = format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, impact_speed: 0.5,
        bodies: [
            Sphere(material: "a", radius: "1 mm", position: (0, 0, 0), velocity: (0.5, 0, 0)),
            Sphere(material: "a", radius: "2 mm", position: ("3.1 mm", 0, 0)),
        ],
        contacts: [(between: ("a", "a"), {contact})], run: (duration: "1 ms"))"#
    );
    let loaded = load_text(std::path::Path::new("pair.ron"), scene).unwrap();
    law_check(&loaded.plan, speed)
}

/// What is asked for is realised by every law that takes a restitution, under both ends of contact, overdamped contacts
/// included (errata L-E5 to L-E7), with a tangential restitution where the duration has a closed form.
#[test]
fn what_is_asked_for_is_realised() {
    for end in ["Force", "Overlap"] {
        for (normal, e, duration) in [
            ("LinearSpringDashpot(restitution: 0.9, contact_duration: 1e-4)", 0.9, Some(1e-4)),
            ("LinearSpringDashpot(restitution: 0.05, contact_duration: 1e-4)", 0.05, Some(1e-4)),
            ("WaltonBraun(restitution: 0.6, contact_duration: 1e-4)", 0.6, Some(1e-4)),
            ("LinearSpringDashpot(stiffness: 1e5, restitution: 0.6)", 0.6, None),
            ("WaltonBraun(loading_stiffness: 1e5, restitution: 0.7)", 0.7, None),
        ] {
            let contact = format!(
                "normal: {normal}, tangential: TangentialSpring(tangential_restitution: 0.5, friction: inf), contact_end: {end}"
            );
            let found = &checks(&contact, None)[0];
            assert_eq!(found.requested.restitution, Some(e));
            assert_eq!(found.requested.duration, duration);
            let near = |value: Option<f64>, expected: f64| {
                // The integration agrees in the sixth digit when the step is halved.
                assert!((value.unwrap() / expected - 1.0).abs() < 2e-5, "{contact}: {found:?}");
            };
            near(found.realised.restitution, e);
            near(found.realised.tangential_restitution, 0.5);
            if let Some(duration) = duration {
                near(found.realised.duration, duration);
            }
        }
        for (normal, e) in [
            ("Hertz(effective_modulus: 5e7, restitution: 0.8)", 0.8),
            ("PowerLaw(modulus: 3e7, exponent: 1, restitution: 0.6)", 0.6),
        ] {
            let found = &checks(&format!("normal: {normal}, contact_end: {end}"), Some(0.03))[0];
            assert!((found.realised.restitution.unwrap() / e - 1.0).abs() < 2e-5, "{normal}: {found:?}");
            assert!((found.realised.tangential_restitution.unwrap() + 1.0).abs() < 1e-12);
        }
    }
}

/// The numbers agree with the closed forms that the laws give of themselves, at the extremes of masses.
#[test]
fn realised_values_are_those_of_the_closed_forms() {
    let found = checks("normal: LinearSpringDashpot(stiffness: 1e5, damping: 3), contact_end: Force", None);
    for check in &found {
        let omega = (1e5 / check.impact.reduced_mass).sqrt();
        let ratio = 3.0 / (2.0 * (1e5 * check.impact.reduced_mass).sqrt());
        let oscillator = granule_law_api::oscillator::restitution(ratio, ContactEnd::Force);
        assert!((check.realised.restitution.unwrap() / oscillator - 1.0).abs() < 2e-5, "{check:?}");
        let overlap = 0.5 / omega * granule_law_api::oscillator::largest_overlap(ratio);
        assert!((check.realised.maximum_overlap.unwrap() / overlap - 1.0).abs() < 2e-5, "{check:?}");
        assert_eq!(check.requested.restitution, None);
    }
}

/// A restitution that belongs to one speed is not asked for at another.
#[test]
fn speeds_count() {
    let contact = "normal: Viscoelastic(effective_modulus: 5e7, restitution: 0.8, reference_speed: 0.5), contact_end: Force";
    let same = &checks(contact, None)[0];
    assert_eq!((same.requested.restitution, same.requested_at), (Some(0.8), Some(0.5)));
    assert!((same.realised.restitution.unwrap() - 0.8).abs() < 2e-5, "{same:?}");
    let slower = &checks(contact, Some(0.05))[0];
    assert_eq!(slower.requested.restitution, None);
    assert!(slower.realised.restitution.unwrap() > 0.85, "{slower:?}");
}
