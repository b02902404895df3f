//! The text of a new law: one skeleton, and what differs between slots.

use super::names::Names;

/// Marks what the author has to write; `cargo xtask tidy` refuses it. In two parts, so that this file passes.
pub const FILL_IN: &str = concat!("FILL", " IN");

/// What differs between slots.
struct Part {
    /// Parameter: name, symbol, meaning, dimension, value of the example.
    parameter: [&'static str; 5],
    formula: &'static str,
    reads: &'static str,
    writes: &'static str,
    /// Names imported besides the common ones.
    imports: &'static str,
    /// Body of `time_scale`, and `summary` where there is one.
    scale: &'static str,
    /// Loop over the contacts.
    stage: &'static str,
    /// How the oracle is written.
    oracle: &'static str,
}

const NORMAL: Part = Part {
    parameter: ["stiffness", "k", "Stiffness of the spring.", "STIFFNESS", "1e5"],
    formula: "f_n = k delta",
    reads: "Columns::REDUCED_MASS",
    writes: "Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING)",
    imports: "DurationRule, NormalSummary, ",
    scale: "        let stiffness = params.value(&STIFFNESS)?;
        let omega = (stiffness / impact.reduced_mass).sqrt();
        let overlap = impact.normal_speed / omega;
        Ok(Some(TimeScale { duration: std::f64::consts::PI / omega, stiffness, damping: 0.0, overlap }))
    }

    fn summary(params: &Params, pair: &PairContext) -> Option<NormalSummary> {
        let impact = Impact {
            reduced_mass: pair.reduced_mass.min,
            reduced_radius: pair.reduced_radius.min,
            normal_speed: pair.impact_speed,
        };
        let scale = Self::time_scale(params, pair, &impact).ok().flatten();
        Some(NormalSummary { duration: DurationRule::Oscillator(std::f64::consts::PI), scale })
",
    stage: "        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            force[k] = (self.value * overlap[k]).max(T::ZERO);
        }
        // Later stages may want the secant stiffness and the damping; the columns are empty if none does.
        chunk.normal_stiffness.fill(self.value);
        chunk.normal_damping.fill(T::ZERO);
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                energy.elastic[k] = T::of(0.5) * force[k] * overlap[k];
                energy.viscous[k] = T::ZERO;
                energy.friction[k] = T::ZERO;
            }
        }
",
    oracle: "`Oracle::Normal(Box::new(move |impact| ImpactOutcome { duration, maximum_overlap, restitution }))`",
};

const COHESION: Part = Part {
    parameter: ["attraction", "f_c", "Attractive force while two bodies touch.", "FORCE", "1e-3"],
    formula: "f_n = f_n of the normal law - f_c",
    reads: "Columns::NORMAL_FORCE",
    writes: "Columns::NORMAL_FORCE",
    imports: "",
    scale: NO_SCALE,
    stage: "        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            force[k] -= self.value.keep_if(overlap[k] > T::ZERO);
        }
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                energy.elastic[k] = -(self.value * overlap[k].max(T::ZERO));
                energy.viscous[k] = T::ZERO;
                energy.friction[k] = T::ZERO;
            }
        }
",
    oracle: "`Oracle::Normal(Box::new(move |impact| ImpactOutcome { duration, maximum_overlap, restitution }))`",
};

const TANGENTIAL: Part = Part {
    parameter: ["damping", "gamma_t", "Tangential damping coefficient.", "DAMPING", "5.0"],
    formula: "f_t = -gamma_t v_t",
    reads: "Columns::TANGENTIAL_VELOCITY",
    writes: "Columns::TANGENTIAL_FORCE",
    imports: "",
    scale: NO_SCALE,
    stage: "        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        for axis in 0..3 {
            let velocity = &chunk.tangential_velocity[axis][..n];
            let force = &mut chunk.tangential_force[axis][..n];
            for k in 0..n {
                force[k] = -(self.value * velocity[k]).keep_if(overlap[k] > T::ZERO);
            }
        }
        if let Some(energy) = &mut chunk.energy {
            let [vx, vy, vz] = chunk.tangential_velocity;
            let [fx, fy, fz] = &chunk.tangential_force;
            for k in 0..n {
                energy.elastic[k] = T::ZERO;
                energy.viscous[k] = -(fx[k] * vx[k] + fy[k] * vy[k] + fz[k] * vz[k]);
                energy.friction[k] = T::ZERO;
            }
        }
",
    oracle: "`Oracle::Tangential(Box::new(move |impact| Some(tangential_velocity_after)))`",
};

