//! Inputs as text, and what the engines say when things go wrong.

use std::time::Duration;

use super::*;
use crate::cases;

fn scene(slug: &str, law: &str) -> PeerScene {
    let case = cases::all().into_iter().find(|case| case.slug == slug).unwrap();
    case.scenes().into_iter().find(|(name, _)| name == law).unwrap().1
}

/// Skips, aloud, where the engine is missing.
fn installed(engine: Engine) -> bool {
    let found = find_binary(engine).is_some();
    if !found {
        println!("SKIPPED: {} is not installed", engine.name());
    }
    found
}

#[test]
fn lammps_script() {
    let files = inputs(&scene("wall-corner", "lammps-granular-hooke")).unwrap();
    assert_eq!(
        files.script,
        "# wall-corner, lammps-granular-hooke
units si
atom_style sphere
boundary f f f
processors * * 1
newton off
comm_modify vel yes
read_data bodies.data
neighbor 0.002 bin
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff 1 1 hooke 1000.0 58.6 tangential linear_history 285.7142857142857 0.5 0.5 damping mass_velocity
fix w1all all wall/gran granular hooke 1000.0 58.6 tangential linear_history 285.7142857142857 0.5 0.5 damping mass_velocity zplane 0.0 NULL
fix w2all all wall/gran granular hooke 1000.0 58.6 tangential linear_history 285.7142857142857 0.5 0.5 damping mass_velocity xplane NULL 0.00602
fix g all gravity 9.81 vector 0.0 0.0 -1.0
fix i all nve/sphere
timestep 2e-5
dump d all custom 15 frames.dump id x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz
dump_modify d sort id format float %.17g
thermo 450
thermo_modify lost error norm no
run 450
"
    );
    let atoms = files.bodies.lines().find(|line| line.starts_with("1 1 ")).unwrap();
    let numbers: Vec<f64> = atoms.split(' ').skip(2).map(|word| word.parse().unwrap()).collect();
    assert_eq!(numbers, [0.01, 2500.0, 0.001, -0.002, 5e-3 + 1e-5]);
}

#[test]
fn liggghts_script() {
    let files = inputs(&scene("two-materials", "liggghts-hertz")).unwrap();
    assert_eq!(
        files.script,
        "# two-materials, liggghts-hertz
units si
atom_style granular
atom_modify map array
boundary f f f
processors * * 1
newton off
communicate single vel yes
read_data bodies.data
neighbor 0.0002 bin
neigh_modify delay 0 every 1 check yes
fix coefficientFriction all property/global coefficientFriction peratomtypepair 2 0.5 0.35 0.35 0.2
fix coefficientRestitution all property/global coefficientRestitution peratomtypepair 2 0.9 0.75 0.75 0.6
fix youngsModulus all property/global youngsModulus peratomtype 100000000.0 30000000.0
fix poissonsRatio all property/global poissonsRatio peratomtype 0.25 0.3
pair_style gran model hertz tangential history tangential_damping on limitForce off
pair_coeff * *
fix i all nve/sphere
timestep 1e-6
dump d all custom 10 frames.dump id x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz
dump_modify d sort id format \"%d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\"
thermo 400
thermo_modify lost error norm no
run 400
"
    );
}

#[test]
fn what_an_engine_cannot_do_is_said_before_it_runs() {
    let hard = scene("two-materials", "lammps-granular-hooke");
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
    let mut mixed = scene("two-materials", "liggghts-hooke-stiffness");
    let hertz = scene("two-materials", "liggghts-hertz").laws[&(1, 2)];
    mixed.laws.insert((1, 2), hertz);
    assert!(matches!(inputs(&mixed), Err(PeerError::Unsupported(Engine::Liggghts, _))));
    let mut rising = scene("wall-belt", "lammps-hooke-history");
    rising.walls[0].velocity = [0.0, 0.0, 0.1];
    assert!(matches!(inputs(&rising), Err(PeerError::Scene(_))));
    let mut moving = scene("frozen-partner", "lammps-hooke-history");
    moving.bodies[1].velocity[0] = 0.1;
    assert!(matches!(inputs(&moving), Err(PeerError::Scene(_))));
}

#[test]
fn a_lost_body_a_refused_value_and_a_long_run_are_errors_with_the_engines_words() {
    let folder = tempfile::tempdir().unwrap();
    for law in ["lammps-hooke-history", "liggghts-hooke-stiffness"] {
        let mut lost = scene("oblique-sliding", law);
        if !installed(lost.check().unwrap()) {
            continue;
        }
        lost.bodies[0].velocity = [500.0, 0.0, 0.0];
        let error = run(&lost, folder.path(), &RunOptions::default()).unwrap_err();
        assert!(matches!(error, PeerError::Failed(..)), "{error}");
        assert!(error.to_string().to_lowercase().contains("lost"), "{error}");

        let mut endless = scene("oblique-sliding", law);
        endless.bodies.iter_mut().for_each(|body| body.velocity = [0.0; 3]);
        (endless.steps, endless.dump_every) = (1_000_000_000, 0);
        let options = RunOptions { timeout: Duration::from_millis(1500), ..RunOptions::default() };
        let error = run(&endless, folder.path(), &options).unwrap_err();
        assert!(matches!(error, PeerError::Timeout(..)), "{error}");
    }
    if installed(Engine::Liggghts) {
        let mut refused = scene("head-on-hertz", "liggghts-hertz");
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
    for law in ["lammps-hooke-history", "liggghts-hooke-stiffness"] {
        let mut timed = scene("oblique-sliding", law);
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
