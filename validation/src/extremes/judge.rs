//! Whether the end of an engine's run is what it must be. Tolerances are those of our own cases, but never under 2e-3 for
//! restitutions: the engines' damping is of first order in the step, and trials take 500 steps in a contact or more.

use crate::peers::{Frame, PeerScene};

type Verdict = Result<String, String>;

const FIRST_ORDER: f64 = 2e-3;

fn verdict(right: bool, found: String, expected: &str) -> Verdict {
    if right { Ok(found) } else { Err(format!("{found} where {expected}")) }
}

fn ends(frames: &[Frame]) -> Result<(&Frame, &Frame), String> {
    match (frames.first(), frames.last()) {
        (Some(first), Some(last)) if last.step > first.step => Ok((first, last)),
        _ => Err("nothing was dumped".into()),
    }
}

/// All vectors of the last frame, or why not.
fn end(frames: &[Frame]) -> Result<&Frame, String> {
    let (_, last) = ends(frames)?;
    let all = last.position.iter().chain(&last.velocity).chain(&last.angular_velocity);
    if all.flatten().any(|value| !value.is_finite()) {
        return Err("numbers are not finite".into());
    }
    Ok(last)
}

fn approach(scene: &PeerScene) -> f64 {
    scene.bodies[0].velocity[0] - scene.bodies[1].velocity[0]
}

/// The first body comes back with -e v from a partner, e = 0.8.
pub fn reflected(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let [a, b] = [0, 1].map(|k| scene.bodies[k].mass());
    let share = if scene.frozen.is_empty() { b / (a + b) } else { 1.0 };
    let expected = scene.bodies[0].velocity[0] * (1.0 - 1.8 * share);
    let found = last.velocity[0][0];
    verdict(
        (found - expected).abs() < FIRST_ORDER,
        format!("v = {found:.5} m/s"),
        &format!("{expected:.5} m/s is right"),
    )
}

fn parting(scene: &PeerScene, frames: &[Frame]) -> Result<f64, String> {
    let last = end(frames)?;
    Ok((last.velocity[1][0] - last.velocity[0][0]) / approach(scene))
}

/// They part with 0.8 of the speed.
pub fn restitution(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let e = parting(scene, frames)?;
    verdict((e - 0.8).abs() < FIRST_ORDER, format!("e = {e:.5}"), "0.8 is right")
}

/// They part with all of the speed.
pub fn elastic(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let e = parting(scene, frames)?;
    verdict((e - 1.0).abs() < 1e-5, format!("e = {e:.7}"), "1 is right")
}

/// They part with exp(-2) of the speed.
pub fn critical(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let e = parting(scene, frames)?;
    verdict((e - (-2.0f64).exp()).abs() < 1e-3, format!("e = {e:.6}"), "0.135335 is right")
}

/// They part with less than exp(-2) of the speed.
pub fn stopped(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let e = parting(scene, frames)?;
    verdict(e.abs() < 0.135_34, format!("they part with {e:.1e} of the speed"), "less than 0.1353 is right")
}

/// Equal and opposite forces, and bodies that move apart.
pub fn driven_apart(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let force = &last.force;
    let size = force[0].iter().map(|f| f * f).sum::<f64>().sqrt();
    let opposite = (0..3).all(|k| force[0][k] == -force[1][k]);
    verdict(opposite && size > 10.0, format!("a force of {size:.1} N"), "about 200 N are right")
}

/// The energy of the first overlap, k δ²/2, has become motion.
pub fn stored(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let expected = 0.019 * (1e4 / 0.005f64).sqrt();
    let share = (last.velocity[1][0] - last.velocity[0][0]) / expected;
    verdict(
        (share - 1.0).abs() < FIRST_ORDER,
        format!("they part with {share:.4} of the speed"),
        "1 is right",
    )
}

/// The course has not changed.
pub fn undeflected(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let turned = (last.velocity[0][0] - 1.0).abs().max(last.velocity[0][1].abs());
    verdict(turned < 1e-6, format!("the course changes by {turned:.0e}"), "1e-6 is the most")
}

/// Positions in the periodic cell are those of free flight.
pub fn in_place(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let time = scene.time_step * scene.steps as f64;
    let mut worst: f64 = 0.0;
    for (body, position) in scene.bodies.iter().zip(&last.position) {
        let length = scene.upper[0] - scene.lower[0];
        let expected = (body.position[0] + body.velocity[0] * time - scene.lower[0]).rem_euclid(length);
        let off = ((position[0] - scene.lower[0]).rem_euclid(length) - expected).abs();
        worst = worst.max(off.min(length - off));
    }
    verdict(worst < 1e-9, format!("places off by {worst:.0e} m"), "1e-9 m is the most")
}

fn energy(scene: &PeerScene, frame: &Frame) -> f64 {
    let square = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
    let of = |k: usize| {
        let body = &scene.bodies[k];
        let inertia = 0.4 * body.radius().powi(2);
        0.5 * body.mass() * (square(&frame.velocity[k]) + inertia * square(&frame.angular_velocity[k]))
    };
    (0..scene.bodies.len()).map(of).sum()
}

