//! Prescribed motion of walls.

use nalgebra::{Rotation3, Unit, Vector3};

use crate::GeometryError;
use crate::vector::{finite, finite_vector, unit};

/// How a wall moves; it does not feel the bodies. Times are simulated times in s.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Motion(Kind);

#[derive(Clone, Debug, PartialEq, Default)]
enum Kind {
    #[default]
    Fixed,
    ConstantVelocity(Vector3<f64>),
    Sinusoidal {
        amplitude: Vector3<f64>,
        angular_frequency: f64,
        phase: f64,
    },
    Table(Vec<(f64, Vector3<f64>)>),
    Rotation {
        point: Vector3<f64>,
        axis: Vector3<f64>,
        angular_velocity: f64,
    },
}

impl Motion {
    /// No motion.
    pub const fn fixed() -> Self {
        Self(Kind::Fixed)
    }

    /// Displacement `velocity * t`; velocity in m/s.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`].
    pub fn constant_velocity(velocity: Vector3<f64>) -> Result<Self, GeometryError> {
        Ok(Self(Kind::ConstantVelocity(finite_vector(velocity, "wall velocity")?)))
    }

    /// Displacement `amplitude * sin(angular_frequency * t + phase)`; amplitude in m, angular frequency in rad/s,
    /// phase in rad. At t = 0 the wall stands at `amplitude * sin(phase)` from where it was described.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`].
    pub fn sinusoidal(
        amplitude: Vector3<f64>,
        angular_frequency: f64,
        phase: f64,
    ) -> Result<Self, GeometryError> {
        Ok(Self(Kind::Sinusoidal {
            amplitude: finite_vector(amplitude, "amplitude of the wall")?,
            angular_frequency: finite(angular_frequency, "angular frequency of the wall")?,
            phase: finite(phase, "phase of the wall")?,
        }))
    }

    /// Displacements (m) at times (s), straight lines between them, and rest before the first and after the last.
    ///
    /// The velocity jumps at the times of the table, where it is that of the line that begins; the acceleration is
    /// reported as 0 everywhere, without the pulse at the jumps.
    ///
    /// # Errors
    /// [`GeometryError::EmptyTable`], [`GeometryError::TableOrder`] unless the times increase strictly,
    /// [`GeometryError::NotFinite`] also when two rows are so close that the velocity between them overflows.
    pub fn table(rows: Vec<(f64, Vector3<f64>)>) -> Result<Self, GeometryError> {
        if rows.is_empty() {
            return Err(GeometryError::EmptyTable);
        }
        for (row, (time, displacement)) in rows.iter().enumerate() {
            finite(*time, "time of a table row")?;
            finite_vector(*displacement, "displacement of a table row")?;
            if row > 0 {
                if *time <= rows[row - 1].0 {
                    return Err(GeometryError::TableOrder { row });
                }
                finite_vector(slope(&rows[row - 1], &rows[row]), "wall velocity from the table")?;
            }
        }
        Ok(Self(Kind::Table(rows)))
    }

    /// Rotation about the line through `point` (m) along `axis` (of any length) with `angular_velocity` (rad/s),
    /// positive by the right-hand rule.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`], [`GeometryError::ZeroVector`].
    pub fn rotation(
        point: Vector3<f64>,
        axis: Vector3<f64>,
        angular_velocity: f64,
    ) -> Result<Self, GeometryError> {
        Ok(Self(Kind::Rotation {
            point: finite_vector(point, "point on the rotation axis")?,
            axis: unit(axis, "rotation axis")?,
            angular_velocity: finite(angular_velocity, "angular velocity of the wall")?,
        }))
    }

    /// The velocity (m/s) of a wall that keeps it for ever, zero for a fixed one; `None` for any other motion.
    pub fn steady_velocity(&self) -> Option<Vector3<f64>> {
        match &self.0 {
            Kind::ConstantVelocity(velocity) => Some(*velocity),
            _ => self.is_fixed().then(Vector3::zeros),
        }
    }

    /// Amplitude (m), angular frequency (rad/s) and phase (rad) of a sinusoidal motion; `None` for any other.
    pub fn oscillation(&self) -> Option<(Vector3<f64>, f64, f64)> {
        match &self.0 {
            Kind::Sinusoidal { amplitude, angular_frequency, phase } => {
                Some((*amplitude, *angular_frequency, *phase))
            }
            _ => None,
        }
    }

    /// True when nothing ever moves.
    pub fn is_fixed(&self) -> bool {
        match &self.0 {
            Kind::Fixed => true,
            Kind::ConstantVelocity(velocity) => *velocity == Vector3::zeros(),
            Kind::Sinusoidal { .. } | Kind::Table(_) => false,
            Kind::Rotation { angular_velocity, .. } => *angular_velocity == 0.0,
        }
    }

    /// True for a translation that is not along x and y alone.
    pub fn leaves_plane(&self) -> bool {
        match &self.0 {
            Kind::Fixed | Kind::Rotation { .. } => false,
            Kind::ConstantVelocity(velocity) => velocity.z != 0.0,
            Kind::Sinusoidal { amplitude, .. } => amplitude.z != 0.0,
            Kind::Table(rows) => rows.iter().any(|row| row.1.z != 0.0),
        }
    }

