//! One case: ours against each peer that has its laws, every compared step of position, velocity, spin, force and torque.

use std::path::Path;
use std::sync::Arc;

use granule_plan::Plan;
use granule_report::verdict::{Case as Verdict, Horizon};
use granule_report::{Block, format_number};

use crate::cases::Case;
use crate::causes::{Against, explain, table};
use crate::figures;
use crate::ours::{SceneFile, frames};
use crate::peers::compare::{Comparison, Scales};
use crate::peers::{Engine, Frame, PeerScene, Quantity, Record, RunOptions, find_binary, inputs, run};
use crate::translate::{Target, translate};

/// Scaled difference up to which a run with `physical` conventions counts as following the peer.
const FOLLOWS: f64 = 1e-9;

/// What a case shows.
pub struct Outcome {
    /// Two verdicts a peer: with its conventions, and with `physical`.
    pub verdicts: Vec<Verdict>,
    /// Largest differences with the peer's conventions and with `physical`, in the order of [`Target::ALL`].
    pub differences: [Option<[f64; 2]>; Target::ALL.len()],
    /// Peers that cannot be told the scene, and why.
    pub left_out: Vec<String>,
}

/// A peer's answer, live or recorded.
struct Answer {
    version: String,
    /// Day of the recording; `None` for a live run.
    recorded: Option<String>,
    command: String,
    engine: Engine,
    frames: Vec<Frame>,
}

/// Runs a case against every target that has its laws. What goes wrong (a scene that cannot be planned or run, a peer that
/// fails, a stale record, a `case.ron` whose targets are not those that have the laws) is a verdict that does not pass.
pub fn check(case: &Case, folder: &Path, record: bool) -> Outcome {
    let mut outcome = Outcome { verdicts: Vec::new(), differences: Default::default(), left_out: Vec::new() };
    let failure = |name: String, why: String| {
        let mut verdict = Verdict::judged(name, "could not be compared", f64::NAN, case.tolerance)
            .with_engine("none", "", false)
            .because(&case.reason);
        verdict.extras.remarks.push(why);
        verdict
    };
    let ready = match Ready::new(case) {
        Ok(ready) => ready,
        Err(why) => {
            outcome.verdicts.push(failure(case.slug.clone(), why));
            return outcome;
        }
    };
    for (index, target) in Target::ALL.into_iter().enumerate() {
        let (listed, name) = (case.targets.contains(&target), target.name());
        let compared = match (translate(&ready.plan, target), listed) {
            (Ok(peer), true) => against(case, &ready, target, peer, &folder.join(name), record),
            (Err(why), false) => {
                outcome.left_out.push(format!("`{}`, {name}: {why}", case.slug));
                continue;
            }
            (Ok(_), false) => Err(format!("{name} has the laws of this case, but case.ron does not list it")),
            (Err(why), true) => Err(format!("case.ron lists {name}, which cannot do it: {why}")),
        };
        match compared {
            Ok((verdicts, differences)) => {
                outcome.verdicts.extend(verdicts);
                outcome.differences[index] = Some(differences);
            }
            Err(why) => outcome.verdicts.push(failure(format!("{} ({name})", case.slug), why)),
        }
    }
    outcome
}

/// A case, read and planned.
struct Ready {
    scene: SceneFile,
    plan: Arc<Plan>,
    /// Our run with the conventions `physical`.
    physical: Vec<Frame>,
}

impl Ready {
    fn new(case: &Case) -> Result<Self, String> {
        let scene = SceneFile::read(&case.scene())?;
        let plan = scene.plan()?;
        if case.dump_every == 0 || !plan.driver.steps.is_multiple_of(case.dump_every) {
            return Err(format!("dump_every must divide the {} steps", plan.driver.steps));
        }
        let physical = frames(&scene.plan_under("physical", &[])?, case.dump_every, 1)?;
        Ok(Self { scene, plan, physical })
    }
}

fn against(
    case: &Case,
    ready: &Ready,
    target: Target,
    mut peer: PeerScene,
    folder: &Path,
    record: bool,
) -> Result<([Verdict; 2], [f64; 2]), String> {
    peer.dump_every = case.dump_every;
    peer.quantities.clone_from(&case.quantities);
    let answer = answer(case, target, &peer, folder, record)?;
    let against = Against {
        scene: &ready.scene,
        target,
        peer: &peer,
        answer: &answer.frames,
        scales: Scales::of(&peer, &answer.frames),
    };
    verdicts(case, &ready.plan, &against, &answer, &ready.physical)
}

fn answer(
    case: &Case,
    target: Target,
    peer: &PeerScene,
    folder: &Path,
    record: bool,
) -> Result<Answer, String> {
    let fail = |error: crate::peers::PeerError| error.to_string();
    let files = inputs(peer).map_err(fail)?;
    let path = case.record(target);
    if find_binary(files.engine).is_some() {
        let run = run(peer, folder, &RunOptions::default()).map_err(fail)?;
        if record {
            let fresh = Record::of(&run);
            // An answer that has not changed keeps its date.
            let same = |old: Record| Record { recorded: fresh.recorded.clone(), ..old } == fresh;
            if !Record::load(&path, &files).is_ok_and(same) {
                fresh.save(&path).map_err(fail)?;
            }
        }
        let (version, command, frames) = (run.version, run.command, run.frames);
        return Ok(Answer { version, recorded: None, command, engine: files.engine, frames });
    }
    if record {
        return Err(fail(crate::peers::PeerError::NotInstalled(files.engine)));
    }
    let record = Record::load(&path, &files).map_err(fail)?;
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    files.write(folder).map_err(fail)?;
    let (version, command, frames) = (record.version, record.command, record.frames);
    Ok(Answer { version, recorded: Some(record.recorded), command, engine: files.engine, frames })
}

