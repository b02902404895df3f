//! The schemes, written once for a coordinate, or for the coordinates of a row at once.

use granule_state::Number;

/// The time step and half of it, in the form of the numbers that it is multiplied with.
#[derive(Clone, Copy, Debug)]
pub struct Step<N> {
    /// dt \[s\].
    pub full: N,
    /// dt / 2 \[s\].
    pub half: N,
}

impl Step<f64> {
    /// The step of a single number.
    pub fn of(dt: f64) -> Self {
        Self { full: dt, half: 0.5 * dt }
    }
}

/// What a scheme keeps of a coordinate from the beginning of a step on.
#[derive(Clone, Copy, Debug)]
pub struct Memory<N> {
    /// Acceleration at the beginning of the step.
    pub previous: N,
    /// Acceleration with which the velocity was predicted.
    pub predicted: N,
}

/// A scheme acts on each coordinate `x` with velocity `v`, acceleration `a` and, if it wants them, remembered
/// accelerations. Rotation is treated in the same way; its angles are not kept, so `x` is then scratch.
pub trait Scheme: Send + Sync + 'static {
    /// Name in scenes.
    const NAME: &'static str;
    /// Order of convergence for smooth forces, velocity-dependent ones included.
    const ORDER: u32;
    /// Order of convergence for smooth forces that do not depend on velocity.
    const CONSERVATIVE_ORDER: u32;
    /// True if forces see velocities of the time of the positions.
    const SYNCHRONISED: bool;
    /// True if it remembers the acceleration of the last step.
    const PREVIOUS: bool;
    /// True if it remembers the acceleration of its prediction.
    const PREDICTED: bool = false;
    /// Largest ω dt at which an undamped oscillator of angular frequency ω stays bounded.
    const STABILITY: f64;
    /// Time of the force evaluation, as a fraction of the step.
    const FORCE_TIME: f64 = 1.0;

    /// From the end of the last step to the force evaluation of this one.
    fn begin<N: Number>(x: &mut N, v: &mut N, a: N, memory: &mut Memory<N>, dt: Step<N>);
    /// From the force evaluation to the end of the step.
    fn finish<N: Number>(x: &mut N, v: &mut N, a: N, memory: Memory<N>, dt: Step<N>);
}

/// Velocity Verlet whose forces see the velocity predicted to the end of the step, v + a dt; the kick is then corrected
/// to the mean of both accelerations. Second order with damping.
pub struct VelocityVerlet;

impl Scheme for VelocityVerlet {
    const NAME: &'static str = "VelocityVerlet";
    const ORDER: u32 = 2;
    const CONSERVATIVE_ORDER: u32 = 2;
    const SYNCHRONISED: bool = true;
    const PREVIOUS: bool = true;
    const STABILITY: f64 = 2.0;

    #[inline(always)]
    fn begin<N: Number>(x: &mut N, v: &mut N, a: N, memory: &mut Memory<N>, dt: Step<N>) {
        *x = *x + dt.full * (*v + dt.half * a);
        *v = *v + dt.full * a;
        memory.previous = a;
    }

    #[inline(always)]
    fn finish<N: Number>(_x: &mut N, v: &mut N, a: N, memory: Memory<N>, dt: Step<N>) {
        *v = *v + dt.half * (a - memory.previous);
    }
}

/// Velocity Verlet with half-step velocities in the forces, as LAMMPS and LIGGGHTS do it. Second order without damping,
/// first order with it.
pub struct ClassicVelocityVerlet;

impl Scheme for ClassicVelocityVerlet {
    const NAME: &'static str = "ClassicVelocityVerlet";
    const ORDER: u32 = 1;
    const CONSERVATIVE_ORDER: u32 = 2;
    const SYNCHRONISED: bool = false;
    const PREVIOUS: bool = false;
    const STABILITY: f64 = 2.0;

    #[inline(always)]
    fn begin<N: Number>(x: &mut N, v: &mut N, a: N, _memory: &mut Memory<N>, dt: Step<N>) {
        *v = *v + dt.half * a;
        *x = *x + dt.full * *v;
    }

    #[inline(always)]
    fn finish<N: Number>(_x: &mut N, v: &mut N, a: N, _memory: Memory<N>, dt: Step<N>) {
        *v = *v + dt.half * a;
    }
}

/// Leapfrog in its drift-kick-drift form: half a drift, forces at the middle of the step, a full kick, half a drift.
/// Forces see the velocity of the beginning of the step: first order with damping.
pub struct Leapfrog;

impl Scheme for Leapfrog {
    const NAME: &'static str = "Leapfrog";
    const ORDER: u32 = 1;
    const CONSERVATIVE_ORDER: u32 = 2;
    const SYNCHRONISED: bool = false;
    const PREVIOUS: bool = false;
    const STABILITY: f64 = 2.0;
    const FORCE_TIME: f64 = 0.5;

    #[inline(always)]
    fn begin<N: Number>(x: &mut N, v: &mut N, _a: N, _memory: &mut Memory<N>, dt: Step<N>) {
        *x = *x + dt.half * *v;
    }

    #[inline(always)]
    fn finish<N: Number>(x: &mut N, v: &mut N, a: N, _memory: Memory<N>, dt: Step<N>) {
        *v = *v + dt.full * a;
        *x = *x + dt.half * *v;
    }
}

/// Symplectic Euler: a full kick with the forces of the last positions, then a full drift. First order.
pub struct SymplecticEuler;

impl Scheme for SymplecticEuler {
    const NAME: &'static str = "SymplecticEuler";
    const ORDER: u32 = 1;
    const CONSERVATIVE_ORDER: u32 = 1;
    const SYNCHRONISED: bool = true;
    const PREVIOUS: bool = false;
    const STABILITY: f64 = 2.0;

    #[inline(always)]
    fn begin<N: Number>(x: &mut N, v: &mut N, a: N, _memory: &mut Memory<N>, dt: Step<N>) {
        *v = *v + dt.full * a;
        *x = *x + dt.full * *v;
    }

    #[inline(always)]
    fn finish<N: Number>(_x: &mut N, _v: &mut N, _a: N, _memory: Memory<N>, _dt: Step<N>) {}
}

/// Velocity Verlet for contacts that are resolved where they begin and end. The force loop gives the true impulse of a step
/// in which a contact begins or ends within it; here the forces see the velocity predicted with an acceleration that is
/// extrapolated from the last two, so that damping is of second order with a small error, too.
pub struct ContactResolved;

impl Scheme for ContactResolved {
    const NAME: &'static str = "ContactResolved";
    const ORDER: u32 = 2;
    const CONSERVATIVE_ORDER: u32 = 2;
    const SYNCHRONISED: bool = true;
    const PREVIOUS: bool = true;
    const PREDICTED: bool = true;
    const STABILITY: f64 = 2.0;

    #[inline(always)]
    fn begin<N: Number>(x: &mut N, v: &mut N, a: N, memory: &mut Memory<N>, dt: Step<N>) {
        let half = *v + dt.half * a;
        *x = *x + dt.full * half;
        let predicted = a + (a - memory.previous);
        *v = half + dt.half * predicted;
        *memory = Memory { previous: a, predicted };
    }

    #[inline(always)]
    fn finish<N: Number>(_x: &mut N, v: &mut N, a: N, memory: Memory<N>, dt: Step<N>) {
        *v = *v + dt.half * (a - memory.predicted);
    }
}
