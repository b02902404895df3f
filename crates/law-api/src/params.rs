//! Parameters of a law: specification, choice of form, values.

use crate::{Dimension, LawInfo, Real};

/// One end of a range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// No limit (but finite).
    Open,
    /// The limit itself is allowed.
    Inclusive(f64),
    /// The limit itself is not allowed.
    Exclusive(f64),
}

/// Allowed values of a parameter. Values are always finite unless `infinite` allows +∞.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueRange {
    /// Lower end.
    pub low: Bound,
    /// Upper end.
    pub high: Bound,
    /// True if `inf` is a meaningful value (an infinite friction coefficient: no sliding).
    pub infinite: bool,
}

impl ValueRange {
    /// Greater than zero.
    pub const POSITIVE: Self = Self { low: Bound::Exclusive(0.0), high: Bound::Open, infinite: false };
    /// Zero or greater.
    pub const NON_NEGATIVE: Self = Self { low: Bound::Inclusive(0.0), high: Bound::Open, infinite: false };
    /// From zero to one, both included.
    pub const UNIT: Self = Self { low: Bound::Inclusive(0.0), high: Bound::Inclusive(1.0), infinite: false };
    /// Greater than zero, up to and including one.
    pub const POSITIVE_UNIT: Self =
        Self { low: Bound::Exclusive(0.0), high: Bound::Inclusive(1.0), infinite: false };

    /// True if the value is allowed.
    pub fn contains(&self, value: f64) -> bool {
        if value.is_nan() || value == f64::NEG_INFINITY {
            return false;
        }
        if value == f64::INFINITY {
            return self.infinite;
        }
        let above = match self.low {
            Bound::Open => true,
            Bound::Inclusive(limit) => value >= limit,
            Bound::Exclusive(limit) => value > limit,
        };
        let below = match self.high {
            Bound::Open => true,
            Bound::Inclusive(limit) => value <= limit,
            Bound::Exclusive(limit) => value < limit,
        };
        above && below
    }

    /// The range in words, as in `greater than 0 and at most 1`.
    pub fn describe(&self) -> String {
        let low = match self.low {
            Bound::Open => None,
            Bound::Inclusive(limit) => Some(format!("at least {limit}")),
            Bound::Exclusive(limit) => Some(format!("greater than {limit}")),
        };
        let high = match self.high {
            Bound::Open => None,
            Bound::Inclusive(limit) => Some(format!("at most {limit}")),
            Bound::Exclusive(limit) => Some(format!("less than {limit}")),
        };
        let finite = if self.infinite { "or inf" } else { "finite" };
        match (low, high) {
            (None, None) => finite.to_string(),
            (Some(one), None) | (None, Some(one)) => {
                if self.infinite {
                    format!("{one}, or inf")
                } else {
                    one
                }
            }
            (Some(low), Some(high)) => format!("{low} and {high}"),
        }
    }
}

/// Specification of one parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParamSpec {
    /// Name in scenes.
    pub name: &'static str,
    /// Symbol in the literature.
    pub symbol: &'static str,
    /// What it means.
    pub doc: &'static str,
    /// SI dimension.
    pub dimension: Dimension,
    /// Allowed values.
    pub range: ValueRange,
}

/// One set of parameters that determines the law.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// What this way of giving parameters is for.
    pub doc: &'static str,
    /// Parameters that must be given.
    pub required: &'static [&'static ParamSpec],
    /// Parameters that may be left out, with the value that they then have.
    pub optional: &'static [(&'static ParamSpec, f64)],
}

impl Form {
    fn knows(&self, name: &str) -> bool {
        self.required.iter().any(|spec| spec.name == name)
            || self.optional.iter().any(|(spec, _)| spec.name == name)
    }

    /// Names of the required parameters, joined for a message.
    pub fn describe(&self) -> String {
        let required: Vec<_> = self.required.iter().map(|spec| spec.name).collect();
        let optional: Vec<_> = self.optional.iter().map(|(spec, _)| format!("[{}]", spec.name)).collect();
        let all: Vec<String> = required.iter().map(|name| (*name).to_string()).chain(optional).collect();
        format!("({})", all.join(", "))
    }
}

/// What a law says when it cannot be had as asked.
#[derive(Clone, Debug, PartialEq)]
pub struct LawError {
    /// The parameter at fault, if it is one.
    pub parameter: Option<String>,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What is allowed, or what to do.
    pub help: Option<String>,
}

impl LawError {
    /// An error without a parameter to point at.
    pub fn new(message: impl Into<String>) -> Self {
        Self { parameter: None, message: message.into(), help: None }
    }

