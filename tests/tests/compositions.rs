//! Every registered normal law with every registered tangential law: the reference integrator against time steps.

use std::path::Path;

use granule_law_api::{LawEntry, Registry, Slot};
use granule_reference::{Collision, ReferenceError};
use granule_tests::{BodyState, plan, run};

/// Numbers between 0 and 1, the same in every run (SplitMix64).
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn span(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }
}

/// A law with parameters, as in a scene.
fn law(entry: &LawEntry, example: &[(&str, f64)]) -> String {
    let values: Vec<String> = example.iter().map(|(name, value)| format!("{name}: {value:?}")).collect();
    format!("{}({})", entry.info.name, values.join(", "))
}

/// Bodies that touch at the start, spin about all axes, and hit a wall or another sphere of another size.
struct Impact {
    bodies: String,
    speed: f64,
}

impl Impact {
    fn random(draw: &mut Draw) -> Self {
        let speed = 10f64.powf(draw.span(-1.5, 0.3));
        let psi = 10f64.powf(draw.span(-1.5, 1.0));
        let radius = 1e-3 * draw.span(0.4, 1.0);
        let spin = [(); 3].map(|()| draw.span(-1.0, 1.0) * speed * psi / radius);
        let other = if draw.unit() < 0.5 {
            r#"], walls: { "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") },"#
        } else {
            r#", Sphere(material: "a", radius: 1e-3, position: (0, 0, -1e-3))],"#
        };
        let bodies = format!(
            r#"bodies: [Sphere(material: "a", radius: {radius:e}, position: (0, 0, {radius:e}),
            velocity: ({:e}, 0, {:e}), spin: ({:e}, {:e}, {:e})){other}"#,
            psi * speed,
            -speed,
            spin[0],
            spin[1],
            spin[2]
        );
        Self { bodies, speed: speed * f64::hypot(1.0, 2.0 * psi) }
    }

    fn scene(&self, laws: &str, run: &str) -> String {
        let Self { bodies, .. } = self;
        format!(
            r#"(version: 1, materials: {{ "a": (density: 2500) }}, {bodies}
            contacts: [(between: ("a", "a"), {laws})], {run})"#
        )
    }

    /// The engine after a time, in so many steps; nothing if such steps are too long for the laws.
    fn stepped(&self, laws: &str, time: f64, steps: u32, registry: &Registry) -> Option<Vec<BodyState>> {
        let step = time / f64::from(steps);
        let scene = self.scene(
            laws,
            &format!("driver: TimeStep(step: {step:e}, packing_limit: false), run: (steps: {steps})"),
        );
        allowed(&scene, registry).then(|| run(&scene))
    }
}

/// Whether a scene has a plan.
fn allowed(scene: &str, registry: &Registry) -> bool {
    let parsed = granule_scene::parse(scene).scene.expect("a scene");
    granule_plan::build(&parsed, registry, Path::new(".")).0.is_some()
}

/// Largest difference of velocities and of surface velocities \[m/s\].
fn difference(a: &[BodyState], b: &[BodyState]) -> f64 {
    let mut largest: f64 = 0.0;
    for (a, b) in a.iter().zip(b) {
        for axis in 0..3 {
            largest = largest.max((a.velocity[axis] - b.velocity[axis]).abs());
            largest = largest.max(1e-3 * (a.spin[axis] - b.spin[axis]).abs());
        }
    }
    largest
}

/// What came of an impact.
enum Verdict {
    /// The composition is not allowed.
    Refused,
    /// Dampers beyond critical damping let the overlap creep, and a contact that ends with its overlap never does.
    Creeps,
    /// Both agree.
    Agrees,
}

