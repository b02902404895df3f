//! Angle of repose and radius of a heap, from the positions of its grains.
//!
//! 1. The axis is vertical, through the mean of the centres.
//! 2. Rings about the axis are one largest diameter wide, and each is cut into cells about as long. The height of a cell is
//!    that of the highest grain whose centre lies in it, taken at its top and above the base; zero if there is none. The
//!    height of a ring is the mean over its cells.
//! 3. The flank are the rings beyond the highest one whose height is between a fifth and four fifths of its height: the blunt
//!    top and single grains that rolled away are left out. A line is fitted to it by least squares, each ring counting as
//!    much as it has cells. The slope is the tangent of the angle of repose; where the line meets the base is the radius.

use std::f64::consts::PI;

/// Part of the height of the heap that counts as its flank.
const FLANK: (f64, f64) = (0.2, 0.8);

/// What is known of a heap.
#[derive(Clone, Debug, PartialEq)]
pub struct Heap {
    /// Angle of repose \[rad\].
    pub angle: f64,
    /// Radius at the base \[m\].
    pub radius: f64,
    /// Mean height of the centres above the base \[m\].
    pub mean_height: f64,
    /// Mean distance of the centres from the axis \[m\].
    pub mean_distance: f64,
    /// Middle of each ring and its height above the base \[m\], from the axis to the last ring with a grain.
    pub profile: Vec<[f64; 2]>,
}

/// Measures a heap of grains on a base at the height `base`.
///
/// # Errors
/// There are no grains, or fewer than three rings are flank: that is no cone.
pub fn heap(centres: &[[f64; 3]], radii: &[f64], base: f64) -> Result<Heap, String> {
    let count = centres.len() as f64;
    let width = 2.0 * radii.iter().copied().fold(0.0, f64::max);
    if centres.is_empty() || centres.len() != radii.len() || width <= 0.0 {
        return Err("a heap needs grains".into());
    }
    let mean = |axis: usize| centres.iter().map(|x| x[axis]).sum::<f64>() / count;
    let (x0, y0) = (mean(0), mean(1));
    let mut rings: Vec<Vec<f64>> = Vec::new();
    let mut distances = 0.0;
    for (centre, r) in centres.iter().zip(radii) {
        let (x, y) = (centre[0] - x0, centre[1] - y0);
        let distance = x.hypot(y);
        if !distance.is_finite() || distance > 1e4 * width {
            return Err(format!("a grain is {distance} m away from the axis of the heap"));
        }
        distances += distance;
        let ring = (distance / width) as usize;
        while rings.len() <= ring {
            rings.push(vec![0.0; cells(rings.len())]);
        }
        let turn = (y.atan2(x) + PI) / (2.0 * PI);
        let last = rings[ring].len() - 1;
        let cell = &mut rings[ring][((turn * cells(ring) as f64) as usize).min(last)];
        *cell = cell.max(centre[2] + r - base);
    }
    let height = |ring: &Vec<f64>| ring.iter().sum::<f64>() / ring.len() as f64;
    let profile: Vec<[f64; 2]> =
        rings.iter().enumerate().map(|(k, ring)| [(k as f64 + 0.5) * width, height(ring)]).collect();
    let top = (0..profile.len()).max_by(|a, b| profile[*a][1].total_cmp(&profile[*b][1])).unwrap_or(0);
    let highest = profile[top][1];
    let (slope, radius) = flank(&profile, top, highest)?;
    Ok(Heap {
        angle: slope.atan(),
        radius,
        mean_height: mean(2) - base,
        mean_distance: distances / count,
        profile,
    })
}

/// Cells of a ring: about as long as the ring is wide.
fn cells(ring: usize) -> usize {
    (2.0 * PI * (ring as f64 + 0.5)).round() as usize
}