/// No kinetic energy is gained.
pub fn no_gain(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let (first, _) = ends(frames)?;
    let [before, after] = [first, last].map(|frame| energy(scene, frame));
    // Squares of speeds under 1e-154 m/s are no numbers; then the speeds are compared.
    if before == 0.0 {
        let fastest = |frame: &Frame| frame.velocity.iter().flatten().fold(0.0, |a: f64, v| a.max(v.abs()));
        let (a, b) = (fastest(first), fastest(last));
        return verdict(b <= a, format!("speeds from {a:.0e} to {b:.0e} m/s"), "no more is right");
    }
    verdict(after <= before * (1.0 + 1e-12), format!("energy times {:.12}", after / before), "1 is the most")
}

/// Spins are the same bits, velocities across the line of centres stay zero.
pub fn same_spins(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let (first, _) = ends(frames)?;
    let same = first.angular_velocity == last.angular_velocity;
    let across = last.velocity.iter().fold(0.0, |a: f64, v| a.max(v[1].abs()).max(v[2].abs()));
    verdict(
        same && across == 0.0,
        format!("spins {}, {across:.0e} m/s across", if same { "unchanged" } else { "changed" }),
        "no change is right",
    )
}

/// A contact that never slides: the spin of a spring that only swings, k_t = 3e3 N/m, while the contact lasts. The end of the
/// contact (at no force or at no overlap) is a convention, which makes a few per cent.
pub fn rolls(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let body = &scene.bodies[0];
    let (mass, reduced) = (body.mass(), 0.5 * body.mass());
    let share = (0.8f64.ln() / std::f64::consts::PI).powi(2);
    let contact = std::f64::consts::PI * (reduced / 1e4 * (1.0 + share)).sqrt();
    // Seen by a force in the tangent plane, a homogeneous sphere has 2/7 of its mass.
    let slip = body.velocity[1] * (1.0 - (contact * (3e3 / (2.0 / 7.0 * reduced)).sqrt()).cos());
    let expected = -2.0 / 7.0 * reduced * slip / (0.4 * mass * body.radius());
    let found = last.angular_velocity[0][2];
    verdict(
        (found / expected - 1.0).abs() < 0.1,
        format!("spin of {found:.2} rad/s"),
        &format!("{expected:.2} rad/s to 10 % is right"),
    )
}

/// Not a bit has changed.
pub fn unmoved(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let (first, _) = ends(frames)?;
    let same = first.position == last.position && first.velocity == last.velocity;
    verdict(same, if same { "the same bits".into() } else { "bodies have moved".into() }, "none is right")
}

/// The lowest sphere of the column carries the rest: its overlap with the floor is N m g/k to 0.1 %, and all stand straight.
pub fn column(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let overlap = 1e-3 - last.position[0][2];
    let expected = scene.bodies.len() as f64 * 1e-3 * 9.81 / 1e6;
    let aside = last.position.iter().fold(0.0, |a: f64, x| a.max(x[0].abs()).max(x[1].abs()));
    verdict(
        (overlap / expected - 1.0).abs() < 1e-3 && aside == 0.0,
        format!("{:.5} of 1000 m g, {aside:.0e} m aside", overlap / expected),
        "1 and 0 are right",
    )
}

/// x = v t and z = -g t²/2.
pub fn falls(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    let last = end(frames)?;
    let time = scene.time_step * scene.steps as f64;
    let [x, _, z] = last.position[0];
    let off = (x - time).abs().max((z + 0.5 * 9.81 * time * time).abs());
    verdict(off < 1e-10, format!("off by {off:.0e} m"), "1e-10 m is the most")
}

/// Forces on exactly those bodies that overlap with another one, in the first and in the last frame.
pub fn touching(scene: &PeerScene, frames: &[Frame]) -> Verdict {
    end(frames)?;
    let (first, last) = ends(frames)?;
    let (mut right, mut wrong) = (0, 0);
    for frame in [first, last] {
        let mut touches = vec![false; scene.bodies.len()];
        for i in 0..scene.bodies.len() {
            for j in i + 1..scene.bodies.len() {
                let reach = scene.bodies[i].radius() + scene.bodies[j].radius();
                let apart = |axis: usize| {
                    let apart = (frame.position[i][axis] - frame.position[j][axis]).abs();
                    let length = scene.upper[axis] - scene.lower[axis];
                    if scene.periodic[axis] { apart.min(length - apart) } else { apart }
                };
                // Not within the round-off of positions.
                if (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>() < reach * reach * (1.0 - 1e-12) {
                    (touches[i], touches[j]) = (true, true);
                }
            }
        }
        for (touches, force) in touches.iter().zip(&frame.force) {
            if *touches == force.iter().any(|f| *f != 0.0) { right += 1 } else { wrong += 1 }
        }
    }
    verdict(wrong == 0, format!("forces right on {right} bodies, wrong on {wrong}"), "none wrong is right")
}

/// Overlaps of 1 mm and 0.5 mm on both sides of the first body: a force of -5 N in the first frame.
pub fn both_sides(_: &PeerScene, frames: &[Frame]) -> Verdict {
    let (first, _) = ends(frames)?;
    let force = first.force[0][0];
    verdict((force + 5.0).abs() < 1e-6, format!("a force of {force:.3} N"), "-5 N is right")
}
