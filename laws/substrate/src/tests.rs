use proptest::prelude::*;

use super::*;

fn law(given: &[(&str, f64)], table: &[(f64, f64)]) -> Box<dyn SubstrateStage> {
    let params = StickSlip::INFO.params(given).unwrap();
    StickSlip::compile(&params, &SubstrateContext { rolling_friction: table }).unwrap()
}

fn ask(law: &dyn SubstrateStage, contact: SubstrateContact) -> SubstrateContact {
    let mut contacts = [contact];
    law.run(&mut contacts);
    contacts[0]
}

const SPHERE: SubstrateContact = SubstrateContact {
    mass: 2.0,
    radius: 0.5,
    inertia_number: 2.5,
    normal_impulse: 10.0,
    slip_before: [0.0; 2],
    slip: [0.0; 2],
    rolling_before: [0.0; 2],
    rolling: [0.0; 2],
    drilling: 0.0,
    footing: Footing::Rolling,
    impulse: [0.0; 2],
    couple: [0.0; 2],
    drilling_impulse: 0.0,
};

const DIFFERENT: &[(&str, f64)] = &[("static_friction", 0.5), ("kinetic_friction", 0.1)];

#[test]
fn static_friction_holds_up_to_its_own_limit_and_kinetic_friction_after_it() {
    let law = law(DIFFERENT, &[]);
    // Stopping a slip u takes u m/(1 + Q) = u 2/3.5; the limits are 5 and 1 N s.
    let limit = 5.0 * 3.5 / 2.0;
    let below = ask(&*law, SubstrateContact { slip: [0.999 * limit, 0.0], ..SPHERE });
    assert_eq!(below.footing, Footing::Rolling);
    assert!((below.impulse[0] + 0.999 * 5.0).abs() < 1e-14);
    let above = ask(&*law, SubstrateContact { slip: [1.001 * limit, 0.0], ..SPHERE });
    assert_eq!(above.footing, Footing::Sliding);
    assert!((above.impulse[0] + 1.0).abs() < 1e-14);
    // What slips already is held by kinetic friction alone: it stops only when its slip is within that reach.
    let slip_before = [1.0, 0.0];
    let moving = SubstrateContact { footing: Footing::Sliding, slip_before, ..SPHERE };
    let slips = ask(&*law, SubstrateContact { slip: [0.3 * limit, 0.0], ..moving });
    assert_eq!(slips.footing, Footing::Sliding);
    let stops = ask(&*law, SubstrateContact { slip: [0.19 * limit, 0.0], ..moving });
    assert_eq!(stops.footing, Footing::Rolling);
    assert!((stops.slip[0] + 3.5 / 2.0 * stops.impulse[0]).abs() < 1e-14);
}

#[test]
fn the_limit_is_that_of_the_surface_and_not_of_the_collision() {
    // Erratum K-E18: a body that a collision presses up feels less friction, however strong the collision.
    let law = law(DIFFERENT, &[]);
    let light = SubstrateContact { normal_impulse: 0.1, slip: [1.0, 0.0], ..SPHERE };
    assert_eq!(ask(&*law, light).footing, Footing::Sliding);
    let lifted = SubstrateContact { normal_impulse: 0.0, slip: [1.0, 0.0], ..SPHERE };
    let lifted = ask(&*law, lifted);
    assert_eq!((lifted.footing, lifted.impulse), (Footing::Sliding, [0.0, 0.0]));
}

#[test]
fn an_infinitely_rough_surface_never_lets_slip_and_carries_nothing_without_weight() {
    let law = law(&[("friction", f64::INFINITY)], &[]);
    let held = ask(&*law, SubstrateContact { slip: [1e6, -2.0], footing: Footing::Unknown, ..SPHERE });
    assert_eq!(held.footing, Footing::Rolling);
    let free = ask(&*law, SubstrateContact { normal_impulse: 0.0, slip: [1.0, 0.0], ..SPHERE });
    assert_eq!(free.impulse, [0.0; 2]);
}

