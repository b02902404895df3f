//! Luding 1998, Fig. 6: the loop of force and overlap, and what the contact remembers.

use super::{ContactLaw, Led, Params, WaltonBraun, context};
use granule_law_api::ContactEnd;

const K1: f64 = 1e4;
const K2: f64 = 2.5e4;
const VALUES: [(&str, f64); 2] = [("loading_stiffness", K1), ("unloading_stiffness", K2)];
const LARGEST: f64 = 1e-4;
/// (1 - k_1/k_2) δ_max.
const PLASTIC: f64 = 0.6e-4;

fn close(found: f64, expected: f64) {
    // A handful of operations on forces of 1 N.
    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
}

#[test]
fn loads_unloads_and_reloads_along_the_lines_of_figure_6() {
    let mut led = Led::new(&VALUES);
    for share in [0.2, 0.7, 1.0] {
        close(led.force(share * LARGEST, 1.0), K1 * share * LARGEST);
    }
    for overlap in [0.9e-4, 0.7e-4] {
        close(led.force(overlap, -1.0), K2 * (overlap - PLASTIC));
    }
    // Reloading follows the same line back up to δ_max, and from there k_1.
    for overlap in [0.8e-4, 0.95e-4] {
        close(led.force(overlap, 1.0), K2 * (overlap - PLASTIC));
    }
    close(led.force(1.2e-4, 1.0), K1 * 1.2e-4);
    close(led.force(1.1e-4, -1.0), K2 * (1.1e-4 - 0.6 * 1.2e-4));
}

/// Erratum L-E25: a contact that opened to δ' < δ_0 without force and closes again is felt at once, along k_2 (δ - δ').
/// Eq. (45) alone would have it free up to δ_0.
#[test]
fn reload_of_a_contact_without_force_begins_where_it_turned() {
    let mut led = Led::new(&VALUES);
    led.force(LARGEST, 1.0);
    for overlap in [0.5e-4, 0.4e-4, 0.3e-4] {
        assert_eq!(led.force(overlap, -1.0), 0.0);
    }
    let printed = (K2 * (0.35e-4 - PLASTIC)).max(0.0);
    let found = led.force(0.35e-4, 1.0);
    close(found, K2 * 0.05e-4);
    assert!(printed == 0.0 && found > 0.1);
    // The line k_2 (δ - δ') meets k_1 δ at δ' k_2/(k_2 - k_1) = 0.5e-4.
    close(led.force(0.5e-4, 1.0), K1 * 0.5e-4);
    close(led.force(0.6e-4, 1.0), K1 * 0.6e-4);
}

/// The memory stays while an overlap is left, force or not, and goes with it.
#[test]
fn memory_goes_when_the_overlap_vanishes() {
    let mut led = Led::new(&VALUES);
    led.force(LARGEST, 1.0);
    led.force(0.1e-4, -1.0);
    assert!(led.contact.history[0][0] > 0.0);
    led.force(0.0, -1.0);
    assert_eq!(led.contact.history[0][0], 0.0);
    close(led.force(0.2e-4, 1.0), K1 * 0.2e-4);
}

/// The loss of a loop is its area: along both lines, with a reload in between, for constant and for growing k_2.
#[test]
fn loss_is_the_area_of_the_loop() {
    let growing =
        [("loading_stiffness", K1), ("largest_unloading_stiffness", K2), ("plasticity_depth", 0.008)];
    for values in [&VALUES[..], &growing[..]] {
        for steps in [2000, 4000] {
            let mut led = Led::new(values);
            let (mut area, mut lost, mut last) = (0.0, 0.0, (0.0, 0.0, 0.0));
            let path = [(0.0, 0.8), (0.8, 0.5), (0.5, 1.0), (1.0, 0.2), (0.2, 0.9), (0.9, 0.0)];
            for (from, to) in path {
                for index in 1..=steps {
                    let share = f64::from(index) / f64::from(steps);
                    let overlap = LARGEST * (from + (to - from) * share);
                    let velocity = LARGEST * (to - from) / f64::from(steps);
                    let force = led.force(overlap, velocity);
                    let power = led.contact.viscous[0];
                    area += 0.5 * (force + last.0) * (overlap - last.1);
                    lost += 0.5 * (power + last.2);
                    last = (force, overlap, power);
                }
            }
            // Everything is released at the end. The trapezoidal rule errs by half a step's share where a branch ends or begins,
            // eight times here.
            let error = 4.0 / f64::from(steps);
            assert!(area > 0.0 && (lost / area - 1.0).abs() < error, "{values:?} {steps}: {lost} {area}");
            assert_eq!(led.contact.elastic[0], 0.0);
        }
    }
}

#[test]
fn stiffness_that_would_create_energy_is_refused() {
    let pair = context(ContactEnd::Force, 1.0);
    for (values, message) in [
        (
            &[("loading_stiffness", 2e4), ("unloading_stiffness", 1e4)][..],
            "unloading_stiffness: 10000 N/m is not more",
        ),
        (
            &[("loading_stiffness", 1e4), ("largest_unloading_stiffness", 1e4), ("plasticity_depth", 0.1)][..],
            "largest_unloading_stiffness: 10000 N/m is not more",
        ),
    ] {
        let params = Params::new(&WaltonBraun::INFO, values).unwrap();
        let error = WaltonBraun::compile::<f64>(&params, &pair).err().unwrap().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}
