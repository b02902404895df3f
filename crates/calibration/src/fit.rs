//! The fit.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::Impact;

/// Impacts of one kind that a parameter of that kind needs: below, a regime could be an outlier.
const FEWEST: usize = 3;

/// What is known besides the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Inertia factor q = I/(m R²): 2/5 for solid spheres.
    pub inertia_factor: f64,
    /// Normal restitution, for data without it.
    pub restitution: Option<f64>,
    /// Probability with which the intervals hold the true value, between 0 and 1.
    pub confidence: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { inertia_factor: 0.4, restitution: None, confidence: 0.95 }
    }
}

/// A parameter with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// Best value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Interval of the confidence that was asked for.
    pub interval: [f64; 2],
}

/// What the data say about a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Estimate {
    /// It is determined.
    Value(Value),
    /// It is not.
    Undetermined {
        /// Why, and which measurement would help.
        why: String,
        /// The parameter is at least this, if the data say so.
        at_least: Option<f64>,
    },
}

/// Result of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Normal restitution e_n.
    pub restitution: Estimate,
    /// Friction coefficient μ.
    pub friction: Estimate,
    /// Tangential restitution e_t0 of sticking impacts.
    pub tangential_restitution: Estimate,
    /// s = μ (1 + e_n)(1 + 1/q), which Ψ data determine without e_n.
    pub sliding_loss: Estimate,
    /// Number of impacts that slid.
    pub sliding: usize,
    /// Number of impacts that stuck.
    pub sticking: usize,
    /// Standard deviation of Ψ2 about the fit.
    pub scatter: f64,
    /// What to know about the fit: values that no body has.
    pub remarks: Vec<String>,
}

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FitError {
    /// Fewer impacts than parameters.
    TooFew(usize),
    /// A number is not allowed; which and what is.
    NotAllowed(String),
}

impl std::fmt::Display for FitError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooFew(count) => write!(f, "{count} impacts are too few; at least {FEWEST} are needed"),
            Self::NotAllowed(what) => f.write_str(what),
        }
    }
}

impl std::error::Error for FitError {}

/// Which impacts slid, with the sums of squares that decided it.
struct Split {
    /// The first this many, in the order of Ψ1, stuck.
    sticking: usize,
    squares: f64,
}

/// Least squares of the three-parameter rule. The impacts are ordered by Ψ1; every way to cut them into sticking and sliding
/// ones is a linear problem, and the best is taken. A second regime is accepted only if it explains more than a chance fit
/// would (Bayesian information criterion). Uncertainties are those of linear least squares with Student's distribution,
/// given the cut.
///
/// # Errors
/// Too few impacts, or numbers that are not allowed.
pub fn fit(impacts: &[Impact], options: &Options) -> Result<Fit, FitError> {
    check(impacts, options)?;
    let mut sorted = impacts.to_vec();
    sorted.sort_by(|a, b| a.psi1.total_cmp(&b.psi1));
    let split = split(&sorted);
    let (stuck, slid) = sorted.split_at(split.sticking);
    let restitution = normal_restitution(&sorted, options);
    let sliding_loss = if slid.len() >= FEWEST {
        let losses: Vec<f64> = slid.iter().map(|impact| impact.psi1 - impact.psi2).collect();
        Estimate::Value(mean(&losses, options.confidence))
    } else {
        // A sticking impact says that sliding would have taken more.
        Estimate::Undetermined {
            why: "every impact stuck: measure impacts at larger psi1".to_string(),
            at_least: largest(stuck.iter().map(|impact| impact.psi1 - impact.psi2)),
        }
    };
    let tangential_restitution = if stuck.len() >= FEWEST && stuck.iter().any(|impact| impact.psi1 > 0.0) {
        Estimate::Value(slope(stuck, options.confidence))
    } else {
        let why = "every impact slid: measure impacts at smaller psi1".to_string();
        let loss = |impact: &Impact| (impact.psi1 > 0.0).then(|| -impact.psi2 / impact.psi1);
        Estimate::Undetermined { why, at_least: largest(slid.iter().filter_map(loss)) }
    };
    let friction = friction(&sliding_loss, &restitution, options);
    let mut remarks = Vec::new();
    for (name, estimate, [low, high]) in [
        ("e_n", &restitution, [0.0, 1.0]),
        ("e_t0", &tangential_restitution, [-1.0, 1.0]),
        ("mu", &friction, [0.0, f64::INFINITY]),
    ] {
        if let Estimate::Value(value) = estimate
            && !(low..=high).contains(&value.value)
        {
            remarks
                .push(format!("{name} = {:.4} lies outside of {low} to {high}: check the data", value.value));
        }
    }
    let free = sorted.len().saturating_sub(2).max(1);
    Ok(Fit {
        restitution,
        friction,
        tangential_restitution,
        sliding_loss,
        sliding: slid.len(),
        sticking: stuck.len(),
        scatter: (split.squares / free as f64).sqrt(),
        remarks,
    })
}

fn check(impacts: &[Impact], options: &Options) -> Result<(), FitError> {
    let refuse = |what: String| Err(FitError::NotAllowed(what));
    if impacts.len() < FEWEST {
        return Err(FitError::TooFew(impacts.len()));
    }
    if !(options.inertia_factor > 0.0 && options.inertia_factor.is_finite()) {
        return refuse(format!("the inertia factor {} must be greater than 0", options.inertia_factor));
    }
    if !(options.confidence > 0.0 && options.confidence < 1.0) {
        return refuse(format!("the confidence {} must lie between 0 and 1", options.confidence));
    }
    if let Some(value) = options.restitution.filter(|value| !(0.0..=1.0).contains(value)) {
        return refuse(format!("the restitution {value} must be at least 0 and at most 1"));
    }
    match impacts
        .iter()
        .find(|impact| !(impact.psi1 >= 0.0 && impact.psi1.is_finite() && impact.psi2.is_finite()))
    {
        Some(impact) => refuse(format!("this is no impact: {impact:?}")),
        None => Ok(()),
    }
}

