//! The figures of Luding 1998.

mod bounce;
mod column;
mod damped;
mod hysteretic;
mod oblique;
mod scenes;

use crate::{Chapter, Error, Figure};

/// The chapter.
pub const CHAPTER: Chapter = Chapter {
    name: "luding",
    title: "The figures of Luding 1998, computed",
    introduction: "S. Luding, *Collisions & contacts between two particles*, in: Physics of dry granular media, NATO ASI \
        Series E 350 (1998). Lines are closed forms, markers are runs of granule through its registered laws. Where a \
        printed formula is a misprint, its line is dashed and named `printed`; the numbers of the errata are those of the \
        [table of the chapter](luding.md).\n\nMade by `cargo xtask figures luding --docs`.",
    figures,
};

fn figures() -> Result<Vec<Figure>, Error> {
    let mut figures = vec![bounce::figure()?];
    figures.extend(scenes::figures()?);
    figures.extend(damped::figures()?);
    figures.extend(oblique::figures()?);
    figures.push(hysteretic::figure()?);
    figures.sort_by_key(|figure| figure.name);
    figures.extend(column::figures()?);
    Ok(figures)
}