/// Name of an engine in reports.
pub fn title(engine: Engine) -> &'static str {
    match engine {
        Engine::Lammps => "LAMMPS",
        Engine::Liggghts => "LIGGGHTS",
    }
}

fn verdicts(
    case: &Case,
    plan: &Arc<Plan>,
    against: &Against<'_>,
    answer: &Answer,
    physical: &[Frame],
) -> Result<([Verdict; 2], [f64; 2]), String> {
    let (target, step) = (against.target, plan.driver.step);
    let names = case.quantities.iter().map(|quantity| quantity.name()).collect::<Vec<_>>().join(", ");
    let own = against.ours(&[])?;
    let matching = against.compare(&own)?;
    let apart = against.compare(physical)?;
    let worst = [&matching, &apart].map(Comparison::worst);
    let [Some(matching_worst), Some(apart_worst)] = worst else { return Err("nothing was compared".into()) };
    let judged = |quantity: String, difference: f64, tolerance: f64| {
        Verdict::judged(format!("{} ({})", case.slug, target.name()), quantity, difference, tolerance)
            .with_engine(title(answer.engine), &answer.version, answer.recorded.is_none())
    };

    let mut first =
        judged(format!("{names}; conventions `{}`", target.preset()), matching_worst.scaled, case.tolerance)
            .because(&case.reason);
    first.extras.description = format!(
        "{}. {} steps, compared every {}. The largest difference is in {} of body {} at step {}.",
        capital(&case.title),
        plan.driver.steps,
        case.dump_every,
        matching_worst.quantity.name(),
        matching_worst.body,
        matching_worst.step
    );
    first.extras.horizon = horizon(&matching, case.tolerance, plan, "the end of the run");
    let body = figures::busiest(&answer.frames);
    let shown = [Quantity::Velocity, Quantity::AngularVelocity, Quantity::Force];
    for quantity in shown.into_iter().filter(|quantity| moves(&answer.frames, *quantity, against)) {
        first.extras.plots.push(figures::trajectory(quantity, body, &own, &answer.frames, target, step)?);
    }
    first.extras.plots.push(figures::differences(&matching, case.tolerance, step)?);
    first.extras.blocks.push(told(case, target, answer));

    // What our own engine says that the conventions make.
    let made = against.between(&own, physical)?.worst().map_or(f64::NAN, |difference| difference.scaled);
    let explanation = explain(against, &own, physical, &apart_worst)?;
    let shares = explanation.causes.iter().map(|cause| {
        let name = cause.cause.split(':').next().unwrap_or(&cause.cause);
        format!("{name} {}", format_number(cause.contribution, 2))
    });
    let reason = format!(
        "nothing but the conventions: they alone make {} (our run with `physical` against our run with `{}`), where it is \
         largest {}; beyond that the tolerance of matching conventions, {:e}",
        format_number(made, 3),
        target.preset(),
        shares.collect::<Vec<_>>().join(", "),
        case.tolerance
    );
    let mut second =
        judged(format!("{names}; conventions `physical`"), apart_worst.scaled, made + case.tolerance)
            .because(reason);
    second.extras.description = format!(
        "The same scene with our own conventions. The largest difference is in {} of body {} at step {}. There, each \
         convention turned after the other from the peer's to ours contributes:",
        apart_worst.quantity.name(),
        apart_worst.body,
        apart_worst.step
    );
    second.extras.horizon = horizon(&apart, FOLLOWS, plan, "conventions act from the first contact on");
    second.extras.plots.push(figures::causes(&apart, &explanation.alone, &matching, step)?);
    second.extras.blocks.push(table(&explanation, &case.quantities, &apart));
    if !explanation.idle.is_empty() {
        let text = format!("Without any effect here: {}.", explanation.idle.join(", "));
        second.extras.blocks.push(Block::Paragraph(text));
    }
    second.extras.causes = explanation.causes;
    Ok(([first, second], [matching_worst.scaled, apart_worst.scaled]))
}

/// Whether there is anything to draw: more than round-off of what the scale stands for.
fn moves(frames: &[Frame], quantity: Quantity, against: &Against<'_>) -> bool {
    let scale = against.scales.get(quantity);
    let present = |vector: &[f64; 3]| vector.iter().any(|component| component.abs() > 1e-9 * scale);
    frames.iter().any(|frame| frame.column(quantity).iter().any(present))
}

fn horizon(comparison: &Comparison, threshold: f64, plan: &Plan, end: &str) -> Option<Horizon> {
    let first_beyond = comparison.horizon(threshold);
    let steps = comparison.rows.iter().filter_map(|row| row.first()).map(|entry| entry.step);
    let step = steps.filter(|step| first_beyond.is_none_or(|beyond| *step < beyond)).max()?;
    let explanation = if first_beyond.is_none() { "the end of the run".to_owned() } else { end.to_owned() };
    Some(Horizon { step, time_s: step as f64 * plan.driver.step, threshold, explanation })
}

/// Where the engine's inputs lie, so that anybody can run them again.
fn told(case: &Case, target: Target, answer: &Answer) -> Block {
    let when = match &answer.recorded {
        Some(day) => format!("recorded on {day}"),
        None => "run now".to_owned(),
    };
    Block::Paragraph(format!(
        "The engine: `{}` with the inputs in `engines/{}/{}`, {when}.",
        answer.command,
        case.slug,
        target.name()
    ))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
