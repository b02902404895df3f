//! Writes one of each: figures, a picture, a report page and a Markdown log, to be looked at after a change of style.
//! `cargo run -p granule-report --example gallery -- target/gallery`

use granule_report::verdict::{Case, Cause, Extras, Figure, Horizon, Report};
use granule_report::{
    Axis, Block, Build, Counts, Document, Machine, Manifest, Phase, Plot, ReportError, ScenePicture,
    SceneRecord, Series, View, rfc3339,
};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "target/gallery".to_owned());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let figures = [difference()?, restitution()?, convergence()?, energy()?, histogram()?, picture()?];
    for (k, svg) in figures.iter().enumerate() {
        std::fs::write(folder.join(format!("figure-{k}.svg")), svg)?;
    }
    let document = page(&figures);
    std::fs::write(folder.join("page.html"), document.to_html())?;
    std::fs::write(folder.join("page.md"), document.to_markdown())?;
    Ok(())
}

fn difference() -> Result<String, ReportError> {
    let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-8).collect();
    let position = time.iter().map(|t| 1e-17 + t * 2e-12 * (1.0 + 0.5 * (t * 2e5).sin())).collect();
    let spin =
        time.iter().map(|t| if *t < 3e-5 { 0.0 } else { 1e-16 + (t * 1e5).cos().abs() * 1e-14 }).collect();
    Plot::new(
        "Scaled difference to LAMMPS, oblique impact",
        Axis::linear("time [s]"),
        Axis::log("scaled difference"),
    )
    .with(Series::line("position", time.clone(), position))
    .with(Series::line("angular velocity", time, spin))
    .with(Series::dashed("tolerance", vec![0.0, 2e-4], vec![1e-12; 2]))
    .to_svg()
}

fn restitution() -> Result<String, ReportError> {
    let x: Vec<f64> = (0..12).map(f64::from).collect();
    let curve = |rate: f64| x.iter().map(|v| 0.5 + 0.4 * (v * rate).sin()).collect::<Vec<_>>();
    let fine: Vec<f64> = (0..=220).map(|k| f64::from(k) * 0.05).collect();
    let exact = fine.iter().map(|v| 0.5 + 0.4 * (v * 0.5).sin()).collect();
    Plot::new(
        "Tangential restitution against the tangent of the impact angle, three programs and the closed form",
        Axis::linear("tangent of the impact angle"),
        Axis::linear("tangential restitution"),
    )
    .with(Series::points("granule", x.clone(), curve(0.5)).with_error(vec![0.05; 12]))
    .with(Series::line("closed form", fine, exact))
    .with(Series::points("LIGGGHTS", x.clone(), curve(0.52)))
    .with(Series::points("LAMMPS", x.clone(), curve(0.51)))
    .to_svg()
}

fn convergence() -> Result<String, ReportError> {
    let step: Vec<f64> = (0..7).map(|k| 10f64.powi(-k)).collect();
    let error = |order: i32| step.iter().map(|v| 0.3 * v.powi(order)).collect();
    Plot::new(
        "Order of convergence",
        Axis::log("time step / contact duration"),
        Axis::log("relative error of velocity"),
    )
    .with(Series::points("velocity Verlet, synchronised velocities", step.clone(), error(2)))
    .with(Series::points("symplectic Euler, velocity first, position second", step.clone(), error(1)))
    .with(Series::dashed("slope 2", vec![1.0, 1e-6], vec![0.3, 0.3e-12]))
    .to_svg()
}

fn energy() -> Result<String, ReportError> {
    let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-7).collect();
    let total = time.iter().map(|t| 1.234_567 + 1e-9 * (t * 1e5).sin()).collect();
    Plot::new("Total energy", Axis::linear("time [s]"), Axis::linear("energy [J]"))
        .with(Series::line("", time, total))
        .to_svg()
}

fn histogram() -> Result<String, ReportError> {
    let edges: Vec<f64> = (0..=12).map(f64::from).collect();
    let counts =
        |centre: f64| edges.iter().map(|e| (200.0 * (-0.3 * (e - centre).powi(2)).exp()).round()).collect();
    Plot::new(
        "Coordination number, five seeds",
        Axis::linear("contacts of a sphere"),
        Axis::linear("spheres"),
    )
    .with(Series::steps("granule", edges.clone(), counts(5.0)))
    .with(Series::steps("LAMMPS", edges.clone(), counts(5.2)))
    .to_svg()
}

