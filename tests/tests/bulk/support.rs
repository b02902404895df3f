//! What the runs share: continuing from the state of another run, and fits.

use std::path::Path;

use granule_drivers::{Driver, TimeStepDriver};
use granule_formats::Provenance;
use granule_formats::lammps_data::{self, Atom, DataFile};

/// Density of a sphere of diameter and mass 1.
pub const DENSITY: f64 = 6.0 / std::f64::consts::PI;

/// The bodies of a run now, in the order of their identities.
pub fn atoms(driver: &TimeStepDriver) -> Vec<Atom> {
    let view = driver.view();
    let rows = view.bodies();
    let table = &view.plan().bodies;
    let atom = |(rank, &place): (usize, &u32)| {
        let place = place as usize;
        Atom {
            id: rows.id[place],
            material: table.material[rank],
            diameter: 2.0 * table.radius[rank],
            density: Atom::density_of(table.mass[rank], table.radius[rank]),
            position: view.position(rank),
            image: [0; 3],
            velocity: rows.velocity_of(place),
            angular_velocity: if view.plan().rotation { rows.spin_of(place) } else { [0.0; 3] },
        }
    };
    view.order().iter().enumerate().map(atom).collect()
}

/// Writes bodies where a scene can import them.
pub fn save(path: &Path, atoms: Vec<Atom>, lo: [f64; 3], hi: [f64; 3]) {
    let materials = 1 + atoms.iter().map(|atom| atom.material).max().unwrap_or(0);
    let data = DataFile { title: "state".into(), provenance: None, materials, lo, hi, atoms };
    let provenance = Provenance::new("test", "none", 0).expect("plain words");
    lammps_data::write(path, &data, &provenance).expect("a folder of this test");
}

/// Intercept, slope and coefficient of determination of the straight line of least squares.
pub fn line(x: &[f64], y: &[f64]) -> (f64, f64, f64) {
    let n = x.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (mx, my) = (mean(x), mean(y));
    let sxx: f64 = x.iter().map(|x| (x - mx) * (x - mx)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let syy: f64 = y.iter().map(|y| (y - my) * (y - my)).sum();
    let slope = sxy / sxx;
    (my - slope * mx, slope, sxy * sxy / (sxx * syy))
}

#[test]
fn a_line_is_found_again() {
    let (intercept, slope, determination) = line(&[1.0, 2.0, 4.0], &[5.0, 7.0, 11.0]);
    assert!((intercept - 3.0).abs() < 1e-14 && (slope - 2.0).abs() < 1e-14);
    assert!((determination - 1.0).abs() < 1e-14);
    assert!(line(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]).2 < 1e-14);
}
