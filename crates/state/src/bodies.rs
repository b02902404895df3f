//! Bodies as rows in memory order.

use serde::{Deserialize, Serialize};

use crate::Row;

/// Which rows exist. A run holds only what its plan needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layout {
    /// Plane motion: velocity rows hold (v_x, v_y, ω_z, 1/m), force rows (f_x, f_y, τ_z, -); no spin or torque rows.
    pub planar: bool,
    /// Spins and torques exist.
    pub rotation: bool,
    /// The scheme remembers the accelerations of the last step.
    pub previous_acceleration: bool,
    /// The scheme remembers the accelerations with which it predicted velocities.
    pub predicted_acceleration: bool,
    /// Bodies roll and slide on a surface.
    pub surface: bool,
}

impl Layout {
    /// Spin and torque rows exist (in three dimensions only; in the plane the spin sits in the velocity row).
    pub const fn spin_rows(&self) -> bool {
        self.rotation && !self.planar
    }

    /// Bytes of state per body.
    pub const fn bytes_per_body(&self) -> usize {
        let rows = 3 + 2 * self.spin_rows() as usize;
        let remembered = self.previous_acceleration as usize + self.predicted_acceleration as usize;
        let previous = (1 + self.spin_rows() as usize) * remembered;
        let planar_inertia = 8 * (self.planar && self.rotation) as usize;
        // mass, identity, material and the three image counts
        let surface = size_of::<SurfaceRow>() * self.surface as usize;
        32 * (rows + previous) + surface + planar_inertia + 8 + 4 + 2 + 12
    }
}

/// One body, as it enters the state.
#[derive(Clone, Copy, Debug)]
pub struct BodyInput {
    /// Stable identity.
    pub id: u32,
    /// Material index.
    pub material: u16,
    /// Radius R \[m\].
    pub radius: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia factor q = I/(m R²).
    pub inertia_factor: f64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// Never moves: inverse mass and inverse inertia are zero.
    pub frozen: bool,
}

/// What a body does on a surface, at the time of its position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceRow {
    /// Mean force of the surface over the last step \[N\].
    pub force: [f64; 3],
    /// Mean torque of the surface over the last step \[N m\].
    pub torque: [f64; 3],
    /// Slip of the contact point \[m/s\].
    pub slip: [f64; 2],
    /// Velocity of the centre relative to the surface \[m/s\].
    pub rolling: [f64; 2],
    /// Velocity of the surface below the body \[m/s\].
    pub plate: [f64; 2],
    /// Spin about the normal \[rad/s\].
    pub drilling: f64,
    /// What it does, as a number whose meaning is that of the engine.
    pub footing: u64,
}

/// All bodies. The order is one of memory locality and changes during a run; `id` is the stable identity.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Bodies {
    layout: Layout,
    /// Centre x, y, z and radius R \[m\].
    pub position: Vec<Row>,
    /// Velocity \[m/s\] and inverse mass \[1/kg\]; in the plane the third number is the spin \[rad/s\].
    pub velocity: Vec<Row>,
    /// Spin \[rad/s\] and inverse moment of inertia \[1/(kg m²)\]; empty without spin rows.
    pub spin: Vec<Row>,
    /// Force \[N\]; in the plane the third number is the torque \[N m\].
    pub force: Vec<Row>,
    /// Torque \[N m\]; empty without spin rows.
    pub torque: Vec<Row>,
    /// Accelerations of the last step \[m/s²\]; empty unless the scheme wants them.
    pub previous_acceleration: Vec<Row>,
    /// Angular accelerations of the last step \[rad/s²\]; empty unless the scheme wants them and spin rows exist.
    pub previous_angular_acceleration: Vec<Row>,
    /// Accelerations with which velocities were predicted \[m/s²\]; empty unless the scheme wants them.
    pub predicted_acceleration: Vec<Row>,
    /// The same of spins \[rad/s²\]; empty unless the scheme wants them and spin rows exist.
    pub predicted_angular_acceleration: Vec<Row>,
    /// Inverse moment of inertia in the plane \[1/(kg m²)\]; empty otherwise.
    pub planar_inverse_inertia: Vec<f64>,
    /// Mass \[kg\]; finite for frozen bodies too.
    pub mass: Vec<f64>,
    /// Stable identity.
    pub id: Vec<u32>,
    /// Material index.
    pub material: Vec<u16>,
    /// How often the body has crossed each periodic boundary.
    pub image: Vec<[i32; 3]>,
    /// What each body does on the surface; empty without one.
    pub surface: Vec<SurfaceRow>,
}

