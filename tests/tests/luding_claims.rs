//! Claims of Luding 1998, Sec. 8, measured.

use granule_reference::Collision;
use granule_tests::plan;

/// Row L75: a constant e_n instead of that of an impact whose damping is linear in the speed under a Hertz force. Taken at
/// 0.3 m/s, it errs by the slow change of 1 - e_n with v^(-1/5) (Luding 1998, Eq. (42)).
#[test]
fn error_of_a_constant_restitution() {
    let restitution = |speed: f64| {
        let plan = plan(&format!(
            r#"(version: 1, materials: {{ "a": (density: 1000) }},
            bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01), velocity: (0, 0, -{speed}))],
            walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
            contacts: [(between: ("a", "a"), contact_end: Overlap,
                normal: PowerLaw(modulus: 1e7, exponent: 0.5, damping: 0.3))],
            run: (duration: "1 ms"))"#
        ));
        let (collision, composition) = Collision::of_plan(&plan).unwrap();
        collision.hard_limit().run(composition).unwrap().restitution
    };
    let at = restitution(0.3);
    assert!((0.9..0.999).contains(&at), "{at}");
    let mut last: f64 = 0.0;
    for factor in [1.25, 2.0, 4.0, 10.0] {
        let error = (restitution(0.3 * factor) - at).abs().max((restitution(0.3 / factor) - at).abs());
        // 1 - e_n changes by the factor^(1/5), at most.
        let bound = (1.0 - at) * (f64::powf(factor, 0.2) - 1.0);
        assert!(error > last && (0.8 * bound..1.1 * bound).contains(&error), "{factor}: {error} {bound}");
        last = error;
    }
}