#[test]
fn a_table_of_rolling_friction_is_straight_between_its_rows() {
    let table = [(0.1, 1e-3), (0.2, 3e-3)];
    let law = law(&[("friction", 1.0)], &table);
    for (speed, expected) in [(0.05, 1e-3), (0.15, 2e-3), (0.2, 3e-3), (7.0, 3e-3)] {
        let rolling = [speed, 0.0];
        // A small weight, so that the speed hardly changes: by 1e-9 of it.
        let contact = SubstrateContact { normal_impulse: 1e-7, rolling_before: rolling, rolling, ..SPHERE };
        let answer = ask(&*law, contact);
        assert!((answer.impulse[0] / (-expected * 1e-7) - 1.0).abs() < 1e-6, "{speed}: {answer:?}");
        // Speed and spin go down together: s changes by Q (J + P)/m = -J/m.
        let turned = 2.5 * (answer.impulse[0] + answer.couple[0]) / 2.0;
        assert!((turned + answer.impulse[0] / 2.0).abs() < 1e-22);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let params = |given: &[(&str, f64)]| StickSlip::INFO.params(given);
    assert!(params(&[("static_friction", 0.5)]).is_err());
    assert!(params(&[("friction", -1.0)]).is_err());
    let compile = |given: &[(&str, f64)], table: &[(f64, f64)]| {
        let params = params(given).unwrap();
        StickSlip::compile(&params, &SubstrateContext { rolling_friction: table }).err()
    };
    let error = compile(&[("static_friction", 0.1), ("kinetic_friction", 0.5)], &[]).unwrap();
    assert_eq!(error.parameter.as_deref(), Some("kinetic_friction"));
    assert!(compile(&[("friction", 0.1), ("rolling_friction", 0.1)], &[(0.0, 1e-3)]).is_some());
    assert!(compile(&[("friction", 0.1)], &[(1.0, 1e-3), (0.5, 1e-3)]).is_some());
    assert!(compile(&[("friction", 0.1)], &[(0.0, -1.0)]).is_some());
    assert!(compile(&[("friction", 0.1)], &[(0.0, 1e-3), (0.5, 2e-3)]).is_none());
}

proptest! {
    #[test]
    fn friction_stays_within_its_limit_and_never_gives_energy(
        slip in prop::array::uniform2(-1.0f64..1.0),
        turn in prop::array::uniform2(-1e-2f64..1e-2),
        rolling in prop::array::uniform2(-1.0f64..1.0),
        drilling in -10.0f64..10.0,
        normal in 0.0f64..1.0,
        static_friction in 0.0f64..1.0,
        share in 0.0f64..1.0,
        rolling_friction in 0.0f64..0.1,
        state in 0u8..4,
    ) {
        let kinetic = share * static_friction;
        let law = law(
            &[
                ("static_friction", static_friction),
                ("kinetic_friction", kinetic),
                ("rolling_friction", rolling_friction),
                ("drilling_friction", 0.1),
            ],
            &[],
        );
        let footing = match state {
            0 => Footing::Sliding,
            1 => Footing::Rolling,
            2 => Footing::Resting,
            _ => Footing::Unknown,
        };
        let held = footing == Footing::Rolling || footing == Footing::Resting;
        let slip_before = if held { [0.0; 2] } else { [slip[0] - turn[0], slip[1] - turn[1]] };
        let slip = if held { turn } else { slip };
        let contact = SubstrateContact {
            normal_impulse: normal, slip_before, slip, rolling_before: rolling, rolling, drilling, footing, ..SPHERE
        };
        let c = ask(&*law, contact);
        let size = norm(c.impulse);
        prop_assert!(size <= static_friction * normal * (1.0 + 1e-12) + 1e-300);
        if c.footing == Footing::Sliding {
            prop_assert!((size - kinetic * normal).abs() <= 1e-12 * normal || norm(slip) == 0.0);
        }
        // After the answer: kinetic energy with respect to the surface, as the free motion had it, does not grow.
        let energy = |j: [f64; 2], p: [f64; 2]| {
            let (m, q) = (c.mass, c.inertia_number);
            (0..2).map(|k| {
                let w = rolling[k] + j[k] / m;
                let s = (slip[k] - rolling[k]) + q * (j[k] + p[k]) / m;
                0.5 * m * (w * w + s * s / q)
            }).sum::<f64>()
        };
        prop_assert!(energy(c.impulse, c.couple) <= energy([0.0; 2], [0.0; 2]) * (1.0 + 1e-12) + 1e-9 * norm(turn));
        let moment = c.mass * c.radius * c.radius / c.inertia_number;
        let spin = drilling + c.drilling_impulse / moment;
        // A stop is a division of the impulse by the moment, with the rounding of three operations.
        let round_off = 4.0 * f64::EPSILON;
        prop_assert!(spin * drilling >= -round_off * drilling * drilling);
        prop_assert!(spin.abs() <= drilling.abs() * (1.0 + round_off));
    }
}