/// The cut with the least squares, if it is better than no cut.
fn split(sorted: &[Impact]) -> Split {
    let count = sorted.len();
    let squares = |sticking: usize| {
        let (stuck, slid) = sorted.split_at(sticking);
        let ratio = -slope_of(stuck);
        let loss =
            slid.iter().map(|impact| impact.psi1 - impact.psi2).sum::<f64>() / slid.len().max(1) as f64;
        let of_stuck: f64 = stuck.iter().map(|impact| (impact.psi2 + ratio * impact.psi1).powi(2)).sum();
        let of_slid: f64 = slid.iter().map(|impact| (impact.psi1 - loss - impact.psi2).powi(2)).sum();
        of_stuck + of_slid
    };
    // Round-off of the data: exact fits must not be compared below it.
    let scale: f64 = sorted.iter().map(|impact| impact.psi1.powi(2) + impact.psi2.powi(2)).sum();
    let least = 1e-24 * scale.max(f64::MIN_POSITIVE);
    let all = count as f64;
    let criterion =
        |squares: f64, parameters: f64| all * (squares.max(least) / all).ln() + parameters * all.ln();
    let whole = [0, count].map(|sticking| (sticking, squares(sticking)));
    let alone = if whole[0].1 <= whole[1].1 { whole[0] } else { whole[1] };
    let cut = (FEWEST..=count.saturating_sub(FEWEST))
        .map(|sticking| (sticking, squares(sticking)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    // Two parameters and the place of the cut against one parameter.
    let best = match cut {
        Some(cut) if criterion(cut.1, 3.0) < criterion(alone.1, 1.0) => cut,
        _ => alone,
    };
    Split { sticking: best.0, squares: best.1 }
}

/// Ψ2/Ψ1 of sticking impacts.
fn slope_of(stuck: &[Impact]) -> f64 {
    let square: f64 = stuck.iter().map(|impact| impact.psi1 * impact.psi1).sum();
    let product: f64 = stuck.iter().map(|impact| impact.psi1 * impact.psi2).sum();
    if square > 0.0 { product / square } else { 0.0 }
}

fn slope(stuck: &[Impact], confidence: f64) -> Value {
    let value = -slope_of(stuck);
    let square: f64 = stuck.iter().map(|impact| impact.psi1 * impact.psi1).sum();
    let squares: f64 = stuck.iter().map(|impact| (impact.psi2 + value * impact.psi1).powi(2)).sum();
    let free = (stuck.len() - 1) as f64;
    with_interval(value, (squares / free / square).sqrt(), free, confidence)
}

fn mean(values: &[f64], confidence: f64) -> Value {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|one| (one - value).powi(2)).sum();
    let free = count - 1.0;
    with_interval(value, (squares / free / count).sqrt(), free, confidence)
}

/// The interval of Student's distribution.
fn with_interval(value: f64, error: f64, free: f64, confidence: f64) -> Value {
    let quantile =
        StudentsT::new(0.0, 1.0, free).map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + 0.5 * confidence));
    let half = if error > 0.0 { quantile * error } else { 0.0 };
    Value { value, error, interval: [value - half, value + half] }
}

fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.fold(None, |most: Option<f64>, value| Some(most.map_or(value, |most| most.max(value))))
}

fn normal_restitution(impacts: &[Impact], options: &Options) -> Estimate {
    let measured: Vec<f64> = impacts.iter().filter_map(|impact| impact.restitution).collect();
    if let Some(value) = options.restitution {
        return Estimate::Value(Value { value, error: 0.0, interval: [value; 2] });
    }
    if measured.len() < FEWEST {
        return Estimate::Undetermined {
            why: "the data hold no normal rebound: measure it, or give the restitution".to_string(),
            at_least: None,
        };
    }
    Estimate::Value(mean(&measured, options.confidence))
}

/// μ = s/((1 + e_n)(1 + 1/q)), with the errors of s and e_n added as independent.
fn friction(loss: &Estimate, restitution: &Estimate, options: &Options) -> Estimate {
    let inertia = 1.0 + 1.0 / options.inertia_factor;
    match (loss, restitution) {
        (Estimate::Value(loss), Estimate::Value(restitution)) => {
            let factor = 1.0 / ((1.0 + restitution.value) * inertia);
            let value = loss.value * factor;
            let part = |of: &Value, slope: f64| {
                [of.error * slope, 0.5 * (of.interval[1] - of.interval[0]) * slope]
            };
            let [a, b] = [part(loss, factor), part(restitution, value / (1.0 + restitution.value))];
            let half = f64::hypot(a[1], b[1]);
            Estimate::Value(Value { value, error: f64::hypot(a[0], b[0]), interval: [value - half, value + half] })
        }
        (Estimate::Undetermined { why, at_least }, Estimate::Value(restitution)) => Estimate::Undetermined {
            why: why.clone(),
            at_least: at_least.map(|loss| loss / ((1.0 + restitution.value) * inertia)),
        },
        (Estimate::Value(_), Estimate::Undetermined { .. }) => Estimate::Undetermined {
            why: "without e_n only s = mu (1 + e_n)(1 + 1/q) is known: measure the normal rebound, or give the restitution"
                .to_string(),
            at_least: None,
        },
        (Estimate::Undetermined { why, .. }, _) => Estimate::Undetermined { why: why.clone(), at_least: None },
    }
}
