//! What is measured.

use super::states::Recipe;

/// A case: a scene of the benchmark, its initial state, and who runs it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name in reports and on the command line.
    pub name: &'static str,
    /// Folder of its scene.
    pub scene: &'static str,
    /// Where its bodies come from.
    pub recipe: Recipe,
    /// Lateral copies of them.
    pub copies: [usize; 2],
    /// Part of the default set, which ends in minutes; the others run with `--all` or by name.
    pub quick: bool,
    /// The peers run it too.
    pub peers: bool,
    /// Largest diameters of the classes of sizes that LAMMPS may search separately \[m\].
    pub size_classes: &'static [f64],
}

const POURED: Recipe = Recipe::Poured("settled-pour");

const CHUTE: Recipe = Recipe::Chute { pour: "chute-pour", flow: "chute-flow", bed: 912, mobile: 31_088 };

const POLY: Recipe = Recipe::Poured("poly-4-pour");
const BOULDER: Recipe = Recipe::Laid { pour: "bed-pour", copies: [6, 6], then: "poly-100-settle" };

const fn settled(name: &'static str, scene: &'static str, copies: [usize; 2], quick: bool) -> Case {
    Case { name, scene, recipe: POURED, copies, quick, peers: true, size_classes: &[] }
}

/// All cases, in the order of the reports.
pub const CASES: &[Case] = &[
    settled("settled-10k-hooke", "settled-hooke", [1, 1], true),
    settled("settled-10k-hertz", "settled-hertz", [1, 1], true),
    settled("settled-10k-frictionless", "settled-frictionless", [1, 1], true),
    settled("settled-100k-hooke", "settled-hooke", [5, 2], true),
    settled("settled-100k-hertz", "settled-hertz", [5, 2], false),
    settled("settled-100k-frictionless", "settled-frictionless", [5, 2], false),
    settled("settled-1M-hooke", "settled-hooke", [10, 10], false),
    settled("settled-1M-hertz", "settled-hertz", [10, 10], false),
    Case { peers: false, ..settled("settled-10M-hooke", "settled-hooke", [40, 25], false) },
    Case { recipe: CHUTE, ..settled("chute-32k", "chute", [1, 1], true) },
    Case { recipe: CHUTE, ..settled("chute-512k", "chute", [4, 4], false) },
    Case { recipe: Recipe::Own, ..settled("gas-100k", "gas", [1, 1], true) },
    Case { size_classes: &[1.0, 2.0], recipe: POLY, ..settled("poly-4-10k", "poly-4", [1, 1], true) },
    Case { size_classes: &[1.0, 2.0], recipe: POLY, ..settled("poly-4-100k", "poly-4", [5, 2], false) },
    Case { recipe: Recipe::Poured("bed-pour"), ..settled("bed-130k", "bed", [6, 6], false) },
    Case {
        size_classes: &[1.0, 100.0],
        recipe: BOULDER,
        ..settled("poly-100-130k", "poly-100", [6, 6], false)
    },
    Case {
        recipe: Recipe::Poured("bed-pour"),
        peers: false,
        ..settled("poly-1000-130k", "poly-1000", [6, 6], false)
    },
];

/// The cases that are asked for: those whose name contains one of `words`; without words the quick ones, or all.
pub fn selected(words: &[String], all: bool) -> Vec<Case> {
    let wanted = |case: &&Case| match words {
        [] => all || case.quick,
        words => words.iter().any(|word| case.name.contains(word.as_str())),
    };
    CASES.iter().filter(wanted).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_choose_and_names_differ() {
        let names: std::collections::BTreeSet<&str> = CASES.iter().map(|case| case.name).collect();
        assert_eq!(names.len(), CASES.len());
        assert_eq!(selected(&[], true).len(), CASES.len());
        assert!(selected(&[], false).iter().all(|case| case.quick));
        let million = selected(&["1M".to_string()], false);
        assert!(!million.is_empty() && million.iter().all(|case| case.copies == [10, 10]));
        assert!(selected(&["no such case".to_string()], true).is_empty());
    }

    #[test]
    fn every_case_has_its_scene() {
        for case in CASES {
            let scene = super::super::states::scenes().join(case.scene).join("scene.ron");
            assert!(scene.exists(), "{}", scene.display());
        }
    }
}
