//! The pages of docs/ that are made from what the program knows about itself: `cargo xtask pages` writes them, and a test
//! compares them with the files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granule_law_api::{
    CollisionEntry, ContactEnd, Form, LawEntry, LawInfo, ParamSpec, Params, Registry, Slot, Source,
    SubstrateEntry,
};

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs");

/// The folder docs/ of this project.
pub fn docs() -> &'static Path {
    Path::new(DOCS)
}

/// Every generated page: its path in docs/ and its text, ordered by path.
pub fn pages(registry: &Registry) -> Vec<(PathBuf, String)> {
    let mut pages = vec![
        (PathBuf::from("laws/README.md"), index(registry)),
        (PathBuf::from("scene.md"), granule_scene::manual()),
    ];
    for law in registry.entries() {
        pages.push((Path::new("laws").join(format!("{}.md", law.info.name)), page(law)));
    }
    for law in registry.substrates() {
        pages.push((Path::new("laws").join(format!("{}.md", law.info.name)), substrate_page(law)));
    }
    for law in registry.collisions() {
        pages.push((Path::new("laws").join(format!("{}.md", law.info.name)), collision_page(law)));
    }
    pages.sort();
    pages
}

/// The table of all laws.
fn index(registry: &Registry) -> String {
    let mut out = "# Contact laws\n\nThe laws that granule ships, in the order in which a contact runs them. `granule laws NAME` \
                   shows the same pages,\nand those of laws that other programs add.\n\n\
                   | law | slot | what it models |\n|---|---|---|\n"
        .to_string();
    for slot in Slot::ALL {
        for law in registry.entries().iter().filter(|law| law.info.slot == slot) {
            let LawInfo { name, summary, .. } = law.info;
            // Writing to a string cannot fail.
            let _ = writeln!(out, "| [{name}]({name}.md) | {} | {} |", slot.name(), cell(summary));
        }
    }
    for law in registry.substrates() {
        let _ = writeln!(out, "| [{0}]({0}.md) | substrate | {1} |", law.info.name, cell(law.info.summary));
    }
    for law in registry.collisions() {
        let _ = writeln!(out, "| [{0}]({0}.md) | collision | {1} |", law.info.name, cell(law.info.summary));
    }
    out
}

/// The page of one collision law.
fn collision_page(law: &CollisionEntry) -> String {
    let info = law.info;
    let mut out = format!(
        "# {}\n\nA law of instantaneous collisions, from the crate `{}`. {}\n\n## Formula\n\n```text\n{}\n```\n",
        info.name, law.crate_name, info.summary, info.formula
    );
    parameters(&mut out, info.parameters);
    out.push_str(WAYS);
    for form in info.forms {
        way(&mut out, form, false);
    }
    sources(&mut out, info.sources);
    out
}

/// The page of one substrate law.
fn substrate_page(law: &SubstrateEntry) -> String {
    let info = law.info;
    let mut out = format!(
        "# {}\n\nA law of the substrate, from the crate `{}`. {}\n\n## Formula\n\n```text\n{}\n```\n",
        info.name, law.crate_name, info.summary, info.formula
    );
    parameters(&mut out, info.parameters);
    out.push_str(WAYS);
    for form in info.forms {
        way(&mut out, form, false);
    }
    sources(&mut out, info.sources);
    out
}

/// The page of one law.
fn page(law: &LawEntry) -> String {
    let info = law.info;
    let mut out = format!(
        "# {}\n\nA {} law, from the crate `{}`. {}\n\n## Formula\n\n```text\n{}\n```\n",
        info.name,
        info.slot.name(),
        law.crate_name,
        info.summary,
        info.formula
    );
    parameters(&mut out, info.parameters);
    out.push_str(WAYS);
    for (index, form) in info.forms.iter().enumerate() {
        way(&mut out, form, may_create_energy(law, index));
    }
    out.push_str("\n## Contact\n\n");
    contact(&mut out, law);
    sources(&mut out, info.sources);
    out
}

