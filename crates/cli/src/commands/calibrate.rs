//! `granule calibrate`: parameters from measured impacts.

use granule::calibration::{Estimate, Fit, Options};

use super::Exit;
use crate::args::CalibrateArguments;
use crate::terminal;

/// Fits the parameters of an impact to a file of measurements and prints them.
pub fn calibrate(arguments: &CalibrateArguments) -> Exit {
    let options = Options {
        inertia_factor: arguments.inertia_factor,
        restitution: arguments.restitution,
        confidence: arguments.confidence,
    };
    match granule::calibrate(&arguments.data, &options) {
        Ok((impacts, fit)) => {
            terminal::out(&report(impacts.len(), &fit, &options));
            Exit::Success
        }
        Err(error) => {
            terminal::error(&format!("{}: {error}", arguments.data.display()));
            Exit::Input
        }
    }
}

fn report(count: usize, fit: &Fit, options: &Options) -> String {
    let mut text = format!(
        "{count} impacts: {} slid, {} stuck; scatter of psi2 {:.2e}\n",
        fit.sliding, fit.sticking, fit.scatter
    );
    let rows = [
        ("restitution", "e_n", &fit.restitution),
        ("friction", "mu", &fit.friction),
        ("tangential_restitution", "e_t0", &fit.tangential_restitution),
        ("sliding loss", "mu (1 + e_n)(1 + 1/q)", &fit.sliding_loss),
    ];
    for (name, symbol, estimate) in rows {
        let found = match estimate {
            Estimate::Value(value) => {
                let [low, high] = value.interval;
                format!(
                    "{:.5} +- {:.5}   {:.0} %: {low:.5} to {high:.5}",
                    value.value,
                    value.error,
                    100.0 * options.confidence
                )
            }
            Estimate::Undetermined { why, at_least } => {
                let bound = at_least.map(|bound| format!("; at least {bound:.5}")).unwrap_or_default();
                format!("not determined{bound}: {why}")
            }
        };
        text.push_str(&format!("  {name:<22} {symbol:<22} {found}\n"));
    }
    for remark in &fit.remarks {
        text.push_str(&format!("  remark: {remark}\n"));
    }
    text
}
