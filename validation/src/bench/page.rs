//! The results as JSON and as a page.

use std::path::Path;

use granule_report::{Block, Cell, Document, Table};

use super::Report;

/// Writes `bench.json` and `bench.html` into a folder.
pub(super) fn write(report: &Report, folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let json = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
    save(&folder.join("bench.json"), &json)?;
    save(&folder.join("bench.html"), &document(report).to_html())
}

fn save(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

fn document(report: &Report) -> Document {
    let mut table = Table::new([
        "case",
        ">bodies",
        ">cores",
        ">ours [10^6/s]",
        "peer",
        ">peer [10^6/s]",
        ">ratio, least",
        ">ratio, median",
        ">bytes a body",
        ">share of copy bandwidth",
    ]);
    for row in &report.cases {
        table.push(vec![
            Cell::text(&row.case),
            Cell::text(row.n.to_string()),
            Cell::text(row.cores.to_string()),
            Cell::text(format!("{:.2}", row.ours_mps)),
            Cell::text(format!("{} ({})", row.peer, row.peer_version)),
            Cell::text(format!("{:.2}", row.peer_mps)),
            Cell::text(format!("{:.2}", row.ratio_min)),
            Cell::text(format!("{:.2}", row.ratio_median)),
            Cell::text(format!("{:.0}", row.bytes_per_particle)),
            Cell::text(format!("{:.2}", row.roofline_fraction)),
        ]);
    }
    let mut document = Document { title: "Speed".into(), blocks: Vec::new() };
    document.push(Block::Paragraph(format!(
        "Particle-steps a second of the loop alone, warm-up excluded, ours and the peer in turn on the same initial data. \
         Machine: {}. Copy bandwidth on all cores in the same run: {:.1} GB/s.",
        report.machine, report.copy_bandwidth_gb_s
    )));
    document.push(Block::Table(table));
    document
}