    /// Translation at time `t` from where the wall was described, m; zero for a rotation.
    pub fn displacement(&self, t: f64) -> Vector3<f64> {
        match &self.0 {
            Kind::Fixed | Kind::Rotation { .. } => Vector3::zeros(),
            Kind::ConstantVelocity(velocity) => velocity * t,
            Kind::Sinusoidal { amplitude, angular_frequency, phase } => {
                amplitude * (angular_frequency * t + phase).sin()
            }
            Kind::Table(rows) => match segment(rows, t) {
                Segment::Rest(row) => row.1,
                Segment::Line(a, b) => a.1 + (b.1 - a.1) * ((t - a.0) / (b.0 - a.0)),
            },
        }
    }

    /// Velocity of the translation at time `t`, m/s.
    pub fn velocity(&self, t: f64) -> Vector3<f64> {
        match &self.0 {
            Kind::Fixed | Kind::Rotation { .. } => Vector3::zeros(),
            Kind::ConstantVelocity(velocity) => *velocity,
            Kind::Sinusoidal { amplitude, angular_frequency, phase } => {
                amplitude * (angular_frequency * (angular_frequency * t + phase).cos())
            }
            Kind::Table(rows) => match segment(rows, t) {
                Segment::Rest(_) => Vector3::zeros(),
                Segment::Line(a, b) => slope(a, b),
            },
        }
    }

    /// True for a translation along straight lines between given times.
    pub fn is_table(&self) -> bool {
        matches!(self.0, Kind::Table(_))
    }

    /// The next time after `t` at which the velocity of a table jumps; `None` without one.
    pub fn next_jump(&self, t: f64) -> Option<f64> {
        match &self.0 {
            Kind::Table(rows) => rows.get(rows.partition_point(|row| row.0 <= t)).map(|row| row.0),
            _ => None,
        }
    }

    /// Acceleration of the translation at time `t`, m/s^2.
    pub fn acceleration(&self, t: f64) -> Vector3<f64> {
        match &self.0 {
            Kind::Fixed | Kind::Rotation { .. } | Kind::ConstantVelocity(_) | Kind::Table(_) => {
                Vector3::zeros()
            }
            Kind::Sinusoidal { amplitude, angular_frequency, phase } => {
                let angle = angular_frequency * t + phase;
                -amplitude * (angular_frequency * angular_frequency * angle.sin())
            }
        }
    }

    /// Point and unit axis of the rotation and the angle turned at time `t`; `None` for a translation.
    pub fn rotation_at(&self, t: f64) -> Option<(Vector3<f64>, Vector3<f64>, f64)> {
        match &self.0 {
            Kind::Rotation { point, axis, angular_velocity } => Some((*point, *axis, angular_velocity * t)),
            _ => None,
        }
    }

    /// The rotation matrix at time `t`; identity for a translation.
    pub fn orientation(&self, t: f64) -> Rotation3<f64> {
        match self.rotation_at(t) {
            Some((_, axis, angle)) => Rotation3::from_axis_angle(&Unit::new_unchecked(axis), angle),
            None => Rotation3::identity(),
        }
    }

    /// Angular velocity, rad/s; zero for a translation.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        match &self.0 {
            Kind::Rotation { axis, angular_velocity, .. } => axis * *angular_velocity,
            _ => Vector3::zeros(),
        }
    }

    /// Velocity of the wall's material at the place `position` (m) at time `t`, m/s.
    pub fn velocity_at(&self, position: Vector3<f64>, t: f64) -> Vector3<f64> {
        match &self.0 {
            Kind::Rotation { point, axis, angular_velocity } => {
                (axis * *angular_velocity).cross(&(position - point))
            }
            _ => self.velocity(t),
        }
    }

    /// Acceleration of the wall's material at the place `position` (m) at time `t`, m/s^2; centripetal for a
    /// rotation.
    pub fn acceleration_at(&self, position: Vector3<f64>, t: f64) -> Vector3<f64> {
        match &self.0 {
            Kind::Rotation { axis, angular_velocity, .. } => {
                (axis * *angular_velocity).cross(&self.velocity_at(position, t))
            }
            _ => self.acceleration(t),
        }
    }
}

type Row = (f64, Vector3<f64>);

fn slope(a: &Row, b: &Row) -> Vector3<f64> {
    (b.1 - a.1) / (b.0 - a.0)
}

enum Segment<'a> {
    Rest(&'a Row),
    Line(&'a Row, &'a Row),
}

