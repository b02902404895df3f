//! Owned columns of contacts, to run a stage without an engine.

use crate::{CHUNK, Columns, ContactChunk, EnergyColumns, Real, Stage};

/// Columns of up to [`CHUNK`] contacts.
#[derive(Clone, Debug)]
pub struct Contacts<T> {
    /// Overlap \[m\].
    pub overlap: Vec<T>,
    /// Unit normal.
    pub normal: [Vec<T>; 3],
    /// Normal velocity, positive on approach \[m/s\].
    pub normal_velocity: Vec<T>,
    /// Tangential velocity \[m/s\].
    pub tangential_velocity: [Vec<T>; 3],
    /// Relative spin \[rad/s\].
    pub relative_spin: [Vec<T>; 3],
    /// Reduced mass \[kg\].
    pub reduced_mass: Vec<T>,
    /// Reduced radius \[m\].
    pub reduced_radius: Vec<T>,
    /// Normal force \[N\].
    pub normal_force: Vec<T>,
    /// Secant stiffness of the normal stage \[N/m\].
    pub normal_stiffness: Vec<T>,
    /// Damping of the normal stage \[kg/s\].
    pub normal_damping: Vec<T>,
    /// Tangential force on i \[N\].
    pub tangential_force: [Vec<T>; 3],
    /// Torque on i \[N m\].
    pub torque: [Vec<T>; 3],
    /// Scalar history columns.
    pub history: Vec<Vec<T>>,
    /// Elastic energy \[J\].
    pub elastic: Vec<T>,
    /// Viscous power \[W\].
    pub viscous: Vec<T>,
    /// Frictional power \[W\].
    pub friction: Vec<T>,
    /// Energy lost by sliding within the step \[J\].
    pub slipped: Vec<T>,
}

impl<T: Real> Contacts<T> {
    /// `count` contacts without overlap and motion, with the normal along x and `history_width` history columns.
    ///
    /// # Panics
    /// If `count` exceeds [`CHUNK`].
    pub fn new(count: usize, history_width: usize) -> Self {
        assert!(count <= CHUNK, "a chunk has at most {CHUNK} contacts, not {count}");
        let zeros = || vec![T::ZERO; count];
        let vector = || [zeros(), zeros(), zeros()];
        Self {
            overlap: zeros(),
            normal: [vec![T::ONE; count], zeros(), zeros()],
            normal_velocity: zeros(),
            tangential_velocity: vector(),
            relative_spin: vector(),
            reduced_mass: vec![T::ONE; count],
            reduced_radius: vec![T::ONE; count],
            normal_force: zeros(),
            normal_stiffness: zeros(),
            normal_damping: zeros(),
            tangential_force: vector(),
            torque: vector(),
            history: (0..history_width).map(|_| zeros()).collect(),
            elastic: zeros(),
            viscous: zeros(),
            friction: zeros(),
            slipped: zeros(),
        }
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.overlap.len()
    }

    /// True without contacts.
    pub fn is_empty(&self) -> bool {
        self.overlap.is_empty()
    }

    /// Runs a stage with every column and the energy account present.
    pub fn run(&mut self, stage: &dyn Stage<T>, time_step: f64) {
        self.run_with(stage, time_step, true, true);
    }

