//! Janssen: in a tall silo the walls carry the weight.

use granule_drivers::{ContactPartner, Driver, TimeStepDriver};
use granule_tests::{advance, driver_with};

use super::support::DENSITY;

/// Diameter of the silo in diameters of a sphere.
const WIDTH: f64 = 10.0;
const STIFFNESS: f64 = 2e4;
const TANGENTIAL: f64 = 2.0 / 7.0 * STIFFNESS;
const FRICTION: f64 = 0.5;
/// Enough to fill it six times as high as wide.
const COUNT: usize = 5100;
/// Time until the poured spheres rest, then in which the floor sinks by a diameter (so that friction at the wall is mobilised
/// as far as it goes, as in the experiments), and until all is at rest again.
const TIMES: [f64; 3] = [40.0, 30.0, 10.0];
const STEP: f64 = 7e-4;

fn silo(seed: u64) -> TimeStepDriver {
    let half = 0.5 * WIDTH;
    let [rest, sunk] = [TIMES[0], TIMES[0] + TIMES[1]];
    let steps = (TIMES.iter().sum::<f64>() / STEP).round() as u64;
    let mut driver = driver_with(
        &format!(
            r#"(version: 1, seed: {seed}, gravity: (0, 0, -1), materials: {{ "a": (density: {DENSITY:?}) }},
            cell: (lo: (-{half}, -{half}, -3), hi: ({half}, {half}, 170), periodic: (false, false, false)),
            bodies: [Fill(material: "a", radius: 0.5, count: {COUNT}, lo: (-{half}, -{half}, 0), hi: ({half}, {half}, 160))],
            walls: {{
                "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
                    motion: Table([({rest}, (0, 0, 0)), ({sunk}, (0, 0, -1))])),
                "wall": Cylinder(point: (0, 0, 0), axis: (0, 0, 1), radius: {half}, material: "a"),
            }},
            contacts: [(between: ("a", "a"), contact_end: Overlap,
                normal: LinearSpringDashpot(stiffness: {STIFFNESS}, damping_rate: 100),
                tangential: TangentialSpring(stiffness: {TANGENTIAL:?}, damping_rate: 50, friction: {FRICTION}))],
            driver: TimeStep(step: {STEP}, packing_limit: false), run: (steps: {steps}))"#
        ),
        1,
    );
    advance(&mut driver, steps);
    driver
}

/// Vertical forces of the walls on the bodies: height of the contact, force; and the sum on the floor.
fn wall_forces(driver: &TimeStepDriver) -> (Vec<(f64, f64)>, f64) {
    let view = driver.view();
    let rows = view.bodies();
    let mut place_of = vec![0_usize; rows.len() + 1];
    for (place, id) in rows.id.iter().enumerate() {
        place_of[*id as usize] = place;
    }
    let floor = view.plan().walls.iter().position(|wall| wall.name == "floor").expect("a floor");
    let (mut friction, mut on_floor) = (Vec::new(), 0.0);
    for contact in view.contacts() {
        let ContactPartner::Wall(wall) = contact.partner else { continue };
        if wall as usize == floor {
            on_floor += STIFFNESS * contact.overlap;
        } else {
            // At rest the spring is all of the tangential force.
            let height = rows.position[place_of[contact.id as usize]][2];
            friction.push((height, -TANGENTIAL * contact.history[2]));
        }
    }
    (friction, on_floor)
}

/// What one column shows.
struct Column {
    height: f64,
    /// Shares of the weight that floor and walls carry.
    floor: f64,
    walls: f64,
    /// Vertical force at depths of 1, 2, ... diameters: the weight of what is above less what the wall holds of it.
    stress: Vec<f64>,
}

fn column(seed: u64) -> Column {
    let driver = silo(seed);
    let (friction, on_floor) = wall_forces(&driver);
    let view = driver.view();
    let heights: Vec<f64> = view.bodies().position.iter().map(|row| row[2]).collect();
    let top = heights.iter().copied().fold(0.0, f64::max) + 0.5;
    let bottom = -1.0;
    let carried: f64 = friction.iter().map(|(_, force)| force).sum();
    let depths = (1..).map(f64::from).take_while(|depth| *depth <= top - bottom);
    let stress = depths
        .map(|depth| {
            let level = top - depth;
            let above = heights.iter().filter(|height| **height > level).count() as f64;
            let held: f64 =
                friction.iter().filter(|(height, _)| *height > level).map(|(_, force)| force).sum();
            above - held
        })
        .collect();
    let weight = COUNT as f64;
    Column { height: top - bottom, floor: on_floor / weight, walls: carried / weight, stress }
}

/// Columns that are averaged.
const COLUMNS: u64 = 4;

/// Case F13, Janssen: the vertical stress grows like that of a fluid near the surface and saturates below,
/// σ(h) = ρ g λ (1 - exp(-h/λ)) with a determination of more than 0.98; with friction 0.5 and a filling six times as high as
/// wide, the floor carries less than 0.6 of the weight.
///
/// That floor and wall together carry the weight is exact at rest but for the residual motion, so 1e-3 is allowed there. ρ g
/// is the weight over the height, and λ the only number that is fitted. The law is one of means: the forces of the some
/// hundred wall contacts in a stretch of λ fluctuate from column to column, so the stress of several columns is averaged.
#[test]
#[ignore = "slow: fills four silos of 5100 spheres and lets them rest"]
fn the_walls_of_a_tall_silo_carry_the_weight() {
    let columns: Vec<Column> = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..COLUMNS).map(|run| scope.spawn(move || column(3 + run))).collect();
        runs.into_iter().map(|run| run.join().expect("a column at rest")).collect()
    });
    for column in &columns {
        let Column { height, floor, walls, .. } = column;
        println!("height {height:.2}, floor {floor:.4}, walls {walls:.4} of the weight");
        assert!((floor + walls - 1.0).abs() < 1e-3, "floor {floor}, walls {walls}");
        assert!(*height > 5.5 * WIDTH, "the column is only {height} high");
        assert!(*floor < 0.6, "the floor carries {floor} of the weight");
    }
    let mean = |of: &dyn Fn(&Column) -> f64| columns.iter().map(of).sum::<f64>() / COLUMNS as f64;
    let shortest = columns.iter().map(|column| column.stress.len()).min().expect("columns");
    let stress: Vec<f64> = (0..shortest).map(|depth| mean(&|column| column.stress[depth])).collect();
    let gradient = COUNT as f64 / mean(&|column| column.height);
    let janssen = |length: f64, depth: f64| gradient * length * (1.0 - (-depth / length).exp());
    let squares = |length: f64| {
        stress.iter().enumerate().map(|(at, s)| (s - janssen(length, at as f64 + 1.0)).powi(2)).sum::<f64>()
    };
    let lengths = (10..1000).map(|k| 0.1 * f64::from(k));
    let length = lengths.min_by(|a, b| squares(*a).total_cmp(&squares(*b))).expect("some lengths");
    let average = stress.iter().sum::<f64>() / stress.len() as f64;
    let variance: f64 = stress.iter().map(|stress| (stress - average).powi(2)).sum();
    let determination = 1.0 - squares(length) / variance;
    println!("length {length:.1} d, r2 {determination:.4}; force by depth: {stress:.0?}");
    assert!(determination > 0.98, "r2 {determination}");
}