/// The part of the table that holds at `t`; `rows` is not empty.
fn segment(rows: &[Row], t: f64) -> Segment<'_> {
    let after = rows.partition_point(|row| row.0 <= t);
    match (after.checked_sub(1).and_then(|before| rows.get(before)), rows.get(after)) {
        (Some(a), Some(b)) => Segment::Line(a, b),
        (Some(a), None) => Segment::Rest(a),
        (None, _) => Segment::Rest(&rows[0]),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, y, z)
    }

    #[test]
    fn table_interpolates_and_rests_outside() {
        let table =
            Motion::table(vec![(1.0, v(0.0, 0.0, 1.0)), (2.0, v(0.0, 0.0, 3.0)), (4.0, v(2.0, 0.0, 3.0))])
                .unwrap();
        assert_eq!(table.displacement(0.0), v(0.0, 0.0, 1.0));
        assert_eq!(table.velocity(0.0), v(0.0, 0.0, 0.0));
        assert_eq!(table.displacement(1.5), v(0.0, 0.0, 2.0));
        assert_eq!(table.velocity(1.5), v(0.0, 0.0, 2.0));
        assert_eq!(table.displacement(2.0), v(0.0, 0.0, 3.0));
        assert_eq!(table.velocity(2.0), v(1.0, 0.0, 0.0));
        assert_eq!(table.displacement(9.0), v(2.0, 0.0, 3.0));
        assert_eq!(table.velocity(4.0), v(0.0, 0.0, 0.0));
        assert_eq!(
            [0.0, 1.0, 3.9, 4.0].map(|t| table.next_jump(t)),
            [Some(1.0), Some(2.0), Some(4.0), None],
            "the velocity jumps at every row"
        );
        let single = Motion::table(vec![(1.0, v(1.0, 0.0, 0.0))]).unwrap();
        assert_eq!(single.displacement(-5.0), v(1.0, 0.0, 0.0));
    }

    #[test]
    fn bad_motions_are_refused() {
        let bad = v(0.0, f64::INFINITY, 0.0);
        assert!(Motion::constant_velocity(bad).is_err());
        assert!(Motion::sinusoidal(v(1.0, 0.0, 0.0), f64::NAN, 0.0).is_err());
        assert_eq!(Motion::table(vec![]), Err(GeometryError::EmptyTable));
        let zero = Vector3::zeros();
        assert_eq!(Motion::table(vec![(0.0, zero), (0.0, zero)]), Err(GeometryError::TableOrder { row: 1 }));
        assert!(Motion::table(vec![(0.0, zero), (1e-300, v(1e300, 0.0, 0.0))]).is_err());
        assert!(Motion::rotation(zero, zero, 1.0).is_err());
    }

    #[test]
    fn rotation_about_an_axis() {
        let spin = Motion::rotation(v(1.0, 0.0, 0.0), v(0.0, 0.0, 3.0), 2.0).unwrap();
        assert_eq!(spin.velocity_at(v(2.0, 0.0, 5.0), 0.7), v(0.0, 2.0, 0.0));
        assert_eq!(spin.acceleration_at(v(2.0, 0.0, 5.0), 0.7), v(-4.0, 0.0, 0.0));
        assert_eq!(spin.angular_velocity(), v(0.0, 0.0, 2.0));
        assert_eq!(spin.displacement(1.0), Vector3::zeros());
    }

    #[test]
    fn what_counts_as_fixed() {
        assert!(Motion::fixed().is_fixed());
        assert!(Motion::constant_velocity(Vector3::zeros()).unwrap().is_fixed());
        assert!(Motion::rotation(Vector3::zeros(), Vector3::z(), 0.0).unwrap().is_fixed());
        assert!(!Motion::rotation(Vector3::zeros(), Vector3::z(), 1.0).unwrap().is_fixed());
        assert!(!Motion::sinusoidal(Vector3::z(), 1.0, 0.0).unwrap().is_fixed());
    }

    proptest! {
        #[test]
        fn velocity_and_acceleration_are_derivatives(
            t in -2.0f64..2.0, w in -3.0f64..3.0, phase in -3.0f64..3.0, a in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let a = Vector3::from(a);
            // Central difference: h^2/6 times the third derivative (below 1.8*27 or 1.8*81), and rounding 2e-16/h.
            let h = 1e-5;
            let tolerance = h * h / 6.0 * 1.8 * 81.0 + 1.8 * 20.0 * f64::EPSILON / h;
            for motion in [Motion::sinusoidal(a, w, phase).unwrap(), Motion::constant_velocity(a).unwrap()] {
                let rate = (motion.displacement(t + h) - motion.displacement(t - h)) / (2.0 * h);
                prop_assert!((rate - motion.velocity(t)).norm() < tolerance);
                let rate = (motion.velocity(t + h) - motion.velocity(t - h)) / (2.0 * h);
                prop_assert!((rate - motion.acceleration(t)).norm() < tolerance);
            }
            let spin = Motion::rotation(Vector3::zeros(), a + Vector3::new(0.0, 0.0, 1.5), w).unwrap();
            let place = |t: f64| spin.orientation(t) * Vector3::x();
            let rate = (place(t + h) - place(t - h)) / (2.0 * h);
            prop_assert!((rate - spin.velocity_at(place(t), t)).norm() < tolerance);
            let speed = |t: f64| spin.velocity_at(place(t), t);
            let rate = (speed(t + h) - speed(t - h)) / (2.0 * h);
            prop_assert!((rate - spin.acceleration_at(place(t), t)).norm() < tolerance);
        }
    }
}
