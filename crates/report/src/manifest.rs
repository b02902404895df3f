//! The manifest: what ran, where, how long, and what it wrote. It lies beside the outputs of a run.

use crate::document::{Cell, Table};
use crate::{Machine, ReportError, format_duration, format_number};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

/// The record of one run, as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The program and its version, such as `granule 0.1.0`.
    pub program: String,
    /// How the program was built.
    pub build: Build,
    /// Fingerprint of the plan, the same that the outputs carry.
    pub plan_fingerprint: String,
    /// The plan as text, as `granule explain` prints it; may be empty.
    pub plan: String,
    /// The scene; absent for a run that was set up in code.
    pub scene: Option<SceneRecord>,
    /// Where it ran.
    pub machine: Machine,
    /// Worker threads used.
    pub threads: usize,
    /// Beginning of the run in UTC as RFC 3339 text, see [`crate::rfc3339`].
    pub started: String,
    /// Wall-clock time of the whole run in seconds.
    pub duration_s: f64,
    /// Time by phase, in the order in which the program reports them.
    pub phases: Vec<Phase>,
    /// Sizes of the run.
    pub counts: Counts,
    /// Simulated time reached, in seconds.
    pub simulated_time_s: f64,
    /// How the run ended, such as `completed` or `stopped by the user`.
    pub outcome: String,
    /// Files written, in the order of their creation.
    pub outputs: Vec<OutputFile>,
    /// Hash of the final state: two runs with one hash have the same bits.
    pub result_hash: Option<String>,
}

/// How the program was built. Nothing of this needs the repository.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Build {
    /// Compiler, such as `rustc 1.95.0 (…)`.
    pub rustc: String,
    /// Target triple.
    pub target: String,
    /// Cargo profile.
    pub profile: String,
    /// Optimisation level.
    pub opt_level: String,
}

impl Build {
    /// The build of this program.
    #[must_use]
    pub fn current() -> Self {
        Self {
            rustc: env!("GRANULE_RUSTC_VERSION").to_owned(),
            target: env!("GRANULE_TARGET").to_owned(),
            profile: env!("GRANULE_PROFILE").to_owned(),
            opt_level: env!("GRANULE_OPT_LEVEL").to_owned(),
        }
    }
}

/// The scene file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneRecord {
    /// Its path as the user gave it.
    pub path: String,
    /// Hash of its text, see [`text_hash`].
    pub hash: String,
}

impl SceneRecord {
    /// The record of a scene with this text.
    #[must_use]
    pub fn new(path: impl Into<String>, text: &str) -> Self {
        Self { path: path.into(), hash: text_hash(text) }
    }
}

/// Time spent in one phase.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// Its name.
    pub name: String,
    /// Seconds, all calls together.
    pub seconds: f64,
    /// Number of calls.
    pub count: u64,
}

/// Sizes of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Bodies.
    pub bodies: u64,
    /// Contacts at the end.
    pub contacts: u64,
    /// Time steps, or events of an event-driven run.
    pub steps: u64,
}

/// A file written by the run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Path relative to the manifest where possible.
    pub path: String,
    /// Kind, such as `csv`.
    pub kind: String,
    /// Size in bytes.
    pub bytes: u64,
}

/// `xxh3:` and 16 hexadecimal digits of XXH3-64 over the UTF-8 bytes.
#[must_use]
pub fn text_hash(text: &str) -> String {
    format!("xxh3:{:016x}", xxh3_64(text.as_bytes()))
}

impl Manifest {
    /// The manifest as indented JSON, ending with a newline.
    ///
    /// # Errors
    /// A time that is not finite, because JSON has no number for it.
    pub fn to_json(&self) -> Result<String, ReportError> {
        let times = [("duration_s", self.duration_s), ("simulated_time_s", self.simulated_time_s)];
        let phases = self.phases.iter().map(|p| (p.name.as_str(), p.seconds));
        for (index, (what, value)) in times.into_iter().chain(phases).enumerate() {
            if !value.is_finite() {
                return Err(ReportError::NotFinite { what: format!("manifest time `{what}`"), index });
            }
        }
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads a manifest.
    ///
    /// # Errors
    /// Text that is not JSON, or lacks a field, or has one that this version does not know.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        Ok(serde_json::from_str(text)?)
    }

    /// What a reader wants to know first, as rows of name and value.
    #[must_use]
    pub fn summary_table(&self) -> Table {
        let mut table = Table::new(["", ""]);
        let mut row = |name: &str, value: String| table.push(vec![Cell::text(name), Cell::Text(value)]);
        row("program", self.program.clone());
        row(
            "built with",
            format!("{}, {} (opt-level {})", self.build.rustc, self.build.profile, self.build.opt_level),
        );
        row("machine", self.machine.summary());
        row("threads", self.threads.to_string());
        if let Some(scene) = &self.scene {
            row("scene", format!("{} ({})", scene.path, scene.hash));
        }
        row("plan", self.plan_fingerprint.clone());
        row("started", self.started.clone());
        row("duration", format_duration(self.duration_s));
        row("outcome", self.outcome.clone());
        row("simulated time", format!("{} s", format_number(self.simulated_time_s, 6)));
        row("bodies", self.counts.bodies.to_string());
        row("contacts at the end", self.counts.contacts.to_string());
        row("steps", self.counts.steps.to_string());
        if let Some(rate) = self.body_steps_per_second() {
            row("body-steps per second", format_number(rate, 3));
        }
        for file in &self.outputs {
            row("output", format!("{} ({}, {} bytes)", file.path, file.kind, file.bytes));
        }
        if let Some(hash) = &self.result_hash {
            row("result hash", hash.clone());
        }
        table
    }

