//! Reports of a run: plots, pictures, pages, statistics, the run manifest and the validation verdict.
//!
//! Everything here takes plain data and gives text. Nothing runs a simulation, nothing reads a scene.
//!
//! | Subject | Start at |
//! |---|---|
//! | A figure with axes | [`Plot`], [`Plot::to_svg`] |
//! | A map of classes | [`ClassMap`], [`ClassMap::to_svg`] |
//! | A picture of the spheres | [`ScenePicture`], [`ScenePicture::to_svg`] |
//! | A page or a log | [`Document`], [`Document::to_html`], [`Document::to_markdown`] |
//! | What ran, where, how long | [`Manifest`] |
//! | Do two sets of runs differ | [`statistics`] |
//! | The verdict of a validation | [`verdict`] |

mod colour;
mod document;
mod error;
mod html;
mod machine;
mod manifest;
mod map;
mod markdown;
mod number;
mod picture;
mod plot;
pub mod statistics;
mod svg;
mod time;
pub mod verdict;

pub use colour::{Colour, viridis};
pub use document::{Align, Block, Cell, Column, Document, Status, Table};
pub use error::ReportError;
pub use machine::Machine;
pub use manifest::{Build, Counts, Manifest, OutputFile, Phase, SceneRecord, text_hash};
pub use map::{ClassMap, MapClass, MapLine};
pub use number::{format_duration, format_number};
pub use picture::{ScenePicture, View};
pub use plot::{Axis, Plot, Scale, Series, SkippedPoints, Style};
pub use time::rfc3339;
