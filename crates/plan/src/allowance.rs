//! What planning a scene may use, for scenes that somebody else wrote.

use std::ops::Range;
use std::path::PathBuf;

use granule_scene::Spanned;

use crate::build::Builder;
use crate::model::Plan;

/// Memory of a body in a plan and in the run that follows, its lists included \[bytes\]: what was measured of packings, with
/// a tenth to spare (docs/performance.md).
const PER_BODY: f64 = 950.0;
/// Memory of the program before any body \[bytes\].
const PROGRAM: f64 = 16.0 * 1024.0 * 1024.0;
/// Memory that reading a data file takes \[bytes for each of its bytes\]: its text, and a particle of 150 bytes for each line
/// of 20 at least.
const READING: f64 = 10.0;

/// Bounds of what a scene may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Most memory of plan and run together, as estimated beforehand \[bytes\].
    pub memory: u64,
    /// Which files a scene may read.
    pub files: DataFiles,
}

/// Which data files a scene may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataFiles {
    /// Any.
    Anywhere,
    /// Regular files in the folder of the scene or below it, after links are followed.
    BesideScene,
}

impl Allowance {
    /// No bounds but those of every plan.
    pub const UNBOUNDED: Self = Self { memory: u64::MAX, files: DataFiles::Anywhere };
}

impl Default for Allowance {
    fn default() -> Self {
        Self::UNBOUNDED
    }
}

/// About how much memory a plan and its run take \[bytes\]: measured bytes of a body in a packing times their number. Long
/// lists, as of large bodies among small ones, can take more.
pub fn memory_estimate(plan: &Plan) -> u64 {
    estimate(plan.bodies.len() as f64) as u64
}

fn estimate(bodies: f64) -> f64 {
    PROGRAM + PER_BODY * bodies
}

/// Bytes in words.
fn words(bytes: f64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let power = (0..UNITS.len() - 1).find(|power| bytes < 1024f64.powi(*power as i32 + 1));
    let power = power.unwrap_or(UNITS.len() - 1);
    let number = (bytes / 1024f64.powi(power as i32) * 10.0).round() / 10.0;
    format!("{number} {}", UNITS[power])
}

impl Builder<'_> {
    /// Whether `bodies` more bodies may be made; if not, the scene has an error at `span`.
    pub fn affords(&mut self, bodies: f64, span: &Range<usize>) -> bool {
        let needs = estimate(self.bodies + bodies);
        if needs <= self.allowance.memory as f64 {
            self.bodies += bodies;
            return true;
        }
        self.error_help(
            span.clone(),
            format!(
                "{:.0} bodies need about {} of memory, more than the {} that are allowed",
                self.bodies + bodies,
                words(needs),
                words(self.allowance.memory as f64)
            ),
            "fewer bodies, or a larger bound (`--max-memory`)",
        );
        false
    }

    /// Path of a data file, if the scene may read it; if not, the scene has an error.
    pub fn data_file(&mut self, file: &Spanned<String>) -> Option<PathBuf> {
        let path = self.base.join(&file.value);
        if self.allowance.files == DataFiles::BesideScene {
            // What does not exist is told by whoever opens it.
            if let (Ok(real), Ok(folder)) = (path.canonicalize(), self.base.canonicalize())
                && !real.starts_with(&folder)
            {
                self.error_help(
                    file.span.clone(),
                    format!("{} is outside of the folder of the scene", file.value),
                    "copy it beside the scene, or allow files anywhere (`--data-anywhere`)",
                );
                return None;
            }
            if path.metadata().is_ok_and(|about| !about.is_file() && !about.is_dir()) {
                self.error(file.span.clone(), format!("{} is no regular file", file.value));
                return None;
            }
        }
        let length = path.metadata().map_or(0, |about| about.len());
        let needs = PROGRAM + READING * length as f64;
        if needs > self.allowance.memory as f64 {
            self.error_help(
                file.span.clone(),
                format!(
                    "reading {} takes about {} of memory, more than the {} that are allowed",
                    file.value,
                    words(needs),
                    words(self.allowance.memory as f64)
                ),
                "a smaller file, or a larger bound (`--max-memory`)",
            );
            return None;
        }
        Some(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_in_words() {
        assert_eq!(words(100.0), "100 B");
        assert_eq!(words(1536.0), "1.5 KiB");
        assert_eq!(words(1024.0 * 1024.0 * 1024.0), "1 GiB");
        assert_eq!(words(9.4321e20), "857844497.7 TiB");
    }
}