impl Bodies {
    /// Rows for the given bodies, in their order.
    pub fn new(layout: Layout, bodies: impl Iterator<Item = BodyInput>) -> Self {
        let mut rows = Self {
            layout,
            position: Vec::new(),
            velocity: Vec::new(),
            spin: Vec::new(),
            force: Vec::new(),
            torque: Vec::new(),
            previous_acceleration: Vec::new(),
            previous_angular_acceleration: Vec::new(),
            predicted_acceleration: Vec::new(),
            predicted_angular_acceleration: Vec::new(),
            planar_inverse_inertia: Vec::new(),
            mass: Vec::new(),
            id: Vec::new(),
            material: Vec::new(),
            image: Vec::new(),
            surface: Vec::new(),
        };
        for body in bodies {
            rows.push(&body);
        }
        rows
    }

    fn push(&mut self, body: &BodyInput) {
        let inverse = |quantity: f64| if body.frozen { 0.0 } else { 1.0 / quantity };
        let inertia = body.inertia_factor * body.mass * body.radius * body.radius;
        self.position.push(Row::new(body.position, body.radius));
        let mut velocity = Row::new(body.velocity, inverse(body.mass));
        if self.layout.planar {
            velocity[2] = if self.layout.rotation { body.spin[2] } else { 0.0 };
            if self.layout.rotation {
                self.planar_inverse_inertia.push(inverse(inertia));
            }
        }
        self.velocity.push(velocity);
        self.force.push(Row::ZERO);
        if self.layout.spin_rows() {
            self.spin.push(Row::new(body.spin, inverse(inertia)));
            self.torque.push(Row::ZERO);
        }
        if self.layout.previous_acceleration {
            self.previous_acceleration.push(Row::ZERO);
            if self.layout.spin_rows() {
                self.previous_angular_acceleration.push(Row::ZERO);
            }
        }
        if self.layout.predicted_acceleration {
            self.predicted_acceleration.push(Row::ZERO);
            if self.layout.spin_rows() {
                self.predicted_angular_acceleration.push(Row::ZERO);
            }
        }
        self.mass.push(body.mass);
        self.id.push(body.id);
        self.material.push(body.material);
        self.image.push([0; 3]);
        if self.layout.surface {
            self.surface.push(SurfaceRow::default());
        }
    }

    /// Which rows exist.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// True without bodies.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// True if the body never moves.
    #[inline(always)]
    pub fn is_frozen(&self, index: usize) -> bool {
        self.velocity[index][3] == 0.0
    }

    /// Velocity \[m/s\].
    pub fn velocity_of(&self, index: usize) -> [f64; 3] {
        let row = self.velocity[index];
        if self.layout.planar { [row[0], row[1], 0.0] } else { row.vector() }
    }

    /// Spin \[rad/s\]; zero if spins do not exist.
    pub fn spin_of(&self, index: usize) -> [f64; 3] {
        if self.layout.spin_rows() {
            self.spin[index].vector()
        } else if self.layout.rotation {
            [0.0, 0.0, self.velocity[index][2]]
        } else {
            [0.0; 3]
        }
    }

    /// Force \[N\].
    pub fn force_of(&self, index: usize) -> [f64; 3] {
        let row = self.force[index];
        if self.layout.planar { [row[0], row[1], 0.0] } else { row.vector() }
    }

    /// Torque \[N m\]; zero if torques do not exist.
    pub fn torque_of(&self, index: usize) -> [f64; 3] {
        if self.layout.spin_rows() {
            self.torque[index].vector()
        } else if self.layout.rotation {
            [0.0, 0.0, self.force[index][2]]
        } else {
            [0.0; 3]
        }
    }

    /// Inverse moment of inertia \[1/(kg m²)\]; zero if spins do not exist or the body is frozen.
    pub fn inverse_inertia_of(&self, index: usize) -> f64 {
        if self.layout.spin_rows() {
            self.spin[index][3]
        } else {
            self.planar_inverse_inertia.get(index).copied().unwrap_or(0.0)
        }
    }

