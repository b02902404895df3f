//! Differences between models, and the result as JSON.

use serde_json::{Value, json as object};

use super::{Model, Sample};

/// How far a model is from the reference in one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Mean over the runs; for paths the largest component.
    pub value: f64,
    /// Largest difference of a component over the largest component of the reference.
    pub error: f64,
    /// Standard error of that by the scatter of the runs; 0 for paths.
    pub bar: f64,
}

/// One model that was run.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The model.
    pub model: Model,
    /// Wall-clock time for a simulated second, on one thread.
    pub cost: f64,
    /// Differences from the reference, one a quantity.
    pub differences: Vec<Difference>,
    /// What it does otherwise than the scene says.
    pub notes: Vec<String>,
}

/// All models of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelComparison {
    /// Title of the scene.
    pub title: String,
    /// Bodies.
    pub bodies: usize,
    /// Simulated time of every run \[s\].
    pub duration: f64,
    /// Runs of each model.
    pub realisations: u64,
    /// Bodies are compared one by one at the end; else means over the last half of the run.
    pub paths: bool,
    /// Names and units of the quantities.
    pub quantities: Vec<(&'static str, &'static str)>,
    /// What the others are compared with: the most detailed model that ran.
    pub reference: Option<Model>,
    /// The models that ran, the most detailed first.
    pub models: Vec<Compared>,
    /// Models that the scene cannot be run in, with the reason.
    pub left_out: Vec<(Model, String)>,
}

/// Fills in the models. The first one is the reference.
pub(super) fn compare(
    mut comparison: ModelComparison,
    samples: &[(Model, Vec<String>, Vec<Sample>)],
) -> ModelComparison {
    let Some((_, _, reference)) = samples.first() else { return comparison };
    for (model, notes, of_model) in samples {
        let differences = comparison
            .quantities
            .iter()
            .enumerate()
            .map(|(index, (quantity, unit))| {
                let (mean, here) = statistics(of_model, index);
                let (expected, there) = statistics(reference, index);
                let scale = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                let off = mean.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                let bar = (here * here + there * there).sqrt();
                let over = |value: f64| if value == 0.0 { 0.0 } else { value / scale };
                Difference {
                    quantity,
                    unit,
                    value: mean.iter().fold(0.0, |most: f64, value| most.max(value.abs())),
                    error: over(off),
                    bar: over(bar),
                }
            })
            .collect();
        let cost = of_model.iter().map(|sample| sample.cost).sum::<f64>() / of_model.len() as f64;
        comparison.models.push(Compared { model: *model, cost, differences, notes: notes.clone() });
    }
    comparison
}

/// Means of the components of a quantity, and the largest standard error.
fn statistics(samples: &[Sample], quantity: usize) -> (Vec<f64>, f64) {
    let count = samples.len() as f64;
    let components = samples.first().map_or(0, |sample| sample.values[quantity].len());
    let mut means = Vec::with_capacity(components);
    let mut largest: f64 = 0.0;
    for component in 0..components {
        let of = |sample: &Sample| sample.values[quantity][component];
        let mean = samples.iter().map(of).sum::<f64>() / count;
        if samples.len() > 1 {
            let squares: f64 = samples.iter().map(|sample| (of(sample) - mean).powi(2)).sum();
            largest = largest.max((squares / (count - 1.0) / count).sqrt());
        }
        means.push(mean);
    }
    (means, largest)
}

/// The comparison as JSON.
pub fn models_json(comparison: &ModelComparison) -> Value {
    let models: Vec<Value> = comparison
        .models
        .iter()
        .map(|compared| {
            let differences: Vec<Value> = compared
                .differences
                .iter()
                .map(|difference| {
                    object!({
                        "quantity": difference.quantity,
                        "unit": difference.unit,
                        "value": difference.value,
                        "difference": difference.error,
                        "standard_error": difference.bar,
                    })
                })
                .collect();
            object!({
                "model": compared.model.name(),
                "description": compared.model.words(),
                "seconds_per_simulated_second": compared.cost,
                "differences": differences,
                "notes": compared.notes,
            })
        })
        .collect();
    let left_out: Vec<Value> = comparison
        .left_out
        .iter()
        .map(|(model, reason)| object!({ "model": model.name(), "reason": reason }))
        .collect();
    object!({
        "title": comparison.title,
        "bodies": comparison.bodies,
        "duration": comparison.duration,
        "runs": comparison.realisations,
        "compared": if comparison.paths { "paths at the end" } else { "means" },
        "reference": comparison.reference.map(Model::name),
        "models": models,
        "left_out": left_out,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_relative_to_the_largest_component_and_have_standard_errors() {
        let sample = |values: &[f64], cost: f64| Sample { values: vec![values.to_vec()], cost };
        let empty = ModelComparison {
            title: String::new(),
            bodies: 2,
            duration: 1.0,
            realisations: 2,
            paths: false,
            quantities: vec![("speed", "m/s")],
            reference: Some(Model::Contact),
            models: Vec::new(),
            left_out: Vec::new(),
        };
        let samples = [
            (Model::Contact, Vec::new(), vec![sample(&[4.0, -10.0], 3.0), sample(&[4.0, -10.0], 5.0)]),
            (Model::Arcs, Vec::new(), vec![sample(&[5.0, -9.0], 1.0), sample(&[7.0, -11.0], 1.0)]),
        ];
        let found = compare(empty, &samples);
        assert_eq!((found.models[0].cost, found.models[0].differences[0].error), (4.0, 0.0));
        let arcs = &found.models[1].differences[0];
        assert!((arcs.error - 0.2).abs() < 1e-15 && (arcs.bar - 0.1).abs() < 1e-15, "{arcs:?}");
        let json = models_json(&found).to_string();
        assert!(json.contains("\"seconds_per_simulated_second\":4.0"), "{json}");
    }
}