fn picture() -> Result<String, ReportError> {
    // A heap of close-packed layers, each smaller than the one below, with a spread of radii.
    let (mut positions, mut radii, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
    for layer in 0..14 {
        let shift = if layer % 2 == 0 { 0.0 } else { 0.5 };
        for row in -20i32..=20 {
            for column in -20i32..=20 {
                let x = f64::from(column) + shift + 0.5 * f64::from(row.rem_euclid(2));
                let y = f64::from(row) * 0.866 + shift * 0.577;
                let noise = f64::from((layer * 131 + row * 71 + column * 37).rem_euclid(17)) / 17.0;
                if x.hypot(y) < 19.0 - 1.35 * f64::from(layer) + noise {
                    positions.push([x, y, 0.5 + 0.816 * f64::from(layer)].map(|v| v * 1e-3));
                    radii.push((0.44 + 0.07 * noise) * 1e-3);
                    speeds.push(0.02 * (f64::from(layer) / 13.0).powi(2) + 0.004 * noise);
                }
            }
        }
    }
    ScenePicture::new(&positions, &radii, &speeds, "speed [m/s]")
        .with_view(View::Angles { azimuth: 30.0, elevation: 22.0 })
        .with_floor(0.0)
        .to_svg()
}

fn page(figures: &[String]) -> Document {
    let good = Case::judged("two-sphere-head-on", "position, velocity, force of every step", 3.1e-15, 1e-12)
        .with_engine("LAMMPS", "29 Aug 2024 - Update 1", true)
        .because("round-off: 4000 steps of 2e-16 each, not all of one sign");
    let mut explained = Case::judged("two-sphere-oblique", "torque", 0.0421, 0.05)
        .with_engine("LIGGGHTS", "3.8.0", false)
        .because("sum of the conventions in which `physical` differs, each measured alone");
    explained.extras = Extras {
        description: "Two equal spheres meet obliquely and roll off each other.".to_owned(),
        causes: vec![
            Cause {
                cause: "torque arm `R` instead of `R - overlap/2`".to_owned(),
                contribution: 0.0398,
                explanation: "switched alone".to_owned(),
            },
            Cause {
                cause: "half-step velocities".to_owned(),
                contribution: 0.0021,
                explanation: "switched alone".to_owned(),
            },
        ],
        plots: vec![Figure {
            svg: figures[1].clone(),
            caption: "Restitution of the three programs; bars are 95 % intervals.".to_owned(),
            file: Some("figure-1.svg".to_owned()),
        }],
        ..Extras::default()
    };
    let mut failed = Case::judged("small-pile", "position until the horizon", 4.2e-6, 1e-9)
        .with_engine("LAMMPS", "29 Aug 2024 - Update 1", true)
        .because("round-off times the growth of the separation up to the horizon");
    failed.extras.horizon = Some(Horizon {
        step: 18_400,
        time_s: 0.092,
        threshold: 1e-9,
        explanation: "first collision chain".to_owned(),
    });
    failed.extras.remarks.push("The engine wrote fewer steps than asked for.".to_owned());
    failed.extras.plots.push(Figure {
        svg: figures[0].clone(),
        caption: "Difference against time.".to_owned(),
        file: Some("figure-0.svg".to_owned()),
    });
    failed.extras.blocks.push(Block::code(
        "lammps",
        "units si\natom_style sphere\npair_style gran/hooke 1e5 NULL 5 NULL 0.5 0",
    ));
    let mut document = Document::new("Validation of granule against LAMMPS and LIGGGHTS");
    Report::new(vec![good.clone(), explained, failed, Case { name: "sphere-on-wall".to_owned(), ..good }])
        .render(&mut document);
    document.push(Block::heading(2, "Figures"));
    for (svg, caption) in
        figures[2..].iter().zip(["Convergence.", "Energy.", "Contacts.", "A heap of spheres."])
    {
        document.push(Block::plot(svg, caption));
    }
    document.push(Block::heading(2, "This run"));
    let manifest = manifest();
    document.push(Block::Table(manifest.summary_table()));
    document.push(Block::Table(manifest.phase_table()));
    document
}

fn manifest() -> Manifest {
    let phase = |name: &str, seconds: f64, count: u64| Phase { name: name.to_owned(), seconds, count };
    Manifest {
        program: "granule 0.1.0".to_owned(),
        build: Build::current(),
        plan_fingerprint: "8f3a1c02b7d94e65".to_owned(),
        plan: String::new(),
        scene: Some(SceneRecord::new("scene.ron", "(version: 1)")),
        machine: Machine::detect(),
        threads: 4,
        started: rfc3339(std::time::SystemTime::now()),
        duration_s: 83.4,
        phases: vec![
            phase("contacts", 51.3, 100_000),
            phase("integrate", 20.1, 100_000),
            phase("search", 9.9, 1234),
        ],
        counts: Counts { bodies: 10_000, contacts: 28_412, steps: 100_000 },
        simulated_time_s: 0.5,
        outcome: "completed".to_owned(),
        outputs: Vec::new(),
        result_hash: None,
    }
}
