//! Inputs as text, and what the engines say when things go wrong.

use std::time::Duration;

use super::*;
use crate::cases;
use crate::translate::Target;

fn scene(slug: &str, target: Target) -> PeerScene {
    cases::find(slug).unwrap().peer(target).unwrap()
}

/// Skips, aloud, where the engine is missing.
fn installed(engine: Engine) -> bool {
    let found = find_binary(engine).is_some();
    if !found {
        println!("SKIPPED: {} is not installed", engine.name());
    }
    found
}

/// The lines that decide the physics; the rest (box, thermo, dump) the runs of the cases exercise.
fn has_lines(script: &str, lines: &[&str]) {
    for line in lines {
        assert!(script.lines().any(|found| found == *line), "no line `{line}` in\n{script}");
    }
}

#[test]
fn lammps_script() {
    let files = inputs(&scene("wall-corner", Target::LammpsGranular)).unwrap();
    let law = "granular hooke 1000.0 58.6 tangential linear_history 285.7142857142857 0.5 0.5 damping mass_velocity";
    has_lines(
        &files.script,
        &[
            "units si",
            "newton off",
            "pair_style granular",
            &format!("pair_coeff 1 1 {}", law.strip_prefix("granular ").unwrap()),
            &format!("fix w1all all wall/gran {law} zplane 0.0 NULL"),
            &format!("fix w2all all wall/gran {law} xplane NULL 0.00602"),
            "fix g all gravity 9.81 vector 0.0 0.0 -1.0",
            "timestep 2e-5",
            "run 450",
        ],
    );
    let atoms = files.bodies.lines().find(|line| line.starts_with("1 1 ")).unwrap();
    let numbers: Vec<f64> = atoms.split(' ').skip(2).map(|word| word.parse().unwrap()).collect();
    // The density comes back from the mass to the last bit or the one beside it.
    assert!((numbers[1] - 2500.0).abs() < 1e-12 * 2500.0);
    assert_eq!([numbers[0], numbers[2], numbers[3]], [0.01, 0.001, -0.002]);
}

#[test]
fn liggghts_script() {
    let files = inputs(&scene("wall-bounce-hertz-material", Target::Liggghts)).unwrap();
    has_lines(
        &files.script,
        &[
            "atom_style granular",
            "communicate single vel yes",
            "fix coefficientRestitution all property/global coefficientRestitution peratomtypepair 1 0.9",
            "fix youngsModulus all property/global youngsModulus peratomtype 10000000.0",
            "pair_style gran model hertz tangential history tangential_damping on limitForce off",
        ],
    );
}

#[test]
fn what_an_engine_cannot_do_is_said_before_it_runs() {
    let hard = scene("two-materials", Target::LammpsGranular);
    let classic = |friction| {
        PeerLaw::Classic(ClassicLaw {
            style: ClassicStyle::HookeHistory,
            kn: 1e3,
            kt: 3e2,
            gamma_n: 1.0,
            gamma_t: 1.0,
            friction,
            tangential_damping: true,
            limit_damping: false,
        })
    };
    let mut two = hard.clone();
    two.laws = [((1, 1), 0.1), ((1, 2), 0.2), ((2, 2), 0.1)].map(|(kinds, mu)| (kinds, classic(mu))).into();
    assert!(matches!(inputs(&two), Err(PeerError::Unsupported(Engine::Lammps, _))));
    let mut missing = hard.clone();
    missing.laws.remove(&(1, 2));
    assert!(matches!(inputs(&missing), Err(PeerError::Scene(_))));
    let mut mixed = scene("two-materials", Target::Liggghts);
    let hertz = scene("head-on-hertz-material", Target::Liggghts).laws[&(1, 1)];
    mixed.laws.insert((1, 2), hertz);
    assert!(matches!(inputs(&mixed), Err(PeerError::Unsupported(Engine::Liggghts, _))));
    let mut rising = scene("wall-belt", Target::LammpsClassic);
    rising.walls[0].velocity = [0.0, 0.0, 0.1];
    assert!(matches!(inputs(&rising), Err(PeerError::Scene(_))));
    let mut moving = scene("frozen-partner", Target::LammpsClassic);
    moving.bodies[1].velocity[0] = 0.1;
    assert!(matches!(inputs(&moving), Err(PeerError::Scene(_))));
}

#[test]
fn a_lost_body_a_refused_value_and_a_long_run_are_errors_with_the_engines_words() {
    let folder = tempfile::tempdir().unwrap();
    for target in [Target::LammpsClassic, Target::Liggghts] {
        let mut lost = scene("oblique-sliding", target);
        if !installed(lost.check().unwrap()) {
            continue;
        }
        lost.bodies[0].velocity = [500.0, 0.0, 0.0];
        let error = run(&lost, folder.path(), &RunOptions::default()).unwrap_err();
        assert!(matches!(error, PeerError::Failed(..)), "{error}");
        assert!(error.to_string().to_lowercase().contains("lost"), "{error}");

        let mut endless = scene("oblique-sliding", target);
        endless.bodies.iter_mut().for_each(|body| body.velocity = [0.0; 3]);
        (endless.steps, endless.dump_every) = (1_000_000_000, 0);
        let options = RunOptions { timeout: Duration::from_millis(1500), ..RunOptions::default() };
        let error = run(&endless, folder.path(), &options).unwrap_err();
        assert!(matches!(error, PeerError::Timeout(..)), "{error}");
    }
    if installed(Engine::Liggghts) {
        let mut refused = scene("head-on-hertz-material", Target::Liggghts);
        for law in refused.laws.values_mut() {
            if let PeerLaw::Liggghts(law) = law {
                law.normal = LiggghtsNormal::Hertz { restitution: 1.5 };
            }
        }
        let error = run(&refused, folder.path(), &RunOptions::default()).unwrap_err();
        assert!(error.to_string().contains("coefficientRestitution"), "{error}");
    }
}

/// For timing: two run commands, the loop time of the second, no dump.
#[test]
fn a_timed_run_has_a_loop_time_and_no_frames() {
    let folder = tempfile::tempdir().unwrap();
    for target in [Target::LammpsClassic, Target::Liggghts] {
        let mut timed = scene("oblique-sliding", target);
        (timed.warm_up, timed.steps) = (10, 1000);
        assert!(
            matches!(timed.check(), Err(PeerError::Scene(_))),
            "a dump after a warm-up is not comparable"
        );
        timed.dump_every = 0;
        if installed(timed.check().unwrap()) {
            let run = run(&timed, folder.path(), &RunOptions::default()).unwrap();
            assert!(run.loop_seconds > 0.0 && run.frames.is_empty());
        }
    }
}