    /// Runs a stage, with or without the optional outputs (stiffness and damping of the normal stage) and the energy
    /// account.
    pub fn run_with(&mut self, stage: &dyn Stage<T>, time_step: f64, optional: bool, energy: bool) {
        fn slices<T>(columns: &[Vec<T>; 3]) -> [&[T]; 3] {
            columns.each_ref().map(Vec::as_slice)
        }
        fn slices_mut<T>(columns: &mut [Vec<T>; 3]) -> [&mut [T]; 3] {
            columns.each_mut().map(Vec::as_mut_slice)
        }
        let mut history: Vec<&mut [T]> = self.history.iter_mut().map(Vec::as_mut_slice).collect();
        self.slipped.fill(T::ZERO);
        let keep = if optional { self.overlap.len() } else { 0 };
        let mut chunk = ContactChunk {
            time_step: T::of(time_step),
            overlap: &self.overlap,
            normal: slices(&self.normal),
            normal_velocity: &self.normal_velocity,
            tangential_velocity: slices(&self.tangential_velocity),
            relative_spin: slices(&self.relative_spin),
            reduced_mass: &self.reduced_mass,
            reduced_radius: &self.reduced_radius,
            normal_force: &mut self.normal_force,
            normal_stiffness: &mut self.normal_stiffness[..keep],
            normal_damping: &mut self.normal_damping[..keep],
            tangential_force: slices_mut(&mut self.tangential_force),
            torque: slices_mut(&mut self.torque),
            history: &mut history,
            energy: energy.then_some(EnergyColumns {
                elastic: &mut self.elastic,
                viscous: &mut self.viscous,
                friction: &mut self.friction,
                slipped: &mut self.slipped,
            }),
        };
        stage.run(&mut chunk);
    }

    /// A copy of the contacts at the given places, in that order.
    #[must_use]
    pub fn select(&self, places: &[usize]) -> Self {
        let pick = |column: &Vec<T>| places.iter().map(|&place| column[place]).collect::<Vec<T>>();
        let pick3 = |columns: &[Vec<T>; 3]| columns.each_ref().map(pick);
        Self {
            overlap: pick(&self.overlap),
            normal: pick3(&self.normal),
            normal_velocity: pick(&self.normal_velocity),
            tangential_velocity: pick3(&self.tangential_velocity),
            relative_spin: pick3(&self.relative_spin),
            reduced_mass: pick(&self.reduced_mass),
            reduced_radius: pick(&self.reduced_radius),
            normal_force: pick(&self.normal_force),
            normal_stiffness: pick(&self.normal_stiffness),
            normal_damping: pick(&self.normal_damping),
            tangential_force: pick3(&self.tangential_force),
            torque: pick3(&self.torque),
            history: self.history.iter().map(pick).collect(),
            elastic: pick(&self.elastic),
            viscous: pick(&self.viscous),
            friction: pick(&self.friction),
            slipped: pick(&self.slipped),
        }
    }

    /// Every column that a stage may write, with its name and the set that it belongs to (`None` for history and energy).
    pub(crate) fn outputs(&self) -> Vec<(String, Option<Columns>, &[T])> {
        let mut outputs: Vec<(String, Option<Columns>, &[T])> = vec![
            ("normal force".into(), Some(Columns::NORMAL_FORCE), &self.normal_force),
            ("normal stiffness".into(), Some(Columns::NORMAL_STIFFNESS), &self.normal_stiffness),
            ("normal damping".into(), Some(Columns::NORMAL_DAMPING), &self.normal_damping),
        ];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            outputs.push((
                format!("tangential force {name}"),
                Some(Columns::TANGENTIAL_FORCE),
                &self.tangential_force[axis],
            ));
            outputs.push((format!("torque {name}"), Some(Columns::TORQUE), &self.torque[axis]));
        }
        for (index, column) in self.history.iter().enumerate() {
            outputs.push((format!("history column {index}"), None, column));
        }
        outputs.push(("elastic energy".into(), None, &self.elastic));
        outputs.push(("viscous power".into(), None, &self.viscous));
        outputs.push(("frictional power".into(), None, &self.friction));
        outputs.push(("energy lost by sliding".into(), None, &self.slipped));
        outputs
    }

    /// One contact in words.
    pub(crate) fn describe(&self, k: usize) -> String {
        let vector = |v: &[Vec<T>; 3]| format!("({:?}, {:?}, {:?})", v[0][k], v[1][k], v[2][k]);
        let history: Vec<T> = self.history.iter().map(|column| column[k]).collect();
        format!(
            "overlap {:?}, normal {}, normal velocity {:?}, tangential velocity {}, reduced mass {:?}, reduced radius {:?}, \
             normal force {:?}, history {history:?}",
            self.overlap[k],
            vector(&self.normal),
            self.normal_velocity[k],
            vector(&self.tangential_velocity),
            self.reduced_mass[k],
            self.reduced_radius[k],
            self.normal_force[k],
        )
    }
}
