//! One pass over the rows of a tile.

use granule_state::{InstructionSet, Lanes, Portable, Row};

use crate::integrator::{Pass, Tile};
use crate::schemes::{Memory, Scheme, Step};

/// A pass with the instruction set that the tile names.
pub(crate) fn pass<S: Scheme, const FINISH: bool, const BEGIN: bool>(tile: &mut Tile<'_>, dt: f64) -> Pass {
    match tile.instructions {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => {
            // SAFETY: `InstructionSet::detect` has found the instruction set on this machine.
            #[expect(
                unsafe_code,
                reason = "calling a function that was compiled for a detected instruction set"
            )]
            unsafe {
                pass_avx2::<S, FINISH, BEGIN>(tile, dt)
            }
        }
        InstructionSet::Baseline => pass_with::<S, Portable, FINISH, BEGIN>(tile, dt),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn pass_avx2<S: Scheme, const FINISH: bool, const BEGIN: bool>(tile: &mut Tile<'_>, dt: f64) -> Pass {
    pass_with::<S, granule_state::Avx2, FINISH, BEGIN>(tile, dt)
}

#[inline(always)]
fn pass_with<S: Scheme, L: Lanes, const FINISH: bool, const BEGIN: bool>(
    tile: &mut Tile<'_>,
    dt: f64,
) -> Pass {
    if tile.planar {
        return in_plane::<S, FINISH, BEGIN>(tile, dt);
    }
    let mut result = translate::<S, L, FINISH, BEGIN>(tile, dt);
    if !tile.spin.is_empty() {
        result.poison += rotate::<S, L, FINISH, BEGIN>(tile, dt);
    }
    result
}

/// Time step for the vector in a row. The last number of a row is no coordinate: its step is zero, and adding zero leaves
/// it as it is.
#[inline(always)]
fn row_step<L: Lanes>(dt: f64) -> Step<L> {
    let of = |dt| L::load(&[dt, dt, dt, 0.0]);
    Step { full: of(dt), half: of(0.5 * dt) }
}

/// Rows are advanced as vectors of four, and squares of distances are added up for four bodies together: a third of the
/// instructions of a loop over coordinates.
#[inline(always)]
fn translate<S: Scheme, L: Lanes, const FINISH: bool, const BEGIN: bool>(
    tile: &mut Tile<'_>,
    dt: f64,
) -> Pass {
    let count = tile.position.len();
    let (position, velocity) = (&mut tile.position[..count], &mut tile.velocity[..count]);
    let force = &tile.force[..count];
    let previous = if S::PREVIOUS { &mut tile.previous[..count] } else { &mut [] };
    let predicted = if S::PREDICTED { &mut tile.predicted[..count] } else { &mut [] };
    let dt = row_step::<L>(dt);
    let zero = L::splat(0.0);
    let (mut largest, mut poison) = (zero, zero);
    let mut none = [Row::ZERO; 2];
    // A macro, because a closure of this size would not be inlined and would lose the instruction set.
    macro_rules! advance {
        ($body:expr) => {{
            let body = $body;
            let memory = memory::<S>(previous, predicted, &mut none, body);
            let (x, v) = (&mut position[body], &mut velocity[body]);
            let before = L::load(&x.0);
            let (at, speed) =
                step::<S, L, FINISH, BEGIN>(before, L::load(&v.0), L::load(&force[body].0), memory, dt);
            at.store(&mut x.0);
            speed.store(&mut v.0);
            poison = poison + (at + speed) * zero;
            at - before
        }};
    }
    let whole = count - count % 4;
    for body in (0..whole).step_by(4) {
        let moved = [advance!(body), advance!(body + 1), advance!(body + 2), advance!(body + 3)];
        largest = squared(L::transpose(moved)).max(largest);
    }
    for body in whole..count {
        largest = squared(L::transpose([advance!(body), zero, zero, zero])).max(largest);
    }
    let mut squares = [0.0; 4];
    largest.store(&mut squares);
    Pass { maximum_displacement_squared: squares.into_iter().fold(0.0, f64::max), poison: sum(poison) }
}

/// The rows that the scheme remembers for a body.
#[inline(always)]
fn memory<'a, S: Scheme>(
    previous: &'a mut [Row],
    predicted: &'a mut [Row],
    none: &'a mut [Row; 2],
    body: usize,
) -> Memory<&'a mut Row> {
    let [first, second] = none;
    Memory {
        previous: if S::PREVIOUS { &mut previous[body] } else { first },
        predicted: if S::PREDICTED { &mut predicted[body] } else { second },
    }
}

