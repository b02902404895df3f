//! Every extreme gives the answer that it must give.

use granule_extremes::{Case, Lab, cases};
use granule_laws as _;

/// Runs the cases and reports all that fail.
fn all(chosen: impl Fn(&Case) -> bool) {
    let lab = Lab::new().unwrap();
    let chosen: Vec<&Case> = cases().filter(|case| chosen(case)).collect();
    assert!(!chosen.is_empty());
    let failed: Vec<String> = chosen
        .iter()
        .filter_map(|case| {
            let got = (case.check)(&lab);
            println!("{}: {got:?}", case.name);
            got.err().map(|why| format!("{}: {why}", case.name))
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn quick_ones() {
    all(|case| !case.slow);
}

#[test]
#[ignore = "slow: 1e9 particle steps, and 1e6 pairs at once"]
fn slow_ones() {
    all(|case| case.slow);
}
