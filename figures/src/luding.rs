//! The figures of Luding 1998.

mod bounce;
mod damped;
mod oblique;

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
    let mut figures = Vec::new();
    figures.push(bounce::figure()?);
    figures.extend(damped::figures()?);
    figures.extend(oblique::figures()?);
    Ok(figures)
}