/// New position and velocity of one row; the last number of `v` is the inverse mass or inertia.
#[inline(always)]
fn step<S: Scheme, L: Lanes, const FINISH: bool, const BEGIN: bool>(
    mut x: L,
    mut v: L,
    force: L,
    memory: Memory<&mut Row>,
    dt: Step<L>,
) -> (L, L) {
    let a = force * v.spread_last();
    let load = |wanted: bool, row: &Row| if wanted { L::load(&row.0) } else { L::splat(0.0) };
    let mut kept = Memory {
        previous: load(S::PREVIOUS, memory.previous),
        predicted: load(S::PREDICTED && FINISH, memory.predicted),
    };
    if FINISH {
        S::finish(&mut x, &mut v, a, kept, dt);
    }
    if BEGIN {
        S::begin(&mut x, &mut v, a, &mut kept, dt);
        if S::PREVIOUS {
            kept.previous.store(&mut memory.previous.0);
        }
        if S::PREDICTED {
            kept.predicted.store(&mut memory.predicted.0);
        }
    }
    (x, v)
}

#[inline(always)]
fn squared<L: Lanes>([x, y, z, _]: [L; 4]) -> L {
    x * x + y * y + z * z
}

#[inline(always)]
fn sum<L: Lanes>(value: L) -> f64 {
    let mut numbers = [0.0; 4];
    value.store(&mut numbers);
    numbers[0] + numbers[1] + numbers[2] + numbers[3]
}

#[inline(always)]
fn rotate<S: Scheme, L: Lanes, const FINISH: bool, const BEGIN: bool>(tile: &mut Tile<'_>, dt: f64) -> f64 {
    let count = tile.spin.len();
    let (spin, torque) = (&mut tile.spin[..count], &tile.torque[..count]);
    let previous = if S::PREVIOUS { &mut tile.previous_angular[..count] } else { &mut [] };
    let predicted = if S::PREDICTED { &mut tile.predicted_angular[..count] } else { &mut [] };
    let dt = row_step::<L>(dt);
    let zero = L::splat(0.0);
    let mut poison = zero;
    let mut none = [Row::ZERO; 2];
    for body in 0..count {
        let memory = memory::<S>(previous, predicted, &mut none, body);
        let w = &mut spin[body];
        let (_, speed) =
            step::<S, L, FINISH, BEGIN>(zero, L::load(&w.0), L::load(&torque[body].0), memory, dt);
        speed.store(&mut w.0);
        poison = poison + speed * zero;
    }
    sum(poison)
}

/// The plane: rows hold x, y and the spin.
#[inline(always)]
fn in_plane<S: Scheme, const FINISH: bool, const BEGIN: bool>(tile: &mut Tile<'_>, dt: f64) -> Pass {
    let count = tile.position.len();
    let (position, velocity) = (&mut tile.position[..count], &mut tile.velocity[..count]);
    let force = &tile.force[..count];
    let dt = Step::of(dt);
    let (mut largest, mut poison): (f64, f64) = (0.0, 0.0);
    for body in 0..count {
        let (x, v) = (&mut position[body].0, &mut velocity[body].0);
        let inverse_mass = v[3];
        let mut moved_squared = 0.0;
        let row = |wanted: bool, rows: &[Row]| if wanted { rows[body].0 } else { [0.0; 4] };
        let mut previous = row(S::PREVIOUS, tile.previous);
        let mut predicted = row(S::PREDICTED, tile.predicted);
        for k in 0..2 {
            let before = x[k];
            one::<S, FINISH, BEGIN>(
                &mut x[k],
                &mut v[k],
                force[body].0[k] * inverse_mass,
                Memory { previous: &mut previous[k], predicted: &mut predicted[k] },
                dt,
            );
            let moved = x[k] - before;
            moved_squared += moved * moved;
        }
        if let Some(inverse_inertia) = tile.planar_inverse_inertia.get(body) {
            let a = force[body].0[2] * inverse_inertia;
            let memory = Memory { previous: &mut previous[2], predicted: &mut predicted[2] };
            one::<S, FINISH, BEGIN>(&mut 0.0, &mut v[2], a, memory, dt);
        }
        if S::PREVIOUS && BEGIN {
            tile.previous[body] = Row(previous);
        }
        if S::PREDICTED && BEGIN {
            tile.predicted[body] = Row(predicted);
        }
        largest = if moved_squared > largest { moved_squared } else { largest };
        poison += (x[0] + x[1] + v[0] + v[1] + v[2]) * 0.0;
    }
    Pass { maximum_displacement_squared: largest, poison }
}

#[inline(always)]
fn one<S: Scheme, const FINISH: bool, const BEGIN: bool>(
    x: &mut f64,
    v: &mut f64,
    a: f64,
    memory: Memory<&mut f64>,
    dt: Step<f64>,
) {
    let mut kept = Memory { previous: *memory.previous, predicted: *memory.predicted };
    if FINISH {
        S::finish(x, v, a, kept, dt);
    }
    if BEGIN {
        S::begin(x, v, a, &mut kept, dt);
        (*memory.previous, *memory.predicted) = (kept.previous, kept.predicted);
    }
}