    /// Refuses what parameters lead to if it is no number of the precision of a stage.
    ///
    /// # Errors
    /// One of the named values is not finite.
    pub fn unless_finite<T: Real>(values: &[(&str, f64)]) -> Result<(), Self> {
        match values.iter().find(|(_, value)| !T::of(*value).wide().is_finite()) {
            Some((name, value)) => Err(Self::new(format!(
                "these parameters make the {name} {value:e}, which is beyond the range of numbers in this precision"
            ))),
            None => Ok(()),
        }
    }

    /// Points at a parameter.
    #[must_use]
    pub fn at(mut self, parameter: &str) -> Self {
        self.parameter = Some(parameter.to_string());
        self
    }

    /// Adds what to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl std::fmt::Display for LawError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(parameter) = &self.parameter {
            write!(f, "{parameter}: ")?;
        }
        write!(f, "{}", self.message)?;
        if let Some(help) = &self.help {
            write!(f, " ({help})")?;
        }
        Ok(())
    }
}

impl std::error::Error for LawError {}

/// What parameters are chosen from.
pub(crate) struct Choice {
    pub law: &'static str,
    pub parameters: &'static [&'static ParamSpec],
    pub forms: &'static [Form],
}

/// Checked parameter values of one law in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    form: usize,
    values: Vec<(&'static str, f64)>,
}

impl Params {
    /// Checks names, ranges and completeness, and finds the form that the given names belong to. All problems are
    /// returned at once. Values are in SI units.
    pub fn new(info: &'static LawInfo, given: &[(&str, f64)]) -> Result<Self, Vec<LawError>> {
        Self::of(&Choice { law: info.name, parameters: info.parameters, forms: info.forms }, given)
    }

    /// As [`new`](Self::new) for a law of whatever kind.
    pub(crate) fn of(law: &Choice, given: &[(&str, f64)]) -> Result<Self, Vec<LawError>> {
        let mut errors = Vec::new();
        for (index, (name, value)) in given.iter().enumerate() {
            let Some(spec) = law.parameters.iter().find(|spec| spec.name == *name) else {
                errors.push(unknown(law, name));
                continue;
            };
            if given[..index].iter().any(|(earlier, _)| earlier == name) {
                errors.push(LawError::new("given twice").at(name));
            }
            if !spec.range.contains(*value) {
                errors.push(LawError::new(format!("{value} is not allowed")).at(name).help(format!(
                    "{} must be {}",
                    spec.name,
                    spec.range.describe()
                )));
            }
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        let fits = |form: &Form| {
            form.required.iter().all(|spec| given.iter().any(|(name, _)| *name == spec.name))
                && given.iter().all(|(name, _)| form.knows(name))
        };
        let Some(form) = law.forms.iter().position(fits) else {
            return Err(vec![no_form(law, given)]);
        };
        let chosen = &law.forms[form];
        let value_of =
            |spec: &ParamSpec| given.iter().find(|(name, _)| *name == spec.name).map(|(_, value)| *value);
        let mut values: Vec<(&'static str, f64)> = chosen
            .required
            .iter()
            .filter_map(|spec| value_of(spec).map(|value| (spec.name, value)))
            .collect();
        values.extend(
            chosen.optional.iter().map(|(spec, default)| (spec.name, value_of(spec).unwrap_or(*default))),
        );
        Ok(Self { form, values })
    }

    /// Index of the form in [`LawInfo::forms`].
    pub fn form(&self) -> usize {
        self.form
    }

    /// Value of a parameter of the chosen form.
    ///
    /// # Errors
    /// The parameter does not belong to the chosen form: a mistake in the law crate, reported instead of panicking.
    pub fn value(&self, spec: &ParamSpec) -> Result<f64, LawError> {
        self.get(spec).ok_or_else(|| LawError::new("is not part of the chosen form").at(spec.name))
    }

    /// Value of a parameter, if the chosen form has it.
    pub fn get(&self, spec: &ParamSpec) -> Option<f64> {
        self.values.iter().find(|(name, _)| *name == spec.name).map(|(_, value)| *value)
    }

    /// All values of the chosen form, defaults included.
    pub fn values(&self) -> &[(&'static str, f64)] {
        &self.values
    }
}

fn unknown(law: &Choice, name: &str) -> LawError {
    let names: Vec<&str> = law.parameters.iter().map(|spec| spec.name).collect();
    let near = crate::registry::nearest(name, names.iter().copied());
    let help = match near {
        Some(near) => format!("did you mean `{near}`? {} takes {}", law.law, forms_text(law)),
        None => format!("{} takes {}", law.law, forms_text(law)),
    };
    LawError::new(format!("{} has no parameter `{name}`", law.law)).at(name).help(help)
}

fn no_form(law: &Choice, given: &[(&str, f64)]) -> LawError {
    let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
    LawError::new(format!("{} cannot be determined from ({})", law.law, names.join(", ")))
        .help(format!("give one of {}", forms_text(law)))
}

fn forms_text(law: &Choice) -> String {
    law.forms.iter().map(Form::describe).collect::<Vec<_>>().join(" or ")
}
