//! A view as the columns that particle files take.

use granule_drivers::View;
use granule_formats::{Cell, Frame, ScalarColumn};

/// All bodies of a view in the order of their identities, each column by itself.
#[derive(Clone, Debug)]
pub struct Snapshot {
    step: u64,
    time: f64,
    cell: Cell,
    id: Vec<u32>,
    material: Vec<u16>,
    radius: Vec<f64>,
    mass: Vec<f64>,
    position: Vec<[f64; 3]>,
    image: Vec<[i32; 3]>,
    velocity: Vec<[f64; 3]>,
    spin: Option<Vec<[f64; 3]>>,
    force: Vec<[f64; 3]>,
    torque: Option<Vec<[f64; 3]>>,
}

impl Snapshot {
    /// The columns of a view. Positions are those inside the cell; spins and torques exist only if the plan rotates.
    pub fn of(view: &View<'_>) -> Self {
        let (bodies, plan) = (view.bodies(), view.plan());
        let places = || view.order().iter().map(|&place| place as usize);
        let (position, image): (Vec<_>, Vec<_>) = places()
            .map(|place| {
                let (wrapped, crossed) = plan.cell.wrap(bodies.position[place].vector());
                let before = bodies.image[place];
                (wrapped, std::array::from_fn(|axis| before[axis].saturating_add(crossed[axis])))
            })
            .unzip();
        let radius: Vec<f64> = places().map(|place| bodies.position[place][3]).collect();
        Self {
            step: view.step(),
            time: view.time(),
            cell: bounds(&plan.cell, &position, &radius),
            id: places().map(|place| bodies.id[place]).collect(),
            material: places().map(|place| bodies.material[place]).collect(),
            mass: places().map(|place| bodies.mass[place]).collect(),
            velocity: places().map(|place| bodies.velocity_of(place)).collect(),
            spin: plan.rotation.then(|| places().map(|place| bodies.spin_of(place)).collect()),
            force: places().map(|place| bodies.force_of(place)).collect(),
            torque: plan.rotation.then(|| places().map(|place| bodies.torque_of(place)).collect()),
            radius,
            position,
            image,
        }
    }

    /// How often each body has crossed each periodic boundary, by direction.
    pub fn images(&self) -> [Vec<f64>; 3] {
        std::array::from_fn(|axis| self.image.iter().map(|image| f64::from(image[axis])).collect())
    }

    /// How often a body has crossed each periodic boundary.
    pub fn image(&self, rank: usize) -> [i32; 3] {
        self.image[rank]
    }

    /// The bodies as a file format takes them, with further columns.
    pub fn frame<'a>(&'a self, extra: &'a [ScalarColumn<'a>]) -> Frame<'a> {
        Frame {
            step: self.step,
            time: self.time,
            cell: self.cell,
            id: &self.id,
            material: &self.material,
            radius: &self.radius,
            mass: &self.mass,
            position: &self.position,
            velocity: &self.velocity,
            angular_velocity: self.spin.as_deref(),
            force: Some(&self.force),
            torque: self.torque.as_deref(),
            extra,
        }
    }
}

/// The box of a file: the period where the cell is periodic; elsewhere what holds all bodies and the bounds of the cell
/// as far as they are finite.
fn bounds(cell: &granule_geometry::Cell, position: &[[f64; 3]], radius: &[f64]) -> Cell {
    let (mut lo, mut hi, periodic) = (cell.lo(), cell.hi(), cell.periodic());
    for axis in (0..3).filter(|axis| !periodic[*axis]) {
        let low = if lo[axis].is_finite() { lo[axis] } else { f64::INFINITY };
        let high = if hi[axis].is_finite() { hi[axis] } else { f64::NEG_INFINITY };
        let (low, high) = position.iter().zip(radius).fold((low, high), |(low, high), (x, radius)| {
            (low.min(x[axis] - radius), high.max(x[axis] + radius))
        });
        // Without bodies and bounds any box will do; readers want one that is not empty.
        (lo[axis], hi[axis]) = if low < high { (low, high) } else { (-0.5, 0.5) };
    }
    Cell { lo, hi, periodic }
}
