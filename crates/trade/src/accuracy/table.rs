//! Settings that a trade of the scene has measured.

use granule_scene::{Diagnostic, PrecisionChoice, Spanned, nearest};
use serde::Deserialize;

use super::{Against, Decided, FILLED, Wish};
use crate::setting::integrator_named;
use crate::study::identity;
use crate::{Omission, Setting};

/// Name of the file in the folder of a trade.
const FILE: &str = "trade.json";

#[derive(Deserialize)]
struct Study {
    scene: String,
    duration_s: f64,
    realisations: u64,
    comparison: Comparison,
    observables: Vec<Named>,
    settings: Vec<Measured>,
}

#[derive(Deserialize)]
struct Named {
    name: String,
    scale: f64,
    relative_uncertainty: f64,
    reference: Vec<f64>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Comparison {
    Paths,
    Means,
}

#[derive(Deserialize)]
struct Measured {
    setting: String,
    integrator: String,
    precision: String,
    without: Omission,
    steps_per_contact: f64,
    stiffness_factor: f64,
    seconds_per_second: f64,
    error: f64,
    bar: f64,
    unresolved: bool,
    errors: Vec<f64>,
    bars: Vec<f64>,
    dominated: bool,
}

/// A trade of this scene.
pub(super) struct Table {
    study: Study,
    place: String,
}

/// Reads the trade in a folder.
pub(super) fn read(wish: &Wish<'_>, folder: &Spanned<String>) -> Result<Table, Vec<Diagnostic>> {
    let fail = |message: String, help: &str| vec![Diagnostic::error(folder.span.clone(), message).help(help)];
    let path = wish.folder.join(&folder.value).join(FILE);
    let place = path.display().to_string();
    let make = format!("`granule trade SCENE -o {}` makes it", folder.value);
    let text = std::fs::read_to_string(&path)
        .map_err(|error| fail(format!("there is no table: {place}: {error}"), &make))?;
    let study: Study = serde_json::from_str(&text)
        .map_err(|error| fail(format!("{place} is no table of a trade: {error}"), &make))?;
    let count = study.observables.len();
    if study.settings.iter().any(|row| row.errors.len() != count || row.bars.len() != count) {
        return Err(fail(format!("{place} is no table of a trade: an error is missing"), &make));
    }
    let own = identity(wish.scene, wish.registry, wish.folder, wish.duration)
        .map_err(|error| fail(error.to_string(), ""))?;
    if own != study.scene {
        return Err(fail(
            format!("{place} belongs to another scene, or to another version of this one"),
            &make,
        ));
    }
    Ok(Table { study, place })
}

impl Measured {
    fn setting(&self) -> Option<Setting> {
        Some(Setting {
            integrator: integrator_named(&self.integrator)?,
            steps_per_contact: self.steps_per_contact,
            precision: match self.precision.as_str() {
                "Double" => PrecisionChoice::Double,
                "Single" => PrecisionChoice::Single,
                _ => return None,
            },
            stiffness: self.stiffness_factor,
            without: self.without,
        })
    }

    /// What can be relied on of one error: the error with its uncertainty, or that alone where the error is not told from
    /// zero.
    fn reliable(&self, at: Option<usize>) -> f64 {
        let (error, bar) = match at {
            Some(at) => (self.errors[at], self.bars[at]),
            None => (self.error, self.bar),
        };
        if self.unresolved && error <= bar { bar } else { error + bar }
    }
}

impl Table {
    /// The cheapest setting that keeps the error of a quantity.
    pub fn cheapest(
        &self,
        observable: &Spanned<String>,
        error: &Spanned<f64>,
    ) -> Result<Decided, Vec<Diagnostic>> {
        let names: Vec<&str> = self.study.observables.iter().map(|named| named.name.as_str()).collect();
        let Some(at) = names.iter().position(|name| *name == observable.value) else {
            let help = match nearest(&observable.value, names.iter().copied()) {
                Some(name) => format!("did you mean `{name}`?"),
                None => {
                    format!("it has {}; `granule trade --observe {}`", names.join(", "), observable.value)
                }
            };
            let message = format!("{} has no `{}`", self.place, observable.value);
            return Err(vec![Diagnostic::error(observable.span.clone(), message).help(help)]);
        };
        let good = self.study.settings.iter().filter(|row| row.reliable(Some(at)) <= error.value);
        let best = good.min_by(|a, b| a.seconds_per_second.total_cmp(&b.seconds_per_second));
        let Some(row) = best else {
            let least =
                self.study.settings.iter().map(|row| row.reliable(Some(at))).fold(f64::INFINITY, f64::min);
            let message =
                format!("no setting in {} keeps `{}` to {:e}", self.place, observable.value, error.value);
            let help = format!(
                "the best one has {least:.1e}; `granule trade --runs` with more runs knows errors better"
            );
            return Err(vec![Diagnostic::error(error.span.clone(), message).help(help)]);
        };
        self.decided(row, Some(at), self.study.duration_s)
    }

    /// The most accurate setting that fits into a time.
    pub fn most_accurate(&self, seconds: &Spanned<f64>, duration: f64) -> Result<Decided, Vec<Diagnostic>> {
        let time = |row: &Measured| row.seconds_per_second * duration;
        let fitting = self.study.settings.iter().filter(|row| time(row) <= FILLED * seconds.value);
        let Some(row) = fitting.min_by(|a, b| a.reliable(None).total_cmp(&b.reliable(None))) else {
            let least = self.study.settings.iter().map(time).fold(f64::INFINITY, f64::min);
            let message = format!("no setting in {} fits into {} s", self.place, seconds.value);
            let help = format!("the fastest one takes about {least:.3} s");
            return Err(vec![Diagnostic::error(seconds.span.clone(), message).help(help)]);
        };
        self.decided(row, None, duration)
    }

    fn decided(&self, row: &Measured, at: Option<usize>, duration: f64) -> Result<Decided, Vec<Diagnostic>> {
        let setting = row.setting().ok_or_else(|| {
            vec![Diagnostic::error(
                0..0,
                format!("{} has a setting that is not known: {}", self.place, row.setting),
            )]
        })?;
        let front = self.study.settings.iter().filter(|row| !row.dominated);
        Ok(Decided {
            setting,
            quantity: match at {
                Some(at) => self.study.observables[at].name.clone(),
                None => "the worst quantity".into(),
            },
            error: row.reliable(at),
            seconds: Some(row.seconds_per_second * duration),
            table: front
                .map(|row| {
                    let (error, time) = (row.reliable(at), row.seconds_per_second * duration);
                    format!("{}: {error:.2e}, {time:.3e} s of the clock", row.setting)
                })
                .collect(),
            step: None,
            against: Some(self.against(at)),
        })
    }

    /// What a run has to come to, in one quantity or in all.
    fn against(&self, at: Option<usize>) -> Against {
        let study = &self.study;
        let runs = match study.comparison {
            Comparison::Paths => 1.0,
            Comparison::Means => study.realisations as f64,
        };
        let count = |(index, _): &(usize, &Named)| at.is_none_or(|at| at == *index);
        let named: Vec<&Named> =
            study.observables.iter().enumerate().filter(count).map(|(_, named)| named).collect();
        Against {
            names: named.iter().map(|named| named.name.clone()).collect(),
            values: named.iter().map(|named| named.reference.clone()).collect(),
            scales: named.iter().map(|named| named.scale).collect(),
            scatter: named.iter().map(|named| named.relative_uncertainty * runs.sqrt()).collect(),
        }
    }
}
