//! Young's modulus and Poisson's ratio of each material from the effective moduli of pairs: LIGGGHTS mixes them itself.

use super::{Untranslatable, refuse};
use crate::peers::PeerMaterial;

/// Effective moduli may differ from what the materials mix to by round-off of the mixing only.
const TOLERANCE: f64 = 1e-12;
/// Without tangential springs any ratio will do.
const ANY_POISSON_RATIO: f64 = 0.25;

/// Pair of types, E*, and G* where there is a tangential spring.
type Known = ((usize, usize), f64, Option<f64>);

/// What contacts ask: effective Young's modulus E*, and effective shear modulus G* if they have a tangential spring.
#[derive(Default)]
pub struct Moduli {
    asked: Vec<Known>,
}

impl Moduli {
    pub fn ask(&mut self, (i, j): (usize, usize), youngs: f64, shear: Option<f64>) {
        self.asked.push(((i.min(j), i.max(j)), youngs, shear));
    }

    /// One entry per type; `None` where no contact asks.
    pub fn materials(&self, kinds: usize) -> Result<Vec<Option<PeerMaterial>>, Untranslatable> {
        let normal = self.compliances(kinds, "effective_modulus", &|(_, youngs, _)| Some(*youngs))?;
        let shear = self.compliances(kinds, "effective_shear_modulus", &|(_, _, shear)| *shear)?;
        let material = |kind: usize| -> Result<Option<PeerMaterial>, Untranslatable> {
            let Some(compliance) = normal[kind] else { return Ok(None) };
            // (1 - ν²)/E and 2 (2 - ν)(1 + ν)/E have the ratio r = 2 (2 - ν)/(1 - ν).
            let poisson_ratio = match shear[kind] {
                None => ANY_POISSON_RATIO,
                Some(shear) => {
                    let r = shear / compliance;
                    (r - 4.0) / (r - 2.0)
                }
            };
            if !(0.0..=0.5).contains(&poisson_ratio) {
                return refuse(
                    "hertz",
                    format!(
                        "effective_modulus and effective_shear_modulus make a Poisson ratio of {poisson_ratio}"
                    ),
                );
            }
            let youngs_modulus = (1.0 - poisson_ratio * poisson_ratio) / compliance;
            Ok(Some(PeerMaterial { youngs_modulus, poisson_ratio }))
        };
        (1..=kinds).map(material).collect()
    }

    /// Compliance c of each type such that 1/modulus = c_i + c_j for every pair.
    fn compliances(
        &self,
        kinds: usize,
        what: &str,
        modulus: &dyn Fn(&Known) -> Option<f64>,
    ) -> Result<Vec<Option<f64>>, Untranslatable> {
        let asked: Vec<((usize, usize), f64)> = self
            .asked
            .iter()
            .filter_map(|entry| modulus(entry).map(|modulus| (entry.0, 1.0 / modulus)))
            .collect();
        let mut compliance: Vec<Option<f64>> = vec![None; kinds + 1];
        // Pairs of one material settle it; then whatever follows from these; what is left free is shared evenly.
        for ((i, j), sum) in &asked {
            if i == j {
                compliance[*i] = Some(0.5 * sum);
            }
        }
        loop {
            let mut open = None;
            let mut settled = false;
            for ((i, j), sum) in &asked {
                match (compliance[*i], compliance[*j]) {
                    (Some(known), None) => (compliance[*j], settled) = (Some(sum - known), true),
                    (None, Some(known)) => (compliance[*i], settled) = (Some(sum - known), true),
                    (None, None) => open = open.or(Some((*i, *sum))),
                    (Some(_), Some(_)) => {}
                }
            }
            match (settled, open) {
                (true, _) => {}
                (false, Some((i, sum))) => compliance[i] = Some(0.5 * sum),
                (false, None) => break,
            }
        }
        for ((i, j), sum) in &asked {
            let mixed = compliance[*i].unwrap_or(0.0) + compliance[*j].unwrap_or(0.0);
            let close = (mixed - sum).abs() <= TOLERANCE * sum;
            if !close {
                return refuse(
                    "hertz",
                    format!(
                        "{what} of materials {i} and {j} is {:e}; mixed from each material it is {:e}",
                        1.0 / sum,
                        1.0 / mixed
                    ),
                );
            }
        }
        Ok(compliance)
    }
}
