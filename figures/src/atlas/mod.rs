//! The stability atlas: where a contact is integrated rightly, and what happens where it is not.
//!
//! [`make`] computes the maps of every law and integrator, writes them as SVG and JSON, and the page that explains them. The
//! limits of `granule-plan` are drawn into them; tests hold that no scene that a plan accepts lies in an unstable place.

mod impact;
mod laws;
mod oblique;
mod packing;
mod page;

use std::path::Path;

use granule_plan::Plan;
use granule_report::{ClassMap, Colour, MapClass, MapLine};
use serde_json::{Value, json};

use crate::Error;

pub use impact::{needed_steps, steps_and_damping};
pub use laws::{NORMAL, NormalLaw, SCHEMES, TANGENTIAL, TangentialLaw};
pub use packing::{Coordination, Limit, limit};

/// What became of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// As it must be.
    Stable,
    /// Finite and without new energy, but the bodies part with a velocity that is off by more than 5 % of the impact speed.
    WrongRestitution,
    /// The bodies have passed through each other.
    Tunnelled,
    /// There is more energy than before, by more than 1 %.
    EnergyGained,
    /// Some number is no longer finite.
    NotFinite,
}

impl Class {
    /// All of them, in the order of the legend.
    pub const ALL: [Self; 5] =
        [Self::Stable, Self::WrongRestitution, Self::Tunnelled, Self::EnergyGained, Self::NotFinite];

    /// Name in pictures and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::WrongRestitution => "wrong restitution",
            Self::Tunnelled => "tunnelled",
            Self::EnergyGained => "energy gained",
            Self::NotFinite => "not finite",
        }
    }

    fn colour(self) -> Colour {
        match self {
            Self::Stable => Colour::PALETTE[2],
            Self::WrongRestitution => Colour::PALETTE[4],
            Self::Tunnelled => Colour::PALETTE[3],
            Self::EnergyGained => Colour::PALETTE[1],
            Self::NotFinite => Colour::new(0x33, 0x33, 0x33),
        }
    }
}

/// One map with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Name of its files.
    pub name: String,
    /// Title.
    pub title: String,
    /// Horizontal axis: label and values.
    pub x: (&'static str, Vec<f64>),
    /// Vertical axis: label and values, from the bottom.
    pub y: (&'static str, Vec<f64>),
    /// Class of each cell, rows from the bottom.
    pub cells: Vec<Vec<Class>>,
    /// Lines: name, and the value of the horizontal axis where it crosses each row.
    pub lines: Vec<(&'static str, Vec<Option<f64>>)>,
}

impl Map {
    /// As a picture.
    fn picture(&self) -> ClassMap {
        let shown = |values: &[f64]| values.iter().map(|value| short(*value)).collect();
        ClassMap {
            title: self.title.clone(),
            x_label: self.x.0.into(),
            x: shown(&self.x.1),
            y_label: self.y.0.into(),
            y: shown(&self.y.1),
            classes: Class::ALL
                .map(|class| MapClass { name: class.name().into(), colour: class.colour() })
                .to_vec(),
            cells: self.cells.iter().map(|row| row.iter().map(|class| *class as usize).collect()).collect(),
            lines: self
                .lines
                .iter()
                .map(|(name, values)| MapLine {
                    name: (*name).into(),
                    columns: values.iter().map(|value| value.map(|value| column(&self.x.1, value))).collect(),
                })
                .collect(),
        }
    }

    fn json(&self) -> Value {
        let names: Vec<Vec<&str>> =
            self.cells.iter().map(|row| row.iter().map(|class| class.name()).collect()).collect();
        let lines: Vec<Value> =
            self.lines.iter().map(|(name, at)| json!({ "name": name, "x": at })).collect();
        json!({
            "name": self.name, "title": self.title,
            "x": { "label": self.x.0, "values": self.x.1 }, "y": { "label": self.y.0, "values": self.y.1 },
            "cells": names, "lines": lines,
        })
    }
}

/// A number in at most about five letters.
fn short(value: f64) -> String {
    if value == 0.0 || (0.01..1e4).contains(&value.abs()) {
        let rounded = format!("{value:.2}");
        rounded.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        format!("{value:.0e}")
    }
}

/// Where a value lies between the middles of columns of ascending values, geometrically.
fn column(values: &[f64], value: f64) -> f64 {
    let last = values.len().saturating_sub(1);
    let after = values.iter().position(|other| *other >= value);
    match after {
        Some(0) => 0.0,
        None => last as f64 + 1.0,
        Some(at) => {
            let (low, high) = (values[at - 1], values[at]);
            let share =
                if low > 0.0 { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) };
            at as f64 - 0.5 + share
        }
    }
}

/// Plans a scene, with its time step replaced afterwards by `step` of the plan.
fn planned(text: &str, step: impl FnOnce(&Plan) -> f64) -> Result<Plan, Error> {
    let mut plan = crate::simulate::owned_plan(text)?;
    plan.driver.step = step(&plan);
    Ok(plan)
}

/// Makes the atlas. With `docs` the page and the pictures that it shows go into docs/, everything else into
/// target/atlas. `quick` leaves out all integrators but the default one and every second row of the maps.
///
/// # Errors
/// A scene cannot be planned, or a file not written.
pub fn make(quick: bool, docs: bool) -> Result<(), Error> {
    let mut maps = Vec::new();
    let schemes = if quick { &SCHEMES[..1] } else { &SCHEMES[..] };
    for scheme in schemes {
        for law in NORMAL {
            maps.push(steps_and_damping(law, scheme, quick)?);
            maps.push(packing::steps_and_damping(law, scheme, quick)?);
        }
        for law in TANGENTIAL {
            maps.push(oblique::friction_and_angle(law, scheme, quick)?);
        }
    }
    for law in NORMAL {
        maps.push(impact::mass_and_stiffness(law, quick)?);
        maps.push(impact::size_and_steps(law, quick)?);
    }
    let mut limits = Vec::new();
    for scheme in schemes {
        for law in NORMAL {
            for damping in [0.0, 0.1, 0.5] {
                for coordination in Coordination::ALL {
                    limits.push(limit(law, scheme, damping, coordination)?);
                }
            }
        }
    }
    let needed: Vec<(&str, f64)> = NORMAL
        .iter()
        .map(|law| needed_steps(law).map(|steps| (law.name, steps)))
        .collect::<Result<_, Error>>()?;
    let folder = Path::new("target/atlas");
    std::fs::create_dir_all(folder)?;
    for map in &maps {
        std::fs::write(folder.join(format!("{}.svg", map.name)), map.picture().to_svg()?)?;
    }
    let numbers = json!({
        "maps": maps.iter().map(Map::json).collect::<Vec<_>>(),
        "limits": limits.iter().map(Limit::json).collect::<Vec<_>>(),
        "steps_for_five_percent": needed.iter().map(|(law, steps)| json!({ "law": law, "steps": steps })).collect::<Vec<_>>(),
    });
    std::fs::write(folder.join("atlas.json"), serde_json::to_string_pretty(&numbers)?)?;
    println!("{} maps, {} limits: {}", maps.len(), limits.len(), folder.join("atlas.json").display());
    if docs {
        let pictures = Path::new("docs/figures/atlas");
        std::fs::create_dir_all(pictures)?;
        for map in maps.iter().filter(|map| page::SHOWN.contains(&map.name.as_str())) {
            std::fs::write(pictures.join(format!("{}.svg", map.name)), map.picture().to_svg()?)?;
        }
        std::fs::write("docs/atlas.md", page::page(&maps, &limits, &needed))?;
        println!("docs/atlas.md");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
