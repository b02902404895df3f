//! Parallel projection, and which spheres can be seen at all.

use super::View;

/// Directions of the screen in space: right, up, and towards the viewer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Screen {
    pub(super) fn of(view: View) -> Self {
        let (azimuth, elevation) = match view {
            View::Isometric => (45.0, (0.5f64).sqrt().atan().to_degrees()),
            View::Side => (0.0, 0.0),
            View::Top => (0.0, 90.0),
            View::Angles { azimuth, elevation } => (azimuth, elevation),
        };
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (se, ce) = elevation.to_radians().sin_cos();
        Self { right: [ca, sa, 0.0], up: [-sa * se, ca * se, ce], towards: [sa * ce, -ca * ce, se] }
    }

    /// Right, up, and distance towards the viewer.
    pub(super) fn project(&self, point: [f64; 3]) -> [f64; 3] {
        [dot(self.right, point), dot(self.up, point), dot(self.towards, point)]
    }

    /// Height of a horizontal unit circle on the screen; 0 seen from the side, 1 from above.
    pub(super) fn flatness(&self) -> f64 {
        self.towards[2].abs()
    }

    /// Whether the upper side of a floor is seen.
    pub(super) fn shows_upper_side(&self) -> bool {
        self.towards[2] > 1e-9
    }
}

/// A sphere on the screen in pixels, y down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) index: usize,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) radius: f64,
    pub(super) depth: f64,
}

/// Discs from the back to the front, without those that the ones in front cover wholly. Coverage is judged on a pixel
/// grid with caution: a pixel counts as covered only if a disc holds all of it.
pub(super) fn visible(mut discs: Vec<Disc>, width: f64, height: f64) -> Vec<Disc> {
    // Nearest first; equal depths in the order of their index, so that the picture is always the same.
    discs.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(b.index.cmp(&a.index)));
    let (columns, rows) = (width.ceil() as usize + 1, height.ceil() as usize + 1);
    let mut covered = vec![false; columns * rows];
    let mut seen = Vec::new();
    for disc in discs {
        let first_row = (disc.y - disc.radius).floor().max(0.0) as usize;
        let last_row = ((disc.y + disc.radius).floor().max(0.0) as usize).min(rows - 1);
        let first_column = (disc.x - disc.radius).floor().max(0.0) as usize;
        let last_column = ((disc.x + disc.radius).floor().max(0.0) as usize).min(columns - 1);
        let mut shows = false;
        for row in first_row..=last_row {
            for column in first_column..=last_column {
                // Distances of the pixel's nearest and farthest point from the centre.
                let (dx, dy) = (column as f64 + 0.5 - disc.x, row as f64 + 0.5 - disc.y);
                let near = (dx.abs() - 0.5).max(0.0).hypot((dy.abs() - 0.5).max(0.0));
                let pixel = &mut covered[row * columns + column];
                if near <= disc.radius && !*pixel {
                    shows = true;
                    *pixel = (dx.abs() + 0.5).hypot(dy.abs() + 0.5) <= disc.radius;
                }
            }
        }
        if shows {
            seen.push(disc);
        }
    }
    seen.reverse();
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_screen_is_a_right_handed_frame() {
        let views =
            [View::Isometric, View::Side, View::Top, View::Angles { azimuth: 200.0, elevation: -33.0 }];
        for view in views {
            let s = Screen::of(view);
            let cross = [
                s.right[1] * s.up[2] - s.right[2] * s.up[1],
                s.right[2] * s.up[0] - s.right[0] * s.up[2],
                s.right[0] * s.up[1] - s.right[1] * s.up[0],
            ];
            // Products of sines rounded once or twice.
            assert!((0..3).all(|k| (cross[k] - s.towards[k]).abs() < 1e-15), "{view:?}");
            assert!(dot(s.right, s.up).abs() < 1e-15 && (dot(s.up, s.up) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_isometric_view_shortens_all_axes_alike() {
        let s = Screen::of(View::Isometric);
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let [x, y, _] = s.project(axis);
            assert!((x.hypot(y) - (2.0f64 / 3.0).sqrt()).abs() < 1e-15);
        }
    }

    #[test]
    fn side_and_top_show_the_named_axes() {
        let p = [1.0, 2.0, 3.0];
        let side = Screen::of(View::Side).project(p);
        assert_eq!([side[0], side[1], side[2]], [1.0, 3.0, -2.0]);
        let top = Screen::of(View::Top).project(p);
        // The cosine of 90 degrees is 6e-17, not zero.
        assert!((top[0] - 1.0).abs() < 1e-15 && (top[1] - 2.0).abs() < 1e-15 && (top[2] - 3.0).abs() < 1e-15);
    }

    #[test]
    fn only_what_is_hidden_wholly_is_left_out() {
        let disc = |index, x, radius, depth| Disc { index, x, y: 50.0, radius, depth };
        let behind = disc(0, 50.0, 10.0, 0.0);
        let beside = disc(1, 75.0, 10.0, 0.5);
        let front = disc(2, 50.0, 20.0, 1.0);
        let order: Vec<usize> =
            visible(vec![front, behind, beside], 100.0, 100.0).iter().map(|d| d.index).collect();
        assert_eq!(order, [1, 2]);
    }
}
