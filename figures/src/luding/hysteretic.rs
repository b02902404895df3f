//! Fig. 6: the hysteretic contact.

use granule_law_api::testing::Contacts;
use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::{Run, plan};
use crate::{Error, Figure, spread};

const LOADING: f64 = 1e4;
const RESTITUTION: f64 = 0.6;
const SPEED: f64 = 0.1;

fn scene(loading: f64, unloading: f64) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1e-3), velocity: (0, 0, -{SPEED}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: WaltonBraun(loading_stiffness: {loading}, unloading_stiffness: {unloading}))],
        driver: TimeStep(step: 2e-8), run: (duration: 150e-6))"#
    )
}

/// Overlaps [µm] and forces [mN] of an impact in the engine, and its restitution.
fn impact(loading: f64, unloading: f64) -> Result<(Vec<f64>, Vec<f64>, f64), Error> {
    let mut run = Run::new(&scene(loading, unloading))?;
    let (mut overlaps, mut forces) = (Vec::new(), Vec::new());
    for step in (0..=run.steps()).step_by(100) {
        run.advance(step)?;
        let body = run.bodies()[0];
        let overlap = 1e-3 - body.position[2];
        if overlap > 0.0 {
            overlaps.push(1e6 * overlap);
            forces.push(1e3 * body.force[2]);
        }
    }
    Ok((overlaps, forces, run.bodies()[0].velocity[2] / SPEED))
}

pub(super) fn figure() -> Result<Figure, Error> {
    let unloading = LOADING / (RESTITUTION * RESTITUTION);
    // Load to 1.5 µm, unload to 1.2 µm, reload and go on to 2 µm, unload beyond the end of the force, reload, leave.
    let turns = [0.0, 1.5e-6, 1.2e-6, 2e-6, 1.1e-6, 1.8e-6, 0.0];
    let plan = plan(&scene(LOADING, unloading))?;
    let stage =
        &plan.compositions.first().and_then(|laws| laws.stages.first()).ok_or("the scene has no law")?;
    let mut contact = Contacts::<f64>::new(1, stage.history_width);
    let (mut overlaps, mut forces) = (Vec::new(), Vec::new());
    for pair in turns.windows(2) {
        for overlap in spread(pair[0], pair[1], 200) {
            contact.overlap[0] = overlap;
            contact.run(&*stage.double, 1e-8);
            overlaps.push(1e6 * overlap);
            forces.push(1e3 * contact.normal_force[0]);
        }
    }
    let (in_engine, pushes, restitution) = impact(LOADING, unloading)?;
    let (_, _, printed) = impact(LOADING, LOADING / RESTITUTION)?;
    let largest = in_engine.iter().fold(0.0, |most: f64, overlap| most.max(*overlap));
    let top = 1e-3 * LOADING * largest;
    // Luding 1998, Eq. (45): from the largest overlap down along k2, as printed k1/e_n, and corrected k1/e_n².
    let down = |stiffness: f64| vec![largest, largest - top / (1e-3 * stiffness)];
    let plot = Plot::new(
        "Fig. 6: force and overlap of a hysteretic contact",
        Axis::linear("overlap [µm]"),
        Axis::linear("force [mN]"),
    )
    .with(Series::line("law, on a path with two reloads", overlaps, forces).with_colour(Colour::PALETTE[0]))
    .with(
        Series::line("unloading with k2 = k1/e_n²", down(unloading), vec![top, 0.0])
            .with_colour(Colour::PALETTE[2]),
    )
    .with(
        Series::dashed("unloading with k2 = k1/e_n, as printed", down(LOADING / RESTITUTION), vec![top, 0.0])
            .with_colour(Colour::PALETTE[1]),
    )
    .with(Series::points("engine, one impact", in_engine, pushes).with_colour(Colour::PALETTE[3]));
    Ok(Figure {
        name: "fig6",
        plot: plot.with_size(760.0, 460.0),
        caption: format!(
            "WaltonBraun, k1 = 10 kN/m, e_n = {RESTITUTION}. The path reloads along k2 to the force that it left and goes on \
             along k1; it unloads below the residual overlap, from where a reload begins anew (erratum L-E25). An impact of the \
             engine gives e_n = {restitution:.4}; with k2 = k1/e_n as printed it gives {printed:.4} (erratum L-E2)."
        ),
    })
}