fn compare(impact: &Impact, laws: &str, registry: &Registry) -> Verdict {
    let once = impact.scene(laws, "run: (steps: 1)");
    if !allowed(&once, registry) {
        return Verdict::Refused;
    }
    let plan = plan(&once);
    let (collision, composition) = Collision::of_plan(&plan).unwrap();
    let outcome = match collision.run(composition) {
        Ok(outcome) => outcome,
        Err(ReferenceError::NoEnd(time)) => {
            let slow = impact.stepped(laws, 1e-3 * time, 100_000, registry);
            let Some(slow) = slow else { return Verdict::Creeps };
            // Towards each other: the line of centres of a pair may have turned.
            let rest = match slow.get(1) {
                Some(other) => {
                    let apart = |axis: usize| slow[0].position[axis] - other.position[axis];
                    let along = |axis: usize| (slow[0].velocity[axis] - other.velocity[axis]) * apart(axis);
                    let distance = (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>().sqrt();
                    (0..3).map(along).sum::<f64>() / distance
                }
                None => slow[0].velocity[2],
            };
            // In the end, bodies hardly move along it.
            assert!(rest.abs() < 0.05 * impact.speed, "{laws}: {rest} although the contact does not end");
            return Verdict::Creeps;
        }
        Err(error) => panic!("{error}\n{once}"),
    };
    let speed = impact.speed;
    assert!(outcome.error < 1e-3, "{}\n{once}", outcome.error);
    let exact: Vec<BodyState> = outcome
        .bodies
        .iter()
        .filter(|body| body.mass.is_finite())
        .map(|body| BodyState {
            position: [0.0; 3],
            velocity: body.velocity,
            spin: body.spin,
            force: [0.0; 3],
            torque: [0.0; 3],
        })
        .collect();
    let time = 1.05 * outcome.duration;
    // Velocity Verlet is of first order where forces jump, with an error that depends on where the step lies against the jump. So
    // the error is within a few times the largest change from one step to others that are no multiple of it.
    let mut found = (f64::INFINITY, 0.0);
    for steps in [1600, 6400, 25_600, 102_400] {
        let in_steps = |steps| impact.stepped(laws, time, steps, registry);
        let Some(fine) = in_steps(steps) else { continue };
        let coarser: Vec<_> = [5, 6, 7].iter().filter_map(|eighths| in_steps(steps / 8 * eighths)).collect();
        let estimate = coarser.iter().map(|other| difference(&fine, other)).fold(0.0, f64::max);
        found = (difference(&fine, &exact), 6.0 * estimate + (10.0 * outcome.error + 1e-4) * speed);
        if found.0 < found.1.min(1e-3 * speed) {
            break;
        }
    }
    let (error, allowed) = found;
    assert!(error < allowed.min(2e-3 * speed), "{laws}: {error} of {speed}, {allowed} allowed\n{once}");
    Verdict::Agrees
}

/// Runs `rounds` impacts of each pair of laws, with examples at random, under each end of contact.
fn compare_all(seed: u64, rounds: usize) {
    let registry = Registry::collect().unwrap();
    let mut draw = Draw(seed);
    let (mut agree, mut creep, mut refused) = (0, 0, 0);
    let of = |slot| registry.entries().iter().filter(move |entry| entry.info.slot == slot);
    for normal in of(Slot::Normal) {
        for tangential in of(Slot::Tangential) {
            let mut pairs = Vec::new();
            for &n in normal.info.examples {
                pairs.extend(tangential.info.examples.iter().map(|&t| (n, t)));
            }
            let pairs: Vec<_> = (0..rounds).map(|_| draw.one(&pairs)).collect();
            for (n, t) in pairs {
                for end in ["Force", "Overlap"] {
                    let impact = Impact::random(&mut draw);
                    let laws = format!(
                        "contact_end: {end}, normal: {}, tangential: {}",
                        law(normal, n),
                        law(tangential, t)
                    );
                    match compare(&impact, &laws, &registry) {
                        Verdict::Refused => refused += 1,
                        Verdict::Creeps => creep += 1,
                        Verdict::Agrees => agree += 1,
                    }
                }
            }
        }
    }
    println!("{agree} agree, {creep} creep, {refused} are refused");
    // Few examples damp so much, and few compositions are refused: those whose tangential law needs what the normal law lacks.
    assert!(agree > 4 * creep && agree > refused, "{agree} agree, {creep} creep, {refused} are refused");
}

#[test]
fn the_reference_agrees_with_time_steps() {
    compare_all(1, 1);
}
