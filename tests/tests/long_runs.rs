//! Energy over very many elastic contacts: what one contact adds, and how it adds up.

use granule_drivers::Driver;
use granule_tests::{advance, driver_with};

/// Rows of single spheres that bounce to and fro between two walls, each at its own speed: 50 steps in a contact, some 10 to 30 in
/// a flight.
const BODIES: usize = 64;
const RADIUS: f64 = 1e-3;
/// Room between sphere and wall, both sides together \[m\].
const GAP: f64 = 5e-5;
const CONTACT: f64 = 1e-3;
const STEP: f64 = CONTACT / 50.0;

fn speed(k: usize) -> f64 {
    // Golden ratio: every phase of the step at which contacts begin occurs.
    0.1 + 0.1 * (k as f64 * 0.618_033_988_749_894_9).fract()
}

fn scene(scheme: &str, law: &str) -> String {
    let bodies: String = (0..BODIES)
        .map(|k| {
            let y = 3.0 * RADIUS * k as f64;
            format!(
                "Sphere(material: \"a\", radius: {RADIUS}, position: ({}, {y}, 0), velocity: ({}, 0, 0)),",
                RADIUS + 0.3 * GAP,
                speed(k)
            )
        })
        .collect();
    format!(
        "(version: 1, materials: {{ \"a\": (density: 2500) }}, impact_speed: 0.15, bodies: [{bodies}],
        walls: {{
            \"left\": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: \"a\"),
            \"right\": Plane(point: ({}, 0, 0), normal: (-1, 0, 0), material: \"a\"),
        }},
        contacts: [(between: (\"a\", \"a\"), normal: {law})],
        driver: TimeStep(integrator: {scheme}, step: {STEP}), run: (steps: 1000000000), ledger: true)",
        2.0 * RADIUS + GAP
    )
}

/// Energies after about `contacts` contacts over those at the start: the largest deviation of a body, and that of all together.
fn drift(scheme: &str, law: &str, contacts: f64) -> (f64, f64) {
    let mut driver = driver_with(&scene(scheme, law), 1);
    let round = CONTACT + GAP / 0.15;
    let steps = (contacts / BODIES as f64 * round / STEP) as u64;
    advance(&mut driver, steps);
    // Bodies in contact store a part of their energy: each is looked at when it is free.
    let mut energy = [f64::NAN; BODIES];
    for step in steps..steps + 200 {
        advance(&mut driver, step);
        let view = driver.view();
        let touching: Vec<u32> = view.contacts().iter().map(|contact| contact.id).collect();
        for (k, energy) in energy.iter_mut().enumerate() {
            let place = view.order()[k] as usize;
            if energy.is_nan() && !touching.contains(&view.bodies().id[place]) {
                *energy = view.bodies().velocity_of(place)[0].powi(2);
            }
        }
    }
    let ratio = |k: usize| energy[k] / speed(k).powi(2) - 1.0;
    let largest = (0..BODIES).map(|k| ratio(k).abs()).fold(0.0, f64::max);
    let all = energy.iter().sum::<f64>() / (0..BODIES).map(|k| speed(k).powi(2)).sum::<f64>() - 1.0;
    println!("{contacts:.0e} contacts, {scheme}, {law}: largest {largest:.2e}, all {all:.2e}");
    (largest, all)
}

const LINEAR: &str = "LinearSpringDashpot(contact_duration: 1e-3, restitution: 1)";
/// Contacts at 0.15 m/s last as long as those of the spring.
const HERTZ: &str = "Hertz(effective_modulus: 3.8e5, restitution: 1)";

/// ω Δt of the spring: half a turn takes 50 steps.
const TURN: f64 = std::f64::consts::PI / 50.0;

/// Velocity Verlet is symplectic, and a sphere between two springs has one degree of freedom: its energy stays within a band,
/// however many contacts there are. The trapezoid misses up to (ω Δt)²/8 of the speed where a contact begins, and as much where
/// it ends, which is (ω Δt)²/2 of the energy; the band may be as wide as two of them. Spheres at phases of their own differ in
/// sign: the sum of 64 deviates by less than three standard deviations of a mean.
fn within_its_band(law: &str, contacts: f64) {
    let (largest, all) = drift("VelocityVerlet", law, contacts);
    let band = TURN.powi(2);
    assert!(largest < band, "{law}: {largest}");
    assert!(all.abs() < 3.0 * band / (BODIES as f64).sqrt(), "{law}: {all}");
}

#[test]
fn elastic_contacts_keep_their_energy() {
    within_its_band(LINEAR, 1e4);
    within_its_band(HERTZ, 1e4);
}

#[test]
#[ignore = "slow: 10^7 contacts"]
fn ten_million_linear_contacts_keep_their_energy() {
    within_its_band(LINEAR, 1e7);
}

#[test]
#[ignore = "slow: 10^7 contacts"]
fn ten_million_hertz_contacts_keep_their_energy() {
    within_its_band(HERTZ, 1e7);
}

/// `ContactResolved` gives an impulse but no displacement where a contact begins, of v (ω τ)³/(6 ω) after a part τ of the step: each
/// contact loses about (ω τ)⁴/3 of its energy, less (ω τ)⁴/12 as the force of the path without that displacement is larger.
/// The mean over all τ is (ω Δt)⁴/20. Velocity Verlet has errors a hundred times as large in a single contact, but they do not add up.
#[test]
fn resolved_elastic_contacts_lose_a_fourth_power_of_the_step() {
    let contacts = 1e5;
    let (_, all) = drift("ContactResolved", LINEAR, contacts);
    let each = -all / (contacts / BODIES as f64);
    assert!(each > 0.0 && each < TURN.powi(4) / 20.0, "{each}");
}