    /// Gives a body an impulse \[N s\] and an angular impulse \[N m s\].
    pub fn give(&mut self, index: usize, linear: [f64; 3], angular: [f64; 3]) {
        let row = &mut self.velocity[index];
        let inverse_mass = row[3];
        for axis in 0..if self.layout.planar { 2 } else { 3 } {
            row[axis] += linear[axis] * inverse_mass;
        }
        if self.layout.spin_rows() {
            let row = &mut self.spin[index];
            for axis in 0..3 {
                row[axis] += angular[axis] * row[3];
            }
        } else if let Some(inverse_inertia) = self.planar_inverse_inertia.get(index) {
            row[2] += angular[2] * inverse_inertia;
        }
    }

    /// Takes the accelerations of the present forces for those of the step before, where such are remembered: the state at
    /// the start has no step before it.
    pub fn remember_accelerations(&mut self) {
        let planar = self.layout.planar;
        for (index, row) in self.previous_acceleration.iter_mut().enumerate() {
            let (force, inverse_mass) = (self.force[index], self.velocity[index][3]);
            for axis in 0..3 {
                row[axis] = force[axis] * inverse_mass;
            }
            if planar {
                row[2] = force[2] * self.planar_inverse_inertia.get(index).copied().unwrap_or(0.0);
            }
        }
        for (index, row) in self.previous_angular_acceleration.iter_mut().enumerate() {
            for axis in 0..3 {
                row[axis] = self.torque[index][axis] * self.spin[index][3];
            }
        }
    }

    /// Brings the bodies into a new order: place `k` gets the body that was at `order[k]`. Forces and torques are lost:
    /// bodies are sorted between two evaluations, and the rows of the forces serve as the room in which to sort.
    pub fn permute(&mut self, order: &[u32]) {
        let rows = [
            &mut self.position,
            &mut self.velocity,
            &mut self.spin,
            &mut self.previous_acceleration,
            &mut self.previous_angular_acceleration,
            &mut self.predicted_acceleration,
            &mut self.predicted_angular_acceleration,
        ];
        for column in rows {
            if !column.is_empty() {
                for (to, from) in self.force.iter_mut().zip(order) {
                    *to = column[*from as usize];
                }
                std::mem::swap(column, &mut self.force);
            }
        }
        self.force.fill(Row::ZERO);
        self.torque.fill(Row::ZERO);
        gather(&mut self.planar_inverse_inertia, order);
        gather(&mut self.mass, order);
        gather(&mut self.id, order);
        gather(&mut self.material, order);
        gather(&mut self.image, order);
        gather(&mut self.surface, order);
    }

    /// True if the rows are those of a layout and all columns have one entry a body.
    pub fn is_whole(&self, layout: Layout) -> bool {
        // All columns are named, so that a new one cannot be forgotten.
        let Self {
            layout: own,
            position,
            velocity,
            spin,
            force,
            torque,
            previous_acceleration,
            previous_angular_acceleration,
            predicted_acceleration,
            predicted_angular_acceleration,
            planar_inverse_inertia,
            mass,
            id,
            material,
            image,
            surface,
        } = self;
        let count = position.len();
        let if_any = |exists: bool| if exists { count } else { 0 };
        let remembers = layout.previous_acceleration;
        let predicts = layout.predicted_acceleration;
        *own == layout
            && [velocity.len(), force.len(), mass.len(), id.len(), material.len(), image.len()]
                .iter()
                .all(|length| *length == count)
            && [spin.len(), torque.len()].iter().all(|length| *length == if_any(layout.spin_rows()))
            && previous_acceleration.len() == if_any(remembers)
            && previous_angular_acceleration.len() == if_any(remembers && layout.spin_rows())
            && predicted_acceleration.len() == if_any(predicts)
            && predicted_angular_acceleration.len() == if_any(predicts && layout.spin_rows())
            && planar_inverse_inertia.len() == if_any(layout.planar && layout.rotation)
            && surface.len() == if_any(layout.surface)
    }