const ROLLING: Part = Part {
    parameter: ["rolling_damping", "gamma_r", "Torque per rolling spin.", "ANGULAR_MOMENTUM", "1e-9"],
    formula: "torque = -gamma_r (w - (w n) n), w = relative spin",
    reads: "Columns::RELATIVE_SPIN",
    writes: "Columns::TORQUE",
    imports: "",
    scale: NO_SCALE,
    stage: "        let n = chunk.len();
        let [wx, wy, wz] = chunk.relative_spin;
        let [nx, ny, nz] = chunk.normal;
        let [tx, ty, tz] = &mut chunk.torque;
        for k in 0..n {
            let along = wx[k] * nx[k] + wy[k] * ny[k] + wz[k] * nz[k];
            let value = self.value.keep_if(chunk.overlap[k] > T::ZERO);
            // Rolling and torsion share the column, so each adds.
            tx[k] -= value * (wx[k] - along * nx[k]);
            ty[k] -= value * (wy[k] - along * ny[k]);
            tz[k] -= value * (wz[k] - along * nz[k]);
        }
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                let along = wx[k] * nx[k] + wy[k] * ny[k] + wz[k] * nz[k];
                let square = wx[k] * wx[k] + wy[k] * wy[k] + wz[k] * wz[k] - along * along;
                energy.elastic[k] = T::ZERO;
                energy.viscous[k] = (self.value * square.max(T::ZERO)).keep_if(chunk.overlap[k] > T::ZERO);
                energy.friction[k] = T::ZERO;
            }
        }
",
    oracle: "a variant of `Oracle` for torques: the law interface has none yet, so add it there first",
};

const TORSION: Part = Part {
    parameter: [
        "torsion_damping",
        "gamma_w",
        "Torque per spin about the normal.",
        "ANGULAR_MOMENTUM",
        "1e-9",
    ],
    formula: "torque = -gamma_w (w n) n, w = relative spin",
    reads: "Columns::RELATIVE_SPIN",
    writes: "Columns::TORQUE",
    imports: "",
    scale: NO_SCALE,
    stage: "        let n = chunk.len();
        let [wx, wy, wz] = chunk.relative_spin;
        let [nx, ny, nz] = chunk.normal;
        let [tx, ty, tz] = &mut chunk.torque;
        for k in 0..n {
            let along = wx[k] * nx[k] + wy[k] * ny[k] + wz[k] * nz[k];
            let torque = (self.value * along).keep_if(chunk.overlap[k] > T::ZERO);
            // Rolling and torsion share the column, so each adds.
            tx[k] -= torque * nx[k];
            ty[k] -= torque * ny[k];
            tz[k] -= torque * nz[k];
        }
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                let along = wx[k] * nx[k] + wy[k] * ny[k] + wz[k] * nz[k];
                energy.elastic[k] = T::ZERO;
                energy.viscous[k] = (self.value * along * along).keep_if(chunk.overlap[k] > T::ZERO);
                energy.friction[k] = T::ZERO;
            }
        }
",
    oracle: "a variant of `Oracle` for torques: the law interface has none yet, so add it there first",
};

const NO_SCALE: &str = "        Ok(None)\n";

fn part(slot: &str) -> &'static Part {
    match slot {
        "cohesion" => &COHESION,
        "tangential" => &TANGENTIAL,
        "rolling" => &ROLLING,
        "torsion" => &TORSION,
        _ => &NORMAL,
    }
}

