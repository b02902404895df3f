//! The machine that a run had.

use serde::{Deserialize, Serialize};

/// Processor and memory. What the system does not tell is absent.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Processor model as the system names it.
    pub processor: Option<String>,
    /// Physical cores.
    pub physical_cores: Option<usize>,
    /// Threads that this process may run at once.
    pub available_threads: Option<usize>,
    /// Memory in bytes.
    pub memory_bytes: Option<u64>,
    /// Operating system, such as `linux`.
    pub system: String,
    /// Processor family, such as `x86_64`.
    pub architecture: String,
}

impl Machine {
    /// This machine, from `/proc` where that exists.
    #[must_use]
    pub fn detect() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
        let cpuinfo = read("/proc/cpuinfo");
        Self {
            processor: processor(&cpuinfo),
            physical_cores: physical_cores(&cpuinfo),
            available_threads: std::thread::available_parallelism().ok().map(usize::from),
            memory_bytes: memory(&read("/proc/meminfo")),
            system: std::env::consts::OS.to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
        }
    }

    /// One line, such as `AMD EPYC 7763, 4 threads on 2 cores, 15.6 GiB, linux x86_64`.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut parts = vec![self.processor.clone().unwrap_or_else(|| "unknown processor".to_owned())];
        match (self.available_threads, self.physical_cores) {
            (Some(threads), Some(cores)) => parts.push(format!("{threads} thread(s) on {cores} core(s)")),
            (Some(threads), None) => parts.push(format!("{threads} thread(s)")),
            (None, Some(cores)) => parts.push(format!("{cores} core(s)")),
            (None, None) => {}
        }
        if let Some(bytes) = self.memory_bytes {
            parts.push(format!("{:.1} GiB", bytes as f64 / f64::from(1 << 30)));
        }
        parts.push(format!("{} {}", self.system, self.architecture));
        parts.join(", ")
    }
}

/// The value of the first line `key : value`.
fn field<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    fields(text, key).next()
}

fn fields<'a>(text: &'a str, key: &str) -> impl Iterator<Item = &'a str> {
    text.lines().filter_map(move |line| {
        let (name, value) = line.split_once(':')?;
        let value = value.trim();
        (name.trim() == key && !value.is_empty()).then_some(value)
    })
}

fn processor(cpuinfo: &str) -> Option<String> {
    // x86 says `model name`; some ARM boards `Model` or `Hardware`.
    ["model name", "Model", "Hardware"].into_iter().find_map(|key| field(cpuinfo, key)).map(str::to_owned)
}

/// Distinct pairs of socket and core.
fn physical_cores(cpuinfo: &str) -> Option<usize> {
    let cores: std::collections::BTreeSet<(String, String)> = cpuinfo
        .split("\n\n")
        .filter_map(|one| Some((field(one, "physical id")?.to_owned(), field(one, "core id")?.to_owned())))
        .collect();
    (!cores.is_empty()).then_some(cores.len())
}

fn memory(meminfo: &str) -> Option<u64> {
    let kibibytes: u64 = field(meminfo, "MemTotal")?.strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CPUINFO: &str = "processor\t: 0\nmodel name\t: Some CPU @ 2.10GHz\nphysical id\t: 0\ncore id\t\t: 0\n\n\
        processor\t: 1\nmodel name\t: Some CPU @ 2.10GHz\nphysical id\t: 0\ncore id\t\t: 0\n\n\
        processor\t: 2\nmodel name\t: Some CPU @ 2.10GHz\nphysical id\t: 0\ncore id\t\t: 1\n\n";

    #[test]
    fn proc_is_read() {
        assert_eq!(processor(CPUINFO).as_deref(), Some("Some CPU @ 2.10GHz"));
        assert_eq!(physical_cores(CPUINFO), Some(2));
        assert_eq!(memory("MemTotal:       16384 kB\nMemFree: 1 kB\n"), Some(16_777_216));
    }

    #[test]
    fn what_is_not_told_is_absent() {
        assert_eq!(processor(""), None);
        assert_eq!(physical_cores("processor : 0\nBogoMIPS : 50.00\n"), None);
        assert_eq!(memory("MemTotal: many kB"), None);
        let machine =
            Machine { system: "linux".into(), architecture: "riscv64".into(), ..Machine::default() };
        assert_eq!(machine.summary(), "unknown processor, linux riscv64");
    }

    #[test]
    fn this_machine_has_at_least_one_thread() {
        let machine = Machine::detect();
        assert!(machine.available_threads.is_none_or(|n| n >= 1));
        assert_eq!(machine.system, std::env::consts::OS);
    }
}
