//! `granule laws`: the registered laws, and all that is known about one of them.

use std::fmt::Write as _;
use std::path::Path;

use granule::prelude::{
    CollisionEntry, ContactEnd, Form, LawEntry, LawInfo, ParamSpec, Registry, Slot, SubstrateEntry,
    SubstrateInfo,
};

use super::Exit;
use crate::terminal::{self, HEADING, styled, wrap};
use crate::text;

const WIDTH: usize = 100;

/// Lists the laws, or shows the one of that name.
pub fn laws(name: Option<&str>, example_only: bool) -> Exit {
    let registry = match granule::laws() {
        Ok(registry) => registry,
        Err(error) => {
            terminal::error(&error.to_string());
            return Exit::Input;
        }
    };
    let Some(name) = name else {
        terminal::out(&table(&registry));
        return Exit::Success;
    };
    if let Ok(law) = registry.substrate(name) {
        terminal::out(&if example_only { substrate_example(law.info) } else { substrate_page(law) });
        return Exit::Success;
    }
    if let Ok(law) = registry.collision(name) {
        terminal::out(&if example_only { collision_example(law.info) } else { collision_page(law) });
        return Exit::Success;
    }
    match registry.get(name) {
        Ok(law) if example_only => terminal::out(&example(law, &registry)),
        Ok(law) => terminal::out(&page(law, &registry)),
        Err(error) => {
            terminal::error(&error.to_string());
            return Exit::Input;
        }
    }
    Exit::Success
}

/// All laws, one line each, by slot and name.
fn table(registry: &Registry) -> String {
    let entries = registry.entries();
    let names = registry.collisions().iter().map(|law| law.info.name.len());
    let name_width = entries.iter().map(|law| law.info.name.len()).chain(names).max().unwrap_or(0).max(4);
    let slot_width =
        entries.iter().map(|law| law.info.slot.name().len()).max().unwrap_or(0).max(SUBSTRATE.len());
    let mut out =
        format!("{HEADING}{:name_width$}  {:slot_width$}  what it models{HEADING:#}\n", "law", "slot");
    let contact = Slot::ALL.into_iter().flat_map(|slot| {
        entries.iter().filter(move |law| law.info.slot == slot).map(move |law| {
            let LawInfo { name, summary, .. } = law.info;
            (*name, slot.name(), *summary)
        })
    });
    let substrates = registry.substrates().iter().map(|law| (law.info.name, SUBSTRATE, law.info.summary));
    let collisions = registry.collisions().iter();
    let collisions = collisions.map(|law| (law.info.name, law.info.slot.name(), law.info.summary));
    for (name, slot, summary) in contact.chain(substrates).chain(collisions) {
        let indent = name_width + slot_width + 4;
        let lines = wrap(summary, WIDTH.saturating_sub(indent));
        // Writing to a string cannot fail.
        let _ = write!(out, "{name:name_width$}  {slot:slot_width$}  ");
        let _ = writeln!(out, "{}", lines.join(&format!("\n{}", " ".repeat(indent))));
    }
    out.push_str("\n`granule laws NAME` shows parameters, formula and sources of a law.\n");
    out
}

/// Where laws of the substrate stand in the table.
const SUBSTRATE: &str = "substrate";

/// Everything about one law of the substrate.
fn substrate_page(law: &SubstrateEntry) -> String {
    let info = law.info;
    let mut out = format!(
        "{} ({SUBSTRATE} law, from {} {})\n",
        styled(HEADING, info.name),
        law.crate_name,
        law.crate_version
    );
    paragraph(&mut out, 2, info.summary);
    heading(&mut out, "Formula");
    for line in info.formula.lines() {
        let _ = writeln!(out, "  {line}");
    }
    heading(&mut out, "Parameters");
    for spec in info.parameters {
        parameter(&mut out, spec);
    }
    heading(&mut out, "Ways to give them");
    for form in info.forms {
        way(&mut out, form);
    }
    heading(&mut out, "Sources");
    for source in info.sources {
        let note = if source.note.is_empty() { String::new() } else { format!(": {}", source.note) };
        paragraph(&mut out, 2, &format!("{}, {}{note}", source.work, source.place));
    }
    heading(&mut out, "Example scene");
    for line in substrate_example(info).lines() {
        let _ = writeln!(out, "  {line}");
    }
    out
}

/// Everything about one collision law.
fn collision_page(law: &CollisionEntry) -> String {
    let info = law.info;
    let mut out = format!(
        "{} ({} law, from {} {})\n",
        styled(HEADING, info.name),
        info.slot.name(),
        law.crate_name,
        law.crate_version
    );
    paragraph(&mut out, 2, info.summary);
    heading(&mut out, "Formula");
    for line in info.formula.lines() {
        let _ = writeln!(out, "  {line}");
    }
    heading(&mut out, "Parameters");
    for spec in info.parameters {
        parameter(&mut out, spec);
    }
    heading(&mut out, "Ways to give them");
    for form in info.forms {
        way(&mut out, form);
    }
    heading(&mut out, "Sources");
    for source in info.sources {
        let note = if source.note.is_empty() { String::new() } else { format!(": {}", source.note) };
        paragraph(&mut out, 2, &format!("{}, {}{note}", source.work, source.place));
    }
    heading(&mut out, "Example scene");
    for line in collision_example(info).lines() {
        let _ = writeln!(out, "  {line}");
    }
    out
}