/// A scene of two spheres that meet under the law.
pub fn external_scene(names: &Names) -> String {
    let [parameter, _, _, _, value] = part(&names.slot).parameter;
    let normal = if names.slot == "normal" {
        ""
    } else {
        "            normal: LinearSpringDashpot(stiffness: \"1e5 N/m\", restitution: 0.9),\n"
    };
    format!(
        "(
    version: 1,
    title: \"two spheres meet\",
    materials: {{ \"glass\": (density: \"2500 kg/m^3\") }},
    bodies: [
        Sphere(material: \"glass\", radius: \"1 mm\", position: (0, 0, 0), velocity: (\"0.1 m/s\", 0, 0)),
        Sphere(material: \"glass\", radius: \"1 mm\", position: (\"2.01 mm\", \"0.5 mm\", 0)),
    ],
    contacts: [
        (
            between: (\"glass\", \"glass\"),
{normal}            {slot}: {law}({parameter}: {value}),
        ),
    ],
    run: (duration: \"5 ms\"),
    outputs: [Series(path: \"series.csv\", columns: [\"kinetic_energy\", \"maximum_overlap\"])],
)
",
        slot = names.slot,
        law = names.law()
    )
}

/// `src/lib.rs`.
pub fn library(names: &Names) -> String {
    let (module, law, slot) = (names.module(), names.law(), &names.slot);
    format!(
        "//! {law}: {FILL_IN} what this {slot} law models.\n\nmod {module};\n\npub use {module}::{law};\n"
    )
}

/// `src/<module>.rs`.
pub fn source(names: &Names) -> String {
    let part = part(&names.slot);
    let [parameter, symbol, doc, dimension, value] = part.parameter;
    let constant = parameter.to_uppercase();
    let slot = names.variant();
    let law = names.law();
    let Part { formula, reads, writes, imports, scale, stage, oracle, .. } = part;
    let (scale_params, scale_impact) =
        if *scale == NO_SCALE { ("_params", "_impact") } else { ("params", "impact") };
    format!(
        "//! {formula}.

use granule_law_api::{{
    Columns, ContactChunk, ContactLaw, Dimension, {imports}Form, Impact, LawError, LawInfo, Oracle, PairContext,
    ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange, register_law,
}};

const {constant}: ParamSpec = ParamSpec {{
    name: \"{parameter}\",
    symbol: \"{symbol}\",
    doc: \"{doc}\",
    dimension: Dimension::{dimension},
    range: ValueRange::POSITIVE,
}};

/// {FILL_IN} what it models, its range of validity and where it comes from: {formula}.
pub struct {law};

impl ContactLaw for {law} {{
    const INFO: LawInfo = LawInfo {{
        name: \"{law}\",
        summary: \"{FILL_IN} in one line what it models.\",
        formula: \"{formula}\",
        sources: &[Source {{ work: \"{FILL_IN} author and year\", place: \"Eq. (1)\", note: \"\" }}],
        slot: Slot::{slot},
        reads: {reads},
        writes: {writes},
        history: &[],
        parameters: &[&{constant}],
        forms: &[Form {{ doc: \"The same for every pair.\", required: &[&{constant}], optional: &[] }}],
        examples: &[&[(\"{parameter}\", {value})]],
        contact_ends: &[],
        dissipative: true,
    }};

    fn compile<T: Real>(params: &Params, _pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {{
        Ok(Box::new(Compiled {{ value: T::of(params.value(&{constant})?) }}))
    }}

    fn time_scale(
        {scale_params}: &Params,
        _pair: &PairContext,
        {scale_impact}: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {{
{scale}    }}

    /// {FILL_IN} the closed form: {oracle}.
    /// The conformance test fails until then.
    fn oracle(_params: &Params, _pair: &PairContext) -> Oracle {{
        Oracle::Missing
    }}
}}

register_law!({law});

struct Compiled<T> {{
    value: T,
}}

impl<T: Real> Stage<T> for Compiled<T> {{
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {{
{stage}    }}
}}

#[cfg(test)]
mod tests {{
    use super::*;

    #[test]
    fn conforms() {{
        granule_law_api::testing::conformance::<{law}>();
    }}
}}
"
    )
}

/// `Cargo.toml` of a law in this workspace.
pub fn manifest(names: &Names) -> String {
    format!(
        "[package]
name = \"granule-law-{folder}\"
description = \"{FILL_IN} what this {slot} law models\"
version.workspace = true
edition.workspace = true
license.workspace = true
repository.workspace = true
publish = false

[lints]
workspace = true

[dependencies]
granule-law-api.workspace = true
",
        folder = names.folder,
        slot = names.slot
    )
}

/// `Cargo.toml` of a workspace of a law and a program outside; `granule` is the path of this project's root.
pub fn external_workspace(names: &Names, granule: &str) -> String {
    format!(
        "[workspace]
resolver = \"3\"
members = [\"{folder}\", \"{folder}-granule\"]
default-members = [\"{folder}-granule\"]

[workspace.dependencies]
granule-cli = {{ path = {cli:?} }}
granule-law-api = {{ path = {api:?} }}

[profile.release]
debug = \"line-tables-only\"

# Physics in tests runs at full speed.
[profile.test]
opt-level = 3
",
        folder = names.folder,
        cli = format!("{granule}/crates/cli"),
        api = format!("{granule}/crates/law-api"),
    )
}

/// `Cargo.toml` of the law outside.
pub fn external_law(names: &Names) -> String {
    format!(
        "[package]
name = \"{folder}\"
description = \"{FILL_IN} what this {slot} law models\"
version = \"0.1.0\"
edition = \"2024\"

[dependencies]
granule-law-api.workspace = true
",
        folder = names.folder,
        slot = names.slot
    )
}

/// `Cargo.toml` of the program outside.
pub fn external_program(names: &Names) -> String {
    format!(
        "[package]
name = \"{folder}-granule\"
description = \"The granule command with {law}\"
version = \"0.1.0\"
edition = \"2024\"

[dependencies]
{folder} = {{ path = \"../{folder}\" }}
granule-cli.workspace = true
",
        folder = names.folder,
        law = names.law()
    )
}

/// `src/main.rs` of the program outside.
pub fn external_main(names: &Names) -> String {
    format!(
        "//! The granule command with one more law.\n\nuse {} as _;\n\nfn main() -> std::process::ExitCode {{\n    \
         granule_cli::main()\n}}\n",
        names.module()
    )
}