const WAYS: &str = "\n## Ways to give them\n\n| parameters | meaning |\n|---|---|\n";

fn parameters(out: &mut String, specs: &[&ParamSpec]) {
    out.push_str("\n## Parameters\n\n| name | symbol | unit | allowed | meaning |\n|---|---|---|---|---|\n");
    for spec in specs {
        parameter(out, spec);
    }
}

fn sources(out: &mut String, sources: &[Source]) {
    out.push_str("\n## Sources\n\n");
    for source in sources {
        let note = if source.note.is_empty() { String::new() } else { format!(": {}", source.note) };
        // Writing to a string cannot fail.
        let _ = writeln!(out, "- {}, {}{note}", source.work, source.place);
    }
}

fn parameter(out: &mut String, spec: &ParamSpec) {
    let _ = writeln!(
        out,
        "| `{}` | {} | {} | {} | {} |",
        spec.name,
        cell(spec.symbol),
        spec.dimension,
        spec.range.describe(),
        cell(spec.doc)
    );
}

/// True if a law that promises never to create energy cannot promise it in this form.
fn may_create_energy(law: &LawEntry, form: usize) -> bool {
    let mut examples = law.info.examples.iter().filter_map(|example| Params::new(law.info, example).ok());
    law.info.dissipative && examples.any(|params| params.form() == form && !(law.dissipative)(&params))
}

fn way(out: &mut String, form: &Form, may_create_energy: bool) {
    let required = form.required.iter().map(|spec| format!("`{}`", spec.name));
    let optional = form.optional.iter().map(|(spec, default)| format!("`{}` (default {default})", spec.name));
    let names: Vec<String> = required.chain(optional).collect();
    let energy = if may_create_energy { " No promise about energy." } else { "" };
    let _ = writeln!(out, "| {} | {}{energy} |", names.join(", "), cell(form.doc));
}

fn contact(out: &mut String, law: &LawEntry) {
    let info = law.info;
    let list = |names: Vec<&str>| if names.is_empty() { "nothing".to_string() } else { names.join(", ") };
    let ends: Vec<&str> = info
        .contact_ends
        .iter()
        .map(|end| match end {
            ContactEnd::Force => "`Force`",
            ContactEnd::Overlap => "`Overlap`",
        })
        .collect();
    let ends =
        if ends.is_empty() { "any; the law does not depend on it".to_string() } else { ends.join(", ") };
    let history: Vec<String> = info
        .history
        .iter()
        .map(|column| {
            let kind = if column.components == 1 { "number" } else { "vector" };
            format!("`{}`, a {kind} in {}", column.name, column.dimension)
        })
        .collect();
    let history = if history.is_empty() { "nothing".to_string() } else { history.join("; ") };
    let energy = match (info.dissipative, (0..info.forms.len()).any(|form| may_create_energy(law, form))) {
        (true, false) => "never created",
        (true, true) => "never created, unless the table above says so",
        (false, _) => "no promise",
    };
    let _ = write!(
        out,
        "- end of contact: {ends}\n- reads: {}\n- writes: {}\n- remembers: {history}\n- energy: {energy}\n",
        list(info.reads.names()),
        list(info.writes.names())
    );
}

/// Text that does not end a table cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Pages in docs/laws that belong to no law.
///
/// # Errors
/// The folder cannot be read.
pub fn stale(registry: &Registry) -> std::io::Result<Vec<PathBuf>> {
    let current: Vec<PathBuf> = pages(registry).into_iter().map(|(path, _)| path).collect();
    let mut stale = Vec::new();
    for entry in std::fs::read_dir(docs().join("laws"))? {
        let path = Path::new("laws").join(entry?.file_name());
        if !current.contains(&path) {
            stale.push(path);
        }
    }
    stale.sort();
    Ok(stale)
}