    /// True if every number of every row is finite.
    pub fn is_finite(&self) -> bool {
        let rows = [
            &self.position,
            &self.velocity,
            &self.spin,
            &self.force,
            &self.torque,
            &self.previous_acceleration,
            &self.previous_angular_acceleration,
            &self.predicted_acceleration,
            &self.predicted_angular_acceleration,
        ];
        rows.iter().all(|rows| rows.iter().all(|row| row.0.iter().all(|number| number.is_finite())))
            && self.surface.iter().all(|row| {
                let SurfaceRow { force, torque, slip, rolling, plate, drilling, footing: _ } = row;
                let vectors = [force, torque].into_iter().flatten();
                let flat = [slip, rolling, plate].into_iter().flatten();
                vectors.chain(flat).chain([drilling]).all(|number| number.is_finite())
            })
    }

    /// True if a body of these and one of others agree in what never changes: identity, material, radius, mass and inertia.
    pub fn same_body(&self, place: usize, other: &Self, there: usize) -> bool {
        let constants = |bodies: &Self, k: usize| {
            let numbers = [
                bodies.position[k][3],
                bodies.velocity[k][3],
                bodies.spin.get(k).map_or(0.0, |row| row[3]),
                bodies.planar_inverse_inertia.get(k).copied().unwrap_or(0.0),
                bodies.mass[k],
            ];
            (bodies.id[k], bodies.material[k], numbers.map(f64::to_bits))
        };
        constants(self, place) == constants(other, there)
    }

    /// Places of the bodies in the order of their ids.
    pub fn order_by_id(&self) -> Vec<u32> {
        let largest = self.id.iter().copied().max().unwrap_or(0) as usize;
        if largest <= 4 * self.len() {
            // Ids are nearly consecutive: each has its slot.
            const NONE: u32 = u32::MAX;
            let mut slots = vec![NONE; largest + 1];
            for (place, id) in self.id.iter().enumerate() {
                slots[*id as usize] = place as u32;
            }
            slots.retain(|place| *place != NONE);
            return slots;
        }
        let mut order: Vec<u32> = (0..self.len() as u32).collect();
        order.sort_unstable_by_key(|&place| self.id[place as usize]);
        order
    }
}

fn gather<T: Copy>(column: &mut Vec<T>, order: &[u32]) {
    if !column.is_empty() {
        *column = order.iter().map(|&from| column[from as usize]).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(id: u32) -> BodyInput {
        BodyInput {
            id,
            material: 0,
            radius: 0.5,
            mass: 2.0,
            inertia_factor: 0.4,
            position: [f64::from(id), 0.0, 0.0],
            velocity: [1.0, 2.0, 3.0],
            spin: [4.0, 5.0, 6.0],
            frozen: id == 2,
        }
    }

    #[test]
    fn only_the_rows_of_the_layout_exist() {
        let smooth = Layout {
            planar: false,
            rotation: false,
            previous_acceleration: false,
            predicted_acceleration: false,
            surface: false,
        };
        let bodies = Bodies::new(smooth, (1..=3).map(input));
        assert!(
            bodies.spin.is_empty() && bodies.torque.is_empty() && bodies.previous_acceleration.is_empty()
        );
        assert_eq!(bodies.spin_of(0), [0.0; 3]);
        assert!(bodies.is_frozen(1) && !bodies.is_frozen(0));
        let planar = Layout {
            planar: true,
            rotation: true,
            previous_acceleration: false,
            predicted_acceleration: false,
            surface: false,
        };
        let bodies = Bodies::new(planar, (1..=3).map(input));
        assert!(bodies.spin.is_empty());
        assert_eq!(bodies.spin_of(0), [0.0, 0.0, 6.0]);
        assert_eq!(bodies.velocity_of(0), [1.0, 2.0, 0.0]);
        assert_eq!(bodies.inverse_inertia_of(0), 1.0 / (0.4 * 2.0 * 0.25));
    }

    #[test]
    fn permuting_keeps_bodies_whole() {
        let layout = Layout {
            planar: false,
            rotation: true,
            previous_acceleration: true,
            predicted_acceleration: true,
            surface: true,
        };
        let mut bodies = Bodies::new(layout, (1..=3).map(input));
        bodies.permute(&[2, 0, 1]);
        assert_eq!(bodies.id, [3, 1, 2]);
        assert_eq!(bodies.position[0][0], 3.0);
        assert!(bodies.is_frozen(2));
        assert_eq!(bodies.order_by_id(), [1, 2, 0]);
        bodies.id = vec![2, 4_000_000_000, 1];
        assert_eq!(bodies.order_by_id(), [2, 0, 1]);
    }
}