/// Two hard spheres that meet obliquely.
fn collision_example(info: &LawInfo) -> String {
    let rule = invocations(info).into_iter().next_back().unwrap_or_default();
    let laws = slot_line(Slot::Collision, &rule);
    let columns = "\"kinetic_energy\", \"rotational_energy\", \"collisions\"";
    scene(info.name, &laws, "    driver: Event(),\n", columns)
}

/// A sphere that slips at first and then rolls until it rests.
fn substrate_example(info: &SubstrateInfo) -> String {
    let law = info.examples.first().map_or(format!("{}()", info.name), |example| {
        let given: Vec<String> =
            example.iter().map(|(name, value)| format!("{name}: {}", text::number(*value))).collect();
        format!("{}({})", info.name, given.join(", "))
    });
    format!(
        "(
    version: 1,
    title: \"{}: a sphere slips, rolls and rests\",
    gravity: (0, 0, -9.81),
    materials: {{ \"steel\": (density: \"7850 kg/m^3\") }},
    bodies: [Sphere(material: \"steel\", radius: \"2 mm\", position: (0, 0, \"2 mm\"), velocity: (\"0.1 m/s\", 0, 0))],
    substrate: (laws: {{ \"steel\": {law} }}),
    driver: TimeStep(step: \"0.1 ms\"),
    run: (duration: \"10 s\"),
    outputs: [Bodies(path: \"sphere.csv\", ids: [1], every: \"10 ms\")],
)
",
        info.name
    )
}

/// Everything about one law.
fn page(law: &LawEntry, registry: &Registry) -> String {
    let info = law.info;
    let mut out = format!(
        "{} ({} law, from {} {})\n",
        styled(HEADING, info.name),
        info.slot.name(),
        law.crate_name,
        law.crate_version
    );
    paragraph(&mut out, 2, info.summary);
    heading(&mut out, "Formula");
    for line in info.formula.lines() {
        let _ = writeln!(out, "  {line}");
    }
    heading(&mut out, "Parameters");
    for spec in info.parameters {
        parameter(&mut out, spec);
    }
    heading(&mut out, "Ways to give them");
    for form in info.forms {
        way(&mut out, form);
    }
    heading(&mut out, "Contact");
    contact(&mut out, law);
    heading(&mut out, "Sources");
    for source in info.sources {
        let note = if source.note.is_empty() { String::new() } else { format!(": {}", source.note) };
        paragraph(&mut out, 2, &format!("{}, {}{note}", source.work, source.place));
    }
    heading(&mut out, "Example scene");
    for line in example(law, registry).lines() {
        let _ = writeln!(out, "  {line}");
    }
    out
}

fn heading(out: &mut String, text: &str) {
    let _ = writeln!(out, "\n{}", styled(HEADING, text));
}

fn paragraph(out: &mut String, indent: usize, text: &str) {
    for line in wrap(text, WIDTH - indent) {
        let _ = writeln!(out, "{}{line}", " ".repeat(indent));
    }
}

fn parameter(out: &mut String, spec: &ParamSpec) {
    let unit = if spec.dimension.is_dimensionless() {
        "a plain number".to_string()
    } else {
        format!("in {}", spec.dimension)
    };
    let symbol = if spec.symbol.is_empty() { String::new() } else { format!(", {}", spec.symbol) };
    let _ = writeln!(out, "  {}{symbol}: {unit}, {}", styled(HEADING, spec.name), spec.range.describe());
    paragraph(out, 6, spec.doc);
}

fn way(out: &mut String, form: &Form) {
    let required = form.required.iter().map(|spec| spec.name.to_string());
    let optional =
        form.optional.iter().map(|(spec, default)| format!("[{} = {}]", spec.name, text::number(*default)));
    let names: Vec<String> = required.chain(optional).collect();
    let _ = writeln!(out, "  ({})", names.join(", "));
    paragraph(out, 6, form.doc);
}

fn contact(out: &mut String, law: &LawEntry) {
    let info = law.info;
    let list = |names: Vec<&str>| if names.is_empty() { "nothing".to_string() } else { names.join(", ") };
    let ends: Vec<&str> = info
        .contact_ends
        .iter()
        .map(|end| match end {
            ContactEnd::Force => "Force",
            ContactEnd::Overlap => "Overlap",
        })
        .collect();
    let ends =
        if ends.is_empty() { "any: the law does not depend on it".to_string() } else { ends.join(", ") };
    let _ = writeln!(out, "  contact_end: {ends}");
    let _ = writeln!(out, "  reads:       {}", list(info.reads.names()));
    let _ = writeln!(out, "  writes:      {}", list(info.writes.names()));
    if info.history.is_empty() {
        let _ = writeln!(out, "  history:     nothing");
    }
    for column in info.history {
        let kind = if column.components == 1 { "number" } else { "vector" };
        let _ = writeln!(out, "  history:     {}, a {kind} in {}", column.name, column.dimension);
    }
    let energy = if info.dissipative {
        "never creates energy"
    } else {
        "no promise; some parameters or motions can create energy"
    };
    let _ = writeln!(out, "  energy:      {energy}");
}

/// A whole scene with an example of a law: two spheres that meet obliquely. A law of another slot comes with the first
/// normal law that it gets along with.
fn example(law: &LawEntry, registry: &Registry) -> String {
    let normals = registry.entries().iter().filter(|law| law.info.slot == Slot::Normal);
    let partners: Vec<String> = if law.info.slot == Slot::Normal {
        vec![String::new()]
    } else {
        normals
            .flat_map(|normal| invocations(normal.info))
            .map(|normal| slot_line(Slot::Normal, &normal))
            .collect()
    };
    let own = invocations(law.info);
    let mut scenes = own.iter().flat_map(|own| {
        partners.iter().map(|partner| {
            let laws = format!("{partner}{}", slot_line(law.info.slot, own));
            scene(law.info.name, &laws, "", SOFT_COLUMNS)
        })
    });
    let first = scenes.next().unwrap_or_default();
    if is_sound(&first) { first } else { scenes.find(|scene| is_sound(scene)).unwrap_or(first) }
}

/// Columns of the series of an example with lasting contacts.
const SOFT_COLUMNS: &str = "\"kinetic_energy\", \"momentum_x\", \"maximum_overlap\"";

fn is_sound(scene: &str) -> bool {
    granule::load_text(Path::new("example.ron"), scene.to_string()).is_ok()
}

fn slot_line(slot: Slot, law: &str) -> String {
    format!("            {}: {law},\n", slot.name())
}

fn scene(name: &str, laws: &str, driver: &str, columns: &str) -> String {
    format!(
        "(
    version: 1,
    title: \"{name}: two spheres meet\",
    materials: {{ \"glass\": (density: \"2500 kg/m^3\") }},
    bodies: [
        Sphere(material: \"glass\", radius: \"1 mm\", position: (0, 0, 0), velocity: (\"0.1 m/s\", 0, 0)),
        Sphere(material: \"glass\", radius: \"1 mm\", position: (\"2.01 mm\", \"0.5 mm\", 0)),
    ],
    contacts: [
        (
            between: (\"glass\", \"glass\"),
{laws}        ),
    ],
{driver}    run: (duration: \"5 ms\"),
    outputs: [Series(path: \"series.csv\", columns: [{columns}])],
)
"
    )
}

/// A law as it is written in a scene, once for each of its examples.
fn invocations(info: &LawInfo) -> Vec<String> {
    info.examples
        .iter()
        .map(|example| {
            let given: Vec<String> =
                example.iter().map(|(name, value)| parameter_text(info, name, *value)).collect();
            format!("{}({})", info.name, given.join(", "))
        })
        .collect()
}

fn parameter_text(info: &LawInfo, name: &str, value: f64) -> String {
    let spec = info.parameters.iter().find(|spec| spec.name == name);
    let unit = spec.map(|spec| spec.dimension).filter(|dimension| !dimension.is_dimensionless());
    match unit {
        Some(unit) if value.is_finite() => format!("{name}: \"{} {unit}\"", text::number(value)),
        _ => format!("{name}: {}", text::number(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_in_the_table_and_has_a_page() {
        let registry = granule::laws().unwrap();
        let table = table(&registry);
        assert!(!registry.entries().is_empty());
        for law in registry.collisions() {
            let page = collision_page(law);
            assert!(table.contains(law.info.name));
            assert!(law.info.formula.lines().all(|line| page.contains(line)), "{page}");
        }
        for law in registry.entries() {
            assert!(table.contains(law.info.name));
            let page = page(law, &registry);
            for spec in law.info.parameters {
                assert!(page.contains(spec.name), "{}: {} is missing", law.info.name, spec.name);
            }
            for source in law.info.sources {
                assert!(page.contains(source.work));
            }
        }
    }

    #[test]
    fn the_example_of_every_law_is_a_scene_without_problems() {
        let registry = granule::laws().unwrap();
        for law in registry.entries() {
            let text = example(law, &registry);
            let checked = granule::load_text(Path::new("example.ron"), text.clone());
            let problems = checked.err().map(|error| error.to_string());
            assert_eq!(problems, None, "{}\n{text}", law.info.name);
        }
        for law in registry.collisions() {
            let text = collision_example(law.info);
            let problems = granule::load_text(Path::new("example.ron"), text.clone()).err();
            assert!(problems.is_none(), "{}\n{text}", problems.unwrap());
        }
        for law in registry.substrates() {
            let text = substrate_example(law.info);
            let checked = granule::load_text(Path::new("example.ron"), text.clone());
            assert_eq!(checked.err().map(|error| error.to_string()), None, "{text}");
            assert!(
                table(&registry).contains(law.info.name)
                    && substrate_page(law).contains(law.info.formula.lines().next().unwrap())
            );
        }
    }
}
