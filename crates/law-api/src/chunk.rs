//! Columns of contacts, and the stage that runs over them.

use crate::Real;

/// Largest number of contacts in one chunk.
pub const CHUNK: usize = 256;

/// One chunk of contacts between two materials. Every non-empty slice has the same length, at most [`CHUNK`].
///
/// Signs: the normal n points from body j to body i; the overlap δ is positive in contact; the normal velocity
/// v_n = dδ/dt is positive on approach; the tangential velocity is that of the contact point, body i minus body j, spins
/// included; a positive normal force repels; the tangential force and the torque are those on body i.
pub struct ContactChunk<'a, T> {
    /// Time over which history is advanced \[s\]. Zero when forces are evaluated without a step (set-up): history must
    /// then stay as it is.
    pub time_step: T,
    /// Overlap δ \[m\]; positive, except for laws with a reach, which also see contacts down to minus their reach.
    pub overlap: &'a [T],
    /// Unit normal n, from j to i.
    pub normal: [&'a [T]; 3],
    /// Normal velocity v_n = dδ/dt \[m/s\], positive on approach.
    pub normal_velocity: &'a [T],
    /// Tangential velocity v_t \[m/s\] of i against j at the contact point, spins included. Empty unless a stage reads it.
    pub tangential_velocity: [&'a [T]; 3],
    /// Relative spin ω_i - ω_j \[rad/s\]. Empty unless a stage reads it.
    pub relative_spin: [&'a [T]; 3],
    /// Reduced mass m12 = m_i m_j / (m_i + m_j) \[kg\]; the mass of i at a wall.
    pub reduced_mass: &'a [T],
    /// Reduced radius R* = R_i R_j / (R_i + R_j) \[m\]; the radius of i at a plane wall.
    pub reduced_radius: &'a [T],
    /// Normal force f_n \[N\], positive repels. Written by the normal stage.
    pub normal_force: &'a mut [T],
    /// Secant stiffness k_n = elastic force / δ \[N/m\] of the normal stage. Empty unless a later stage reads it.
    pub normal_stiffness: &'a mut [T],
    /// Damping γ_n = viscous force / v_n \[kg/s\] of the normal stage. Empty unless a later stage reads it.
    pub normal_damping: &'a mut [T],
    /// Tangential force on i \[N\]. Empty in compositions without tangential stage.
    pub tangential_force: [&'a mut [T]; 3],
    /// Rolling and torsion torque on i \[N m\]; body j gets its opposite. Empty unless a stage writes it.
    pub torque: [&'a mut [T]; 3],
    /// History columns of this stage, in the order of its declaration (a vector column counts three).
    pub history: &'a mut [&'a mut [T]],
    /// Where this stage accounts for energy; present only when the scene asks for the energy ledger.
    pub energy: Option<EnergyColumns<'a, T>>,
}

/// Energy account of one stage over one chunk. A stage *overwrites* these columns.
pub struct EnergyColumns<'a, T> {
    /// Elastic energy now stored \[J\].
    pub elastic: &'a mut [T],
    /// Power now dissipated by viscous damping (or plastic deformation) \[W\].
    pub viscous: &'a mut [T],
    /// Power now dissipated by sliding \[W\].
    pub friction: &'a mut [T],
    /// Energy dissipated by sliding within the step that has just ended \[J\], for a stage that knows it: a spring that is cut
    /// to its limit loses what it was wound up by. It counts beside `friction`, whose powers are integrated by the
    /// trapezoidal rule. Zero when the stage begins; a stage need not write it.
    pub slipped: &'a mut [T],
}

/// A compiled law: constants folded in, ready to run over chunks.
///
/// The loop must be element-wise: entry `k` of the output depends on entry `k` of the inputs alone, whatever the length
/// of the chunk ([`testing::conformance`](crate::testing::conformance) checks it bit by bit).
pub trait Stage<T: Real>: Send + Sync {
    /// Computes the columns that the law declares to write.
    fn run(&self, chunk: &mut ContactChunk<'_, T>);
}

impl<T> ContactChunk<'_, T> {
    /// Number of contacts.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.overlap.len()
    }

    /// True for a chunk without contacts.
    pub fn is_empty(&self) -> bool {
        self.overlap.is_empty()
    }
}
