//! Whether two samples of end states come from one distribution.

use granule_report::statistics::{
    PermutationSettings, difference_of_means, holm, mean, permutation_test, standard_deviation,
};
use granule_report::verdict::Case as Verdict;
use granule_report::{Block, Cell, Table, format_number};

use super::FALSE_ALARM;
use crate::translate::Target;

/// What a run of one seed gives, one number a question.
pub type Answers = Vec<f64>;

/// Compares the means of two samples question by question with permutation tests, corrected by Holm for their number. With `n`
/// seeds against `n` the least p-value is `2 / binomial(2n, n)`.
///
/// # Errors
/// A sample is empty or holds numbers that are not finite.
pub fn distributions(
    case: &str,
    questions: &[&str],
    (target, preset): (Target, &str),
    ours: &[Answers],
    theirs: &[Answers],
) -> Result<Verdict, String> {
    let column =
        |sample: &[Answers], question: usize| sample.iter().map(|row| row[question]).collect::<Vec<_>>();
    let mut p_values = Vec::new();
    let mut rows = Vec::new();
    for (index, question) in questions.iter().enumerate() {
        let (a, b) = (column(ours, index), column(theirs, index));
        let fail = |error: granule_report::ReportError| format!("{case}, {question}: {error}");
        let test =
            permutation_test(&a, &b, PermutationSettings::default(), difference_of_means).map_err(fail)?;
        p_values.push(test.p_value);
        let told = |sample: &[f64]| -> Result<Cell, granule_report::ReportError> {
            let (middle, spread) = (mean(sample)?, standard_deviation(sample)?);
            Ok(Cell::text(format!("{} ± {}", format_number(middle, 4), format_number(spread, 2))))
        };
        rows.push([
            Cell::text(*question),
            told(&a).map_err(fail)?,
            told(&b).map_err(fail)?,
            Cell::text(format!("{:.3}", test.p_value)),
        ]);
    }
    let corrected = holm(&p_values).map_err(|error| error.to_string())?;
    let least = corrected.iter().copied().fold(1.0, f64::min);
    let mut table =
        Table::new(["question", ">granule", &format!(">{}", target.name()), ">p", ">p, corrected"]);
    for (row, corrected) in rows.into_iter().zip(&corrected) {
        table.push(row.into_iter().chain([Cell::text(format!("{corrected:.3}"))]).collect());
    }
    let mut verdict = Verdict::judged(
        format!("{case} distributions, ours with `{preset}` ({})", target.name()),
        "1 - least corrected p-value of all questions",
        1.0 - least,
        1.0 - FALSE_ALARM,
    )
    .because(format!(
        "{} seeds of ours against {} of the peer, permutation tests of the means, Holm's correction over {} questions: true \
         agreement fails with a probability of {FALSE_ALARM} at most",
        ours.len(),
        theirs.len(),
        questions.len()
    ));
    verdict.extras.blocks.push(Block::paragraph("Mean ± standard deviation over seeds:"));
    verdict.extras.blocks.push(Block::Table(table));
    Ok(verdict)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(shift: f64) -> bool {
        let sample = |from: f64| (0..6).map(|k| vec![from + f64::from(k), 1.0]).collect::<Vec<_>>();
        distributions("x", &["a", "b"], (Target::Liggghts, "liggghts"), &sample(0.0), &sample(shift))
            .unwrap()
            .pass
    }

    #[test]
    fn finds_shifts_and_nothing_else() {
        assert!(judged(0.0));
        assert!(judged(0.5));
        assert!(!judged(6.0), "samples that do not overlap are different");
    }
}
