//! The results as JSON and as a page.

use std::collections::BTreeMap;
use std::path::Path;

use granule_report::{Axis, Block, Cell, Document, Plot, Series, Table};

use super::{Details, Report};

/// Writes `bench.json`, `details.json`, and the page as `bench.md` and `bench.html` into a folder.
pub(super) fn write(report: &Report, details: &Details, folder: &Path) -> Result<(), String> {
    save_json(folder, "bench.json", report)?;
    save_json(folder, "details.json", details)?;
    let document = document(report, details)?;
    save(&folder.join("bench.md"), &document.to_markdown())?;
    save(&folder.join("bench.html"), &document.to_html())
}

/// Writes a value as JSON into a folder, which is made if it is not there.
pub(super) fn save_json(folder: &Path, name: &str, value: &impl serde::Serialize) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let text = serde_json::to_string_pretty(value).map_err(|error| error.to_string())?;
    save(&folder.join(name), &text)
}

fn save(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

fn document(report: &Report, details: &Details) -> Result<Document, String> {
    let mut document = Document { title: "Speed".into(), blocks: Vec::new() };
    let bandwidths: Vec<String> = details
        .copy_bandwidth
        .iter()
        .map(|(cores, bytes)| format!("{:.1} GB/s on {cores}", bytes / 1e9))
        .collect();
    document.push(Block::Paragraph(format!(
        "Particle-steps a second of the loop alone, warm-up excluded; ours and the peers in turn on the same initial data. On \
         one core a second is one of the processor, so that other programs do not count; on several, of the clock. \
         Machine: {}. Copy bandwidth in the same run, by cores: {}.",
        report.machine,
        bandwidths.join(", ")
    )));
    document.push(Block::Table(ratios(report)));
    for (title, plot) in [
        (
            "Ratio to the peers, median of all rounds, with the least as the lower end of the bar",
            ratio_plot(report),
        ),
        ("Speed over the number of bodies", growth_plot(report)),
    ] {
        let svg = plot.to_svg().map_err(|error| error.to_string())?;
        document.push(Block::Plot { svg, caption: title.into(), file: None });
    }
    document.push(Block::Heading { level: 2, text: "Our runs".into() });
    document.push(Block::Table(runs(details)));
    Ok(document)
}

fn ratios(report: &Report) -> Table {
    let mut table = Table::new([
        "case",
        ">bodies",
        ">cores",
        ">ours [10^6/s]",
        "peer",
        ">peer [10^6/s]",
        ">ratio, least",
        ">ratio, median",
        ">peak bytes a body",
        ">share of copy bandwidth",
    ]);
    let number = |value: Option<f64>| Cell::text(value.map_or(String::new(), |value| format!("{value:.2}")));
    for row in &report.cases {
        let peer = if row.peer_version.is_empty() {
            row.peer.clone()
        } else {
            format!("{} ({})", row.peer, row.peer_version)
        };
        table.push(vec![
            Cell::text(&row.case),
            Cell::text(row.n.to_string()),
            Cell::text(row.cores.to_string()),
            Cell::text(format!("{:.2}", row.ours_mps)),
            Cell::text(peer),
            number(row.peer_mps),
            number(row.ratio_min),
            number(row.ratio_median),
            Cell::text(format!("{:.0}", row.bytes_per_particle)),
            Cell::text(format!("{:.2}", row.roofline_fraction)),
        ]);
    }
    table
}

fn runs(details: &Details) -> Table {
    let mut table = Table::new([
        "case",
        ">cores",
        ">steps",
        ">coordination",
        ">lists",
        ">forces",
        ">integration",
        ">working bytes a body",
        ">ns a contact",
        ">start [s]",
        ">.vtp, raw and compressed [s]",
        "peers",
        ">peak bytes a body",
    ]);
    for detail in &details.cases {
        let share = |phase: usize| {
            Cell::text(format!("{:.1} %", 100.0 * detail.ours.phases[phase] / detail.ours.seconds))
        };
        let peers: Vec<String> =
            detail.peers.iter().map(|peer| format!("{}: {}", peer.peer, peer.tuning)).collect();
        let peaks: Vec<String> = detail
            .peers
            .iter()
            .filter_map(|peer| Some(format!("{:.0}", peer.peak_bytes? as f64 / detail.n as f64)))
            .collect();
        table.push(vec![
            Cell::text(&detail.case),
            Cell::text(detail.cores.to_string()),
            Cell::text(detail.steps.to_string()),
            Cell::text(format!("{:.2}", detail.ours.coordination)),
            share(0),
            share(1),
            share(2),
            Cell::text(format!("{:.0}", detail.ours.working_bytes / detail.n as f64)),
            Cell::text(format!(
                "{:.1}",
                1e9 * detail.ours.processor_seconds.unwrap_or(detail.ours.seconds)
                    / (detail.steps as f64 * detail.ours.contacts)
            )),
            Cell::text(format!("{:.2}", detail.ours.start_seconds)),
            Cell::text(
                detail.ours.vtp_seconds.map_or(String::new(), |[raw, zlib]| format!("{raw:.2}, {zlib:.2}")),
            ),
            Cell::text(peers.join("; ")),
            // Of several ranks only one is seen, which says nothing.
            Cell::text(if detail.cores == 1 { peaks.join("; ") } else { String::new() }),
        ]);
    }
    table
}

/// Ratios by the number of the row in the table: one series a peer and number of cores.
fn ratio_plot(report: &Report) -> Plot {
    let mut series: BTreeMap<(String, usize), [Vec<f64>; 3]> = BTreeMap::new();
    let mut names: Vec<&str> = Vec::new();
    for row in &report.cases {
        if names.last() != Some(&row.case.as_str()) {
            names.push(&row.case);
        }
        if let (Some(least), Some(median)) = (row.ratio_min, row.ratio_median) {
            let entry = series.entry((row.peer.clone(), row.cores)).or_default();
            entry[0].push(names.len() as f64);
            entry[1].push(median);
            entry[2].push(median - least);
        }
    }
    let label = names.iter().enumerate().map(|(index, name)| format!("{} {name}", index + 1));
    let label = format!("case ({})", label.collect::<Vec<_>>().join(", "));
    let mut plot = Plot::new("Ours over the peer", Axis::linear(label), Axis::linear("ratio"));
    for ((peer, cores), [x, y, error]) in series {
        plot = plot.with(Series::points(format!("{peer}, {cores} core(s)"), x, y).with_error(error));
    }
    plot.with_size(900.0, 460.0)
}

/// Speed by the number of bodies: one series a program, kind of case and number of cores, where there are two sizes.
fn growth_plot(report: &Report) -> Plot {
    let mut series: BTreeMap<String, (Vec<f64>, Vec<f64>)> = BTreeMap::new();
    for row in &report.cases {
        let kind: Vec<&str> =
            row.case.split('-').filter(|word| !word.starts_with(|c: char| c.is_ascii_digit())).collect();
        let kind = format!("{}, {} core(s)", kind.join(" "), row.cores);
        let mut add = |name: String, speed: f64| {
            let (x, y) = series.entry(name).or_default();
            if x.last() != Some(&(row.n as f64)) {
                x.push(row.n as f64);
                y.push(speed);
            }
        };
        add(format!("granule {kind}"), row.ours_mps);
        if let Some(speed) = row.peer_mps {
            add(format!("{} {kind}", row.peer), speed);
        }
    }
    let mut plot = Plot::new("Speed", Axis::log("bodies"), Axis::log("10^6 particle-steps / s"));
    for (name, (x, y)) in series {
        if x.len() > 1 {
            plot = plot.with(Series::line(name, x, y));
        }
    }
    plot.with_size(900.0, 460.0)
}
