//! Cases of many bodies: what is chaotic in them is compared through distributions over seeds.

mod cone;
mod reference;
mod repose;
mod samples;
mod settling;

use std::path::Path;

use granule_report::verdict::Case as Verdict;

/// A case of many bodies: its name and what runs it, with a folder to work in and whether to record the peers' answers.
pub type PileCase = (&'static str, fn(&Path, bool) -> Result<Vec<Verdict>, String>);

/// All of them.
pub const CASES: [PileCase; 2] = [("pile-500", settling::check), ("cone-600", cone::check)];

/// Chance that true agreement is called a difference, over all questions of one comparison together.
const FALSE_ALARM: f64 = 0.05;