/// Descent of the line through the flank, and where it meets the base.
fn flank(profile: &[[f64; 2]], top: usize, highest: f64) -> Result<(f64, f64), String> {
    let within = |h: f64| (FLANK.0 * highest..FLANK.1 * highest).contains(&h);
    let part: Vec<(f64, [f64; 2])> = profile
        .iter()
        .enumerate()
        .skip(top + 1)
        .filter(|(_, point)| within(point[1]))
        .map(|(ring, point)| (cells(ring) as f64, *point))
        .collect();
    if part.len() < 3 {
        return Err(format!("{} rings of the heap are flank, at least 3 make a line", part.len()));
    }
    let weight: f64 = part.iter().map(|(w, _)| w).sum();
    let middle = |axis: usize| part.iter().map(|(w, point)| w * point[axis]).sum::<f64>() / weight;
    let (r, h) = (middle(0), middle(1));
    let (mut rr, mut rh) = (0.0, 0.0);
    for (w, point) in &part {
        rr += w * (point[0] - r) * (point[0] - r);
        rh += w * (point[0] - r) * (point[1] - h);
    }
    let slope = -rh / rr;
    if !(slope.is_finite() && slope > 0.0) {
        return Err(format!("the flank of the heap does not fall: slope {slope}"));
    }
    Ok((slope, r + h / slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grains of radius 0.5 on a dense lattice, all whose tops are below the surface of a cone; away from the origin and off
    /// the lattice, so that nothing is special.
    fn cone(degrees: f64, radius: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
        let slope = degrees.to_radians().tan();
        let mut centres = Vec::new();
        let n = (radius / 0.3) as i32 + 1;
        for (i, j) in (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))) {
            let (x, y) = (0.3 * f64::from(i) + 0.11, 0.3 * f64::from(j) + 0.07);
            let surface = slope * (radius - x.hypot(y));
            let mut z = surface - 0.5;
            while z > -0.5 {
                centres.push([x + 3.0, y - 2.0, z + 7.0]);
                z -= 0.6;
            }
        }
        let radii = vec![0.5; centres.len()];
        (centres, radii)
    }

    #[test]
    fn known_cones() {
        for (degrees, radius) in [(15.0, 14.0), (22.0, 11.0), (30.0, 12.0), (40.0, 10.0)] {
            let (centres, radii) = cone(degrees, radius);
            let heap = heap(&centres, &radii, 7.0).unwrap();
            // The highest point of a cell of 1 x 1 with samples 0.3 apart lies up to (1 - 0.3) / 2 diameters inwards of its
            // middle, and as much is added to the radius; the slope does not know. Cells have between 9 and 16 samples,
            // which scatters a ring's height by about a tenth of 0.3 slope.
            let found = heap.angle.to_degrees();
            assert!((found - degrees).abs() < 1.0, "{degrees}: {found}");
            assert!((-0.2..0.6).contains(&(heap.radius - radius)), "{radius}: {}", heap.radius);
            // A cone of solid matter: mean height of its surface is a third; its centres are half a diameter lower.
            assert!(heap.mean_height < 0.4 * radius * degrees.to_radians().tan());
        }
    }

    #[test]
    fn the_angle_does_not_depend_on_where_grains_rolled() {
        let (mut centres, mut radii) = cone(25.0, 11.0);
        let before = heap(&centres, &radii, 7.0).unwrap();
        for k in 0..12 {
            let turn = f64::from(k) * PI / 6.0;
            centres.push([3.0 + 16.0 * turn.cos(), -2.0 + 16.0 * turn.sin(), 7.5]);
            radii.push(0.5);
        }
        let after = heap(&centres, &radii, 7.0).unwrap();
        assert!((after.angle - before.angle).abs() < 0.2_f64.to_radians());
    }

    #[test]
    fn what_is_no_cone_is_refused() {
        assert!(heap(&[], &[], 0.0).is_err());
        let square = (0..400).map(|k| [f64::from(k % 20) - 9.5, f64::from(k / 20) - 9.5, 0.5]);
        let disc: Vec<[f64; 3]> = square.filter(|x| x[0].hypot(x[1]) < 9.0).collect();
        assert!(heap(&disc, &vec![0.5; disc.len()], 0.0).is_err());
        assert!(heap(&[[0.0, 0.0, f64::NAN]; 2], &[0.5; 2], 0.0).is_err());
        assert!(heap(&[[f64::INFINITY, 0.0, 0.0]; 2], &[0.5; 2], 0.0).is_err());
    }
}
