//! The schemes, written once for a single coordinate.

/// A scheme acts on each coordinate `x` with velocity `v`, acceleration `a` and, if it wants one, a remembered
/// acceleration `previous`. Rotation is treated in the same way; its angles are not kept, so `x` is then scratch.
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
    /// Largest ω dt at which an undamped oscillator of angular frequency ω stays bounded.
    const STABILITY: f64;
    /// Time of the force evaluation, as a fraction of the step.
    const FORCE_TIME: f64 = 1.0;

    /// From the end of the last step to the force evaluation of this one.
    fn begin(x: &mut f64, v: &mut f64, a: f64, previous: &mut f64, dt: f64);
    /// From the force evaluation to the end of the step.
    fn finish(x: &mut f64, v: &mut f64, a: f64, previous: f64, dt: f64);
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
    fn begin(x: &mut f64, v: &mut f64, a: f64, previous: &mut f64, dt: f64) {
        *x += dt * (*v + 0.5 * dt * a);
        *v += dt * a;
        *previous = a;
    }

    #[inline(always)]
    fn finish(_x: &mut f64, v: &mut f64, a: f64, previous: f64, dt: f64) {
        *v += 0.5 * dt * (a - previous);
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
    fn begin(x: &mut f64, v: &mut f64, a: f64, _previous: &mut f64, dt: f64) {
        *v += 0.5 * dt * a;
        *x += dt * *v;
    }

    #[inline(always)]
    fn finish(_x: &mut f64, v: &mut f64, a: f64, _previous: f64, dt: f64) {
        *v += 0.5 * dt * a;
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
    fn begin(x: &mut f64, v: &mut f64, _a: f64, _previous: &mut f64, dt: f64) {
        *x += 0.5 * dt * *v;
    }

    #[inline(always)]
    fn finish(x: &mut f64, v: &mut f64, a: f64, _previous: f64, dt: f64) {
        *v += dt * a;
        *x += 0.5 * dt * *v;
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
    fn begin(x: &mut f64, v: &mut f64, a: f64, _previous: &mut f64, dt: f64) {
        *v += dt * a;
        *x += dt * *v;
    }

    #[inline(always)]
    fn finish(_x: &mut f64, _v: &mut f64, _a: f64, _previous: f64, _dt: f64) {}
}
