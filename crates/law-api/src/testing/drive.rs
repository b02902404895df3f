//! Check `energy` of tangential laws under a prescribed slip: no energy can be drawn from a contact that began unstretched.

use std::f64::consts::TAU;

use super::{Case, Contacts, IMPACT, NORMAL_STIFFNESS, Report, normal_duration};
use crate::Stage;

/// Steps of the coarser of two integrations.
const STEPS: u32 = 20_000;

pub(super) fn check(case: &Case<'_>, stage: &dyn Stage<f64>, report: &mut Report) {
    if !(case.law.dissipative)(case.params) {
        return;
    }
    // Slips from far within the limit of a typical friction to far beyond it.
    for amplitude in [1e-3, 0.1, 1.0, 10.0] {
        let coarse = drawn(case, stage, amplitude, STEPS);
        let fine = drawn(case, stage, amplitude, 2 * STEPS);
        // The work is a sum over first-order steps: its error is about the difference of the two runs.
        let error = 2.0 * (fine.0 - coarse.0).abs() + 2.0 * (fine.1 - coarse.1).abs() + 1e-9 * fine.1;
        if fine.0 > error {
            report.fail(
                "energy",
                format!(
                    "a slip of {amplitude} m/s along a closed curve draws {:e} J out of a contact that took {:e} J (step error \
                     {error:.1e} J)",
                    fine.0, fine.1
                ),
            );
        }
    }
}

/// Largest energy drawn up to any moment, and the sum of the magnitudes of all work \[J\].
fn drawn(case: &Case<'_>, stage: &dyn Stage<f64>, amplitude: f64, steps: u32) -> (f64, f64) {
    let duration = 10.0 * normal_duration();
    let step = duration / f64::from(steps);
    let mut contact = Contacts::<f64>::new(1, case.law.info.history_width());
    contact.normal[0][0] = 0.0;
    contact.normal[2][0] = 1.0;
    contact.reduced_mass[0] = IMPACT.reduced_mass;
    contact.reduced_radius[0] = IMPACT.reduced_radius;
    contact.normal_stiffness[0] = NORMAL_STIFFNESS;
    contact.normal_damping[0] = 0.5;
    let (mut out, mut most, mut turnover) = (0.0, 0.0_f64, 0.0);
    let mut last = None;
    for index in 0..=steps {
        let phase = TAU * f64::from(index) / f64::from(steps);
        // The contact swells and shrinks, down to nearly nothing, while the slip runs along a Lissajous curve.
        let swell = 1.0 - 0.99 * (7.0 * phase).cos();
        let overlap = 0.5 * swell * IMPACT.normal_speed * normal_duration() / std::f64::consts::PI;
        contact.overlap[0] = overlap;
        contact.normal_force[0] = NORMAL_STIFFNESS * overlap;
        contact.tangential_velocity[0][0] = amplitude * (5.0 * phase).cos();
        contact.tangential_velocity[1][0] = amplitude * (8.0 * phase).sin();
        contact.run(stage, if index == 0 { 0.0 } else { step });
        let power: f64 =
            (0..3).map(|axis| contact.tangential_force[axis][0] * contact.tangential_velocity[axis][0]).sum();
        if let Some(last) = last {
            let work: f64 = 0.5 * step * (power + last);
            out += work;
            turnover += work.abs();
            most = most.max(out);
        }
        last = Some(power);
    }
    (most, turnover)
}
