//! Names of conventions and their choices in a scene.

use granule_law_api::{Arm, Conventions, CoulombCap, CoulombTest, HistoryUpdate, VelocityRule};

const ARMS: [(&str, Arm); 3] =
    [("Radius", Arm::Radius), ("HalfOverlap", Arm::HalfOverlap), ("FullOverlap", Arm::FullOverlap)];

const HISTORY: [(&str, HistoryUpdate); 3] = [
    ("RotateThenIncrement", HistoryUpdate::RotateThenIncrement),
    ("RotateIfTiltedThenIncrement", HistoryUpdate::RotateIfTiltedThenIncrement),
    ("IncrementThenProject", HistoryUpdate::IncrementThenProject),
];

const TESTS: [(&str, CoulombTest); 3] = [
    ("SpringThenTotal", CoulombTest::SpringThenTotal),
    ("Total", CoulombTest::Total),
    ("SpringOnly", CoulombTest::SpringOnly),
];

const CAPS: [(&str, CoulombCap); 2] =
    [("Repulsive", CoulombCap::Repulsive), ("Magnitude", CoulombCap::Magnitude)];

const VELOCITIES: [(&str, VelocityRule); 2] =
    [("Synchronised", VelocityRule::Synchronised), ("HalfStep", VelocityRule::HalfStep)];

/// Sets one convention, or says which choices there are.
pub fn change(conventions: &mut Conventions, name: &str, choice: &str) -> Result<(), Vec<&'static str>> {
    match name {
        "pair_torque_arm" => set(&mut conventions.pair_torque_arm, &ARMS, choice),
        "pair_slip_arm" => set(&mut conventions.pair_slip_arm, &ARMS, choice),
        "wall_torque_arm" => set(&mut conventions.wall_torque_arm, &ARMS, choice),
        "wall_slip_arm" => set(&mut conventions.wall_slip_arm, &ARMS, choice),
        "history_update" => set(&mut conventions.history_update, &HISTORY, choice),
        "coulomb_test" => set(&mut conventions.coulomb_test, &TESTS, choice),
        "coulomb_cap" => set(&mut conventions.coulomb_cap, &CAPS, choice),
        "velocity" => set(&mut conventions.velocity, &VELOCITIES, choice),
        _ => Err(Vec::new()),
    }
}

fn set<T: Copy>(place: &mut T, table: &[(&'static str, T)], choice: &str) -> Result<(), Vec<&'static str>> {
    match table.iter().find(|(name, _)| *name == choice) {
        Some((_, value)) => {
            *place = *value;
            Ok(())
        }
        None => Err(table.iter().map(|(name, _)| *name).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_changes_that_make_a_preset_of_another() {
        let mut conventions = Conventions::PHYSICAL;
        for (name, choice) in [
            ("pair_torque_arm", "Radius"),
            ("pair_slip_arm", "Radius"),
            ("wall_torque_arm", "Radius"),
            ("wall_slip_arm", "Radius"),
            ("history_update", "IncrementThenProject"),
            ("coulomb_test", "Total"),
            ("coulomb_cap", "Magnitude"),
            ("velocity", "HalfStep"),
        ] {
            change(&mut conventions, name, choice).unwrap();
        }
        assert_eq!(conventions, Conventions::LAMMPS_CLASSIC);
        assert_eq!(change(&mut conventions, "velocity", "x"), Err(vec!["Synchronised", "HalfStep"]));
    }
}