    /// Phases with their share of the whole duration; what no phase accounts for is the last row.
    #[must_use]
    pub fn phase_table(&self) -> Table {
        let mut table = Table::new(["phase", ">time", ">share", ">calls", ">per call"]);
        let share = |seconds: f64| {
            if self.duration_s > 0.0 {
                format!("{:.1} %", 100.0 * seconds / self.duration_s)
            } else {
                "-".to_owned()
            }
        };
        for phase in &self.phases {
            let per_call = if phase.count > 0 {
                format_duration(phase.seconds / phase.count as f64)
            } else {
                "-".to_owned()
            };
            table.push(vec![
                Cell::text(&phase.name),
                Cell::Text(format_duration(phase.seconds)),
                Cell::Text(share(phase.seconds)),
                Cell::Text(phase.count.to_string()),
                Cell::Text(per_call),
            ]);
        }
        let rest = self.duration_s - self.phases.iter().map(|p| p.seconds).sum::<f64>();
        if !self.phases.is_empty() && rest > 0.0 {
            table.push(vec![Cell::text("other"), Cell::Text(format_duration(rest)), Cell::Text(share(rest))]);
        }
        table
    }

    /// Both tables as text for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = self.summary_table().to_text();
        if !self.phases.is_empty() {
            text.push('\n');
            text.push_str(&self.phase_table().to_text());
        }
        text
    }

    /// Bodies times steps over the duration; `None` if nothing was timed.
    #[must_use]
    pub fn body_steps_per_second(&self) -> Option<f64> {
        let work = self.counts.bodies as f64 * self.counts.steps as f64;
        (self.duration_s > 0.0 && work > 0.0).then(|| work / self.duration_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Manifest {
        Manifest {
            program: "granule 0.1.0".into(),
            build: Build::current(),
            plan_fingerprint: "0123456789abcdef".into(),
            plan: "soft spheres".into(),
            scene: Some(SceneRecord::new("scene.ron", "(version: 1)")),
            machine: Machine { processor: Some("CPU".into()), ..Machine::default() },
            threads: 2,
            started: "2026-11-23T02:52:55Z".into(),
            duration_s: 0.1 + 0.2,
            phases: vec![
                Phase { name: "contacts".into(), seconds: 0.21, count: 1000 },
                Phase { name: "search".into(), seconds: 0.06, count: 10 },
            ],
            counts: Counts { bodies: 500, contacts: 1200, steps: 1000 },
            simulated_time_s: 0.01,
            outcome: "completed".into(),
            outputs: vec![OutputFile { path: "out.csv".into(), kind: "csv".into(), bytes: 77 }],
            result_hash: None,
        }
    }

    #[test]
    fn json_is_read_back_bit_for_bit() {
        let manifest = sample();
        let json = manifest.to_json().unwrap();
        assert_eq!(Manifest::from_json(&json).unwrap(), manifest);
        assert!(json.contains("\"duration_s\": 0.30000000000000004"));
        assert!(json.ends_with("}\n"));
    }

    #[test]
    fn wrong_json_is_an_error() {
        let json = sample().to_json().unwrap();
        assert!(Manifest::from_json("{}").unwrap_err().to_string().contains("missing field"));
        let extra = json.replacen('{', "{\"colour\": 1,", 1);
        assert!(Manifest::from_json(&extra).unwrap_err().to_string().contains("unknown field `colour`"));
        let endless = Manifest { duration_s: f64::INFINITY, ..sample() };
        assert!(endless.to_json().unwrap_err().to_string().contains("`duration_s`"));
    }

    #[test]
    fn the_hash_is_xxh3() {
        // XXH3-64 of nothing, from the reference implementation's test vectors.
        assert_eq!(text_hash(""), "xxh3:2d06800538d394c2");
        assert_ne!(text_hash("a"), text_hash("b"));
    }

    #[test]
    fn the_build_is_known() {
        assert!(Build::current().rustc.starts_with("rustc "), "{:?}", Build::current());
        assert!(Build::current().target.contains('-'));
    }

    #[test]
    fn shares_add_up_with_the_rest() {
        let text = sample().to_text();
        for wanted in ["70.0 %", "20.0 %", "other", "10.0 %", "210 µs", "body-steps per second  1.67e6"] {
            assert!(text.contains(wanted), "{wanted} not in\n{text}");
        }
        assert_eq!(sample().body_steps_per_second(), Some(500.0 * 1000.0 / (0.1 + 0.2)));
    }
}
