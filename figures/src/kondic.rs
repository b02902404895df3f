//! The figures of Kondic 1999.

mod asymmetric;
mod collide;
mod compression;
mod regime;
mod symmetric;

use crate::{Chapter, Error, Figure};

/// The chapter.
pub const CHAPTER: Chapter = Chapter {
    name: "kondic",
    title: "The figures of Kondic 1999, computed",
    introduction: "L. Kondic, *Dynamics of spherical particles on a surface: Collision-induced sliding and other effects*, \
        Phys. Rev. E 60, 751 (1999). Steel spheres of radius 2 mm with μ_s = 0.5 and μ_k = 0.1 roll without slip, collide, slip, \
        and roll again. Lines are closed forms with the errata of the [table](kondic.md), markers are runs of granule with \
        `substrate`, `KondicNormal` and `KondicFriction`. Where a printed formula is a misprint, its line is dashed and named \
        `printed`.\n\nMade by `cargo xtask figures kondic --docs`.",
    figures,
};

fn figures() -> Result<Vec<Figure>, Error> {
    let mut figures = compression::figures()?;
    figures.extend(symmetric::figures()?);
    figures.extend(asymmetric::figures()?);
    figures.extend(regime::figures()?);
    Ok(figures)
}
