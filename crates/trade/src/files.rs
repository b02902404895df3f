//! What a trade leaves in its folder.

use std::path::{Path, PathBuf};

use granule_formats::atomic;
use granule_law_api::Registry;

use crate::{Study, TradeError, chosen_scene, document, front_plot, json};

/// Writes the page, the figure, the numbers, and the scene with the chosen setting, each whole or not at all. Gives the
/// files back. `text` is the scene, which lies `beside`.
///
/// # Errors
/// A file cannot be written, a figure not drawn, or the choice not written into the scene.
pub fn write(
    study: &Study,
    text: &str,
    registry: &Registry,
    beside: &Path,
    folder: &Path,
) -> Result<Vec<PathBuf>, TradeError> {
    let failed = |error: &dyn std::fmt::Display| TradeError::File(error.to_string());
    let page = document(study).map_err(|error| failed(&error))?;
    let figure = front_plot(study).to_svg().map_err(|error| failed(&error))?;
    let numbers = serde_json::to_string_pretty(&json(study)).map_err(|error| failed(&error))?;
    let mut files =
        vec![("trade.html", page.to_html()), ("front.svg", figure), ("trade.json", numbers + "\n")];
    if let Some(at) = study.chosen {
        let setting = &study.settings[at].setting;
        let scene = chosen_scene(text, setting, registry, beside).map_err(TradeError::Scene)?;
        let header = format!(
            "// Chosen by `granule trade` for a relative error of {}: {}.\n",
            study.target,
            setting.label()
        );
        files.push(("chosen.ron", header + &scene));
    }
    files
        .into_iter()
        .map(|(name, content)| {
            let path = folder.join(name);
            atomic::write(&path, content.as_bytes()).map_err(|error| failed(&error))?;
            Ok(path)
        })
        .collect()
}
