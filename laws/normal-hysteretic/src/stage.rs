//! The loop.

use granule_law_api::{ContactChunk, Real, Stage, vectorised};

use crate::model::{Model, limit_per_radius};

const FIXED: u8 = 0;
const PROPORTIONAL: u8 = 1;
const GROWING: u8 = 2;

struct Hysteretic<T, const MODEL: u8> {
    /// k_1, or k_1/m12.
    loading: T,
    /// k_2, or k_2/m12.
    largest: T,
    /// δ_lim/R*; unused if k_2 is constant.
    limit_per_radius: T,
    /// δ_max over the overlap at which a contact has no force: k_2/(k_2 - k_1); one if it is elastic and always has one.
    stretch: T,
}

pub(crate) fn compile<T: Real>(model: &Model) -> Box<dyn Stage<T>> {
    match *model {
        Model::Fixed { loading, ratio } => constant::<T, FIXED>(loading, ratio),
        Model::Proportional { per_mass, ratio } => constant::<T, PROPORTIONAL>(per_mass, ratio),
        Model::Growing { loading, largest, depth } => vectorised(Hysteretic::<T, GROWING> {
            loading: T::of(loading),
            largest: T::of(largest),
            limit_per_radius: T::of(limit_per_radius(loading, largest, depth)),
            stretch: T::ONE,
        }),
    }
}

fn constant<T: Real, const MODEL: u8>(loading: f64, ratio: f64) -> Box<dyn Stage<T>> {
    vectorised(Hysteretic::<T, MODEL> {
        loading: T::of(loading),
        largest: T::of(loading / ratio),
        limit_per_radius: T::ZERO,
        stretch: T::of(if ratio < 1.0 { 1.0 / (1.0 - ratio) } else { 1.0 }),
    })
}

/// What a contact does now.
struct Now<T> {
    force: T,
    /// Memory for the next step.
    largest_overlap: T,
    /// Stored energy \[J\].
    elastic: T,
    /// Plastic loss per unit of overlap while the memory grows \[N\].
    plastic_force: T,
}

impl<T: Real, const MODEL: u8> Hysteretic<T, MODEL> {
    /// `memory` is δ_max up to the step before.
    #[inline(always)]
    fn at(&self, overlap: T, memory: T, mass: T, radius: T) -> Now<T> {
        let (loading, largest) = if MODEL == PROPORTIONAL {
            (self.loading * mass, self.largest * mass)
        } else {
            (self.loading, self.largest)
        };
        let reached = memory.max(overlap);
        if MODEL == GROWING {
            let limit = self.limit_per_radius * radius;
            let within = reached < limit;
            let peak = reached.min(limit);
            let share = if limit > T::ZERO { peak / limit } else { T::ONE };
            let unloading = loading + (largest - loading) * share;
            let line = unloading * (overlap - peak) + loading * peak;
            let force = line.max(T::ZERO);
            // The δ_max whose plastic overlap is δ.
            let forgotten = T::of(0.5)
                * (overlap
                    + (overlap * (overlap + T::of(4.0) * (loading * limit / (largest - loading)))).sqrt());
            let compression = force / unloading;
            let softer = loading / unloading;
            let plastic_force =
                force * (T::ONE - softer + T::of(0.5) * softer * (unloading - loading) / unloading);
            return Now {
                force,
                largest_overlap: if line < T::ZERO { forgotten } else { reached },
                elastic: T::of(0.5) * force * compression,
                plastic_force: plastic_force.keep_if(within && overlap >= memory),
            };
        }
        let line = largest * (overlap - reached) + loading * reached;
        let force = line.max(T::ZERO);
        let compression = force / largest;
        Now {
            force,
            largest_overlap: if line < T::ZERO { overlap * self.stretch } else { reached },
            elastic: T::of(0.5) * force * compression,
            plastic_force: (force - loading * compression).keep_if(overlap >= memory),
        }
    }
}

impl<T: Real, const MODEL: u8> Stage<T> for Hysteretic<T, MODEL> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let velocity = &chunk.normal_velocity[..n];
        let [memory] = &mut *chunk.history else {
            panic!("WaltonBraun has one history column, not {}", chunk.history.len());
        };
        let memory = &mut memory[..n];
        let mass = if MODEL == PROPORTIONAL { &chunk.reduced_mass[..n] } else { overlap };
        let radius = if MODEL == GROWING { &chunk.reduced_radius[..n] } else { overlap };
        let force = &mut chunk.normal_force[..n];
        if let Some(energy) = &mut chunk.energy {
            let elastic = &mut energy.elastic[..n];
            let viscous = &mut energy.viscous[..n];
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                let touches = overlap[k] > T::ZERO;
                let now = self.at(overlap[k], memory[k], mass[k], radius[k]);
                elastic[k] = now.elastic.keep_if(touches);
                viscous[k] = (now.plastic_force * velocity[k].max(T::ZERO)).keep_if(touches);
                friction[k] = T::ZERO;
            }
        }
        let moves = chunk.time_step > T::ZERO;
        for k in 0..n {
            let touches = overlap[k] > T::ZERO;
            let now = self.at(overlap[k], memory[k], mass[k], radius[k]);
            force[k] = now.force.keep_if(touches);
            memory[k] = if moves { now.largest_overlap.keep_if(touches) } else { memory[k] };
        }
        for (k, stiffness) in chunk.normal_stiffness.iter_mut().enumerate() {
            *stiffness = if MODEL == PROPORTIONAL { self.loading * mass[k] } else { self.loading };
        }
        chunk.normal_damping.fill(T::ZERO);
    }
}
