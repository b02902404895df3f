//! Many bodies of very different sizes, and fast ones: no contact is missed.

use granule_drivers::View;

use crate::run::ensure;
use crate::scene::{Ball, ball, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "sizes-of-a-thousand",
        extreme: "10 spheres of 100 mm among 5000 of 0.1 mm (1:1000)",
        expected: "the contacts that brute force finds, all of them",
        slow: false,
        check: |lab| sizes(lab, 5_000),
    },
    Case {
        name: "sizes-of-a-thousand-many",
        extreme: "10 spheres of 100 mm among 1e5 of 0.1 mm (1:1000)",
        expected: "the contacts that brute force finds, all of them",
        slow: true,
        check: |lab| sizes(lab, 100_000),
    },
    Case {
        name: "faster-than-the-skin",
        extreme: "bodies that move by more than the skin of the neighbour lists in every step",
        expected: "at every step the contacts that brute force finds",
        slow: false,
        check: faster_than_the_skin,
    },
];

/// Number of pairs that overlap, by trying all of them.
fn brute_force(view: &View<'_>) -> u64 {
    let rows = &view.bodies().position;
    let cell = view.plan().cell;
    let mut touching = 0;
    for (i, a) in rows.iter().enumerate() {
        for b in &rows[i + 1..] {
            let (apart, _) = cell.minimum_image([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
            let reach = a[3] + b[3];
            if apart.iter().map(|c| c * c).sum::<f64>() < reach * reach {
                touching += 1;
            }
        }
    }
    touching
}

/// Numbers between 0 and 1 that fill space evenly: multiples of a root of x^4 = x + 1.
fn spread(index: usize) -> [f64; 3] {
    let share: f64 = 1.0 / 1.220_744_084_605_76;
    std::array::from_fn(|axis| (0.5 + share.powi(axis as i32 + 1) * index as f64).fract())
}

/// Ten spheres of 100 mm, and this many of 0.1 mm: a third in a dense cloud in which they touch each other, the rest
/// everywhere.
pub fn crowd(small: usize) -> Vec<Ball> {
    let mut balls: Vec<Ball> = (0..10)
        .map(|k| Ball {
            radius: 0.1,
            mass: 1.0,
            ..ball(spread(1000 + 7 * k).map(|c| 0.2 + 0.6 * c), [0.0; 3])
        })
        .collect();
    for k in 0..small {
        let wide = if k % 3 == 0 { 0.003 * (small as f64 / 5_000.0).cbrt() } else { 1.0 };
        balls.push(Ball { radius: 1e-4, mass: 1e-9, ..ball(spread(k).map(|c| wide * c), [0.0; 3]) });
    }
    balls
}

/// 64 spheres of 20 mm with speeds of up to 1 km/s along each axis, in a cube of 0.3 m.
pub fn swarm() -> Vec<Ball> {
    let fast = |k| {
        let velocity = spread(500 + k).map(|c| 2000.0 * (c - 0.5));
        Ball { radius: 0.02, ..ball(spread(k).map(|c| 0.3 * c), velocity) }
    };
    (0..64).map(fast).collect()
}

fn sizes(lab: &Lab, small: usize) -> Result<String, String> {
    let text = scene(
        &crowd(small),
        "normal: LinearSpringDashpot(stiffness: 1e-3, restitution: 0.8)",
        "allow_overlap: true, driver: TimeStep(), run: (steps: 0)",
    );
    let (mut found, mut truth) = (0, 0);
    lab.watch(&text, &mut |view, _| {
        (found, truth) = (view.tally().contacts, brute_force(view));
        Ok(())
    })?;
    ensure(found == truth && truth > small as u64 / 10, || {
        format!("{found} contacts, and {truth} there are")
    })?;
    Ok(format!("{found} contacts, {truth} by brute force"))
}

fn faster_than_the_skin(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &swarm(),
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "allow_overlap: true, cell: (lo: (0, 0, 0), hi: (0.3, 0.3, 0.3), periodic: (true, true, true)), driver: \
         TimeStep(step: 1e-5, skin: 1e-3), run: (steps: 500)",
    );
    let (mut all, mut fastest): (u64, f64) = (0, 0.0);
    lab.watch(&text, &mut |view, state| {
        let (found, truth) = (view.tally().contacts, brute_force(view));
        all += truth;
        fastest = state.iter().fold(fastest, |fastest, body| fastest.max(body.speed() * 1e-5));
        ensure(found == truth, || format!("step {}: {found} contacts, and {truth} there are", view.step()))
    })?;
    ensure(all > 1000 && fastest > 2e-3, || format!("{all} contacts, {fastest} m a step"))?;
    Ok(format!("all {all} contacts at up to {:.0} skins a step", fastest / 1e-3))
}
