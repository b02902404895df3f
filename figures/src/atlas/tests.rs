use granule_law_api::{Registry, Slot};
use granule_plan::FEWEST_STEPS;

use super::*;

/// A law that is not in the atlas would have no limits that were looked at.
#[test]
fn every_shipped_law_is_in_the_atlas() {
    let registry = Registry::collect().unwrap();
    for law in registry.entries() {
        let known = match law.info.slot {
            Slot::Normal => NORMAL.iter().any(|other| other.name == law.info.name),
            Slot::Tangential => TANGENTIAL.iter().any(|other| other.name == law.info.name),
            _ => true,
        };
        assert!(known, "{} is not in the atlas", law.info.name);
    }
}

/// Against the frequencies of the lattices: √2 and 2 times the steps of a pair, which needs π/2.
#[test]
fn limits_of_chain_and_block_are_those_of_their_fastest_modes() {
    for (coordination, factor) in [(Coordination::Chain, 2f64.sqrt()), (Coordination::Block, 2.0)] {
        let limit = limit(&NORMAL[0], SCHEMES[0], 0.0, coordination).unwrap();
        let expected = factor * std::f64::consts::FRAC_PI_2;
        // The bisection stops at 1 %; the pressed bonds across the motion soften the modes by the overlap over the distance.
        assert!((limit.measured / expected - 1.0).abs() < 0.04, "{limit:?} {expected}");
        assert!((limit.pair / std::f64::consts::FRAC_PI_2 - 1.0).abs() < 1e-6, "{limit:?}");
    }
}

/// A plan refuses every step at which a block is unstable, for every law and integrator, and not many more.
#[test]
#[ignore = "slow: a bisection for each law and integrator"]
fn the_limit_of_a_packing_is_safe_and_tight() {
    for law in NORMAL {
        for scheme in SCHEMES {
            for damping in [0.0, 0.3] {
                let limit = limit(law, scheme, damping, Coordination::Block).unwrap();
                assert!(limit.measured < 1.01 * limit.packing, "{limit:?}");
                assert!(limit.measured > 0.5 * limit.packing, "{limit:?}");
            }
        }
    }
}

/// What the plan allows for a pair never gains energy in the first place, and at the usual number of steps all is right.
#[test]
fn usual_steps_are_stable_for_every_law() {
    for law in NORMAL {
        let map = steps_and_damping(law, SCHEMES[0], true).unwrap();
        let at = map.x.1.iter().position(|steps| *steps == 50.0).unwrap();
        for row in &map.cells {
            assert!(row[at..].iter().all(|class| *class == Class::Stable), "{map:?}");
        }
    }
}

/// Friction that stops at rest does so under every integrator, however large its coefficient.
#[test]
fn no_friction_gains_energy() {
    for law in TANGENTIAL {
        for scheme in SCHEMES {
            let map = oblique::friction_and_angle(law, scheme, false).unwrap();
            assert!(map.cells.iter().flatten().all(|class| *class == Class::Stable), "{map:?}");
        }
    }
}

/// The warning of a plan comes from the maps of single contacts, and so does the map that it names.
#[test]
#[ignore = "slow: 2000 impacts a law"]
fn a_plan_warns_wherever_a_restitution_is_wrong() {
    let needed = NORMAL.iter().map(|law| needed_steps(law).unwrap()).fold(0.0, f64::max);
    assert!(needed <= FEWEST_STEPS && needed > FEWEST_STEPS - 3.0, "{needed}");
}

/// "You are here": an unstable step is told with a map that exists, its place in it and the limit there.
#[test]
fn a_refused_step_is_told_its_place_in_a_map() {
    let law = &NORMAL[0];
    let map = steps_and_damping(law, SCHEMES[0], true).unwrap();
    let text = r#"(version: 1, materials: { "a": () }, impact_speed: 1, bodies: [
        Sphere(material: "a", radius: 0.01, mass: 0.01, position: (0, 0, 0)),
        Sphere(material: "a", radius: 0.01, mass: 0.01, position: (0.021, 0, 0))],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, damping: 0))],
        driver: TimeStep(step: 1e-3), run: (steps: 1))"#;
    let told = crate::simulate::owned_plan(text).err().unwrap().to_string();
    // A contact takes pi sqrt(0.005/1e5) s = 0.702 ms; a pair needs pi/2 steps in it.
    let here = format!(
        "docs/atlas.md, map {}, 0.70 steps per contact at a damping ratio of 0.00, where 1.57",
        map.name
    );
    assert!(told.contains(&here), "{told}");
}

#[test]
fn values_find_their_columns() {
    assert_eq!(column(&[1.0, 10.0, 100.0], 10.0), 1.5);
    assert_eq!(column(&[1.0, 10.0], 0.5), 0.0);
    assert_eq!(column(&[1.0, 10.0], 20.0), 2.0);
    assert_eq!([short(0.05), short(1e6), short(12.5), short(0.0)], ["0.05", "1e6", "12.5", "0"]);
}
