//! A picture of the spheres, coloured by a scalar such as the speed.
//!
//! Spheres are painted from the back to the front. Those that others hide wholly are left out, which makes the picture of
//! a pile several times smaller.

mod draw;
mod project;

use crate::ReportError;

/// From where the spheres are seen; always parallel light rays, no perspective.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// Along (-1, -1, -1), up is z: the three axes have one scale.
    #[default]
    Isometric,
    /// Along +y: x to the right, z up.
    Side,
    /// Along -z: x to the right, y up. The view for a two-dimensional scene.
    Top,
    /// Turned about z by `azimuth`, then looked down upon by `elevation`, both in degrees. `Side` has azimuth 0 and
    /// elevation 0, `Isometric` has azimuth 45 and elevation 35.26.
    Angles {
        /// Turn of the viewer about the vertical, any value.
        azimuth: f64,
        /// Height of the viewer over the horizon, -90 to 90.
        elevation: f64,
    },
}

/// Spheres to be drawn.
///
/// ```
/// use granule_report::{ScenePicture, View};
/// let picture = ScenePicture::new(&[[0.0, 0.0, 0.5], [1.0, 0.0, 0.5]], &[0.5, 0.5], &[0.0, 2.0], "speed [m/s]");
/// assert!(picture.with_view(View::Side).to_svg().unwrap().contains("speed [m/s]"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePicture<'a> {
    /// Title; may be empty.
    pub title: String,
    /// Centres in metres.
    pub positions: &'a [[f64; 3]],
    /// Radii in metres, positive.
    pub radii: &'a [f64],
    /// The value that gives each sphere its colour.
    pub scalars: &'a [f64],
    /// What the scalar is, with its unit; it labels the colour bar.
    pub scalar_label: String,
    /// Scalars at the two ends of the colour bar. `None` takes the least and the largest.
    pub scalar_range: Option<[f64; 2]>,
    /// Direction of view.
    pub view: View,
    /// Height z of a floor to be drawn below the spheres, with their shadows on it.
    pub floor: Option<f64>,
    /// Two opposite corners of a box whose edges are drawn.
    pub frame: Option<[[f64; 3]; 2]>,
    /// Width of the picture in pixels, 200 to 4000. The height follows from the scene.
    pub width: f64,
}

impl<'a> ScenePicture<'a> {
    /// An isometric picture 800 pixels wide.
    #[must_use]
    pub fn new(
        positions: &'a [[f64; 3]],
        radii: &'a [f64],
        scalars: &'a [f64],
        scalar_label: impl Into<String>,
    ) -> Self {
        Self {
            title: String::new(),
            positions,
            radii,
            scalars,
            scalar_label: scalar_label.into(),
            scalar_range: None,
            view: View::Isometric,
            floor: None,
            frame: None,
            width: 800.0,
        }
    }

    /// The same spheres seen from elsewhere.
    #[must_use]
    pub fn with_view(mut self, view: View) -> Self {
        self.view = view;
        self
    }

    /// The same picture with a floor at height z.
    #[must_use]
    pub fn with_floor(mut self, z: f64) -> Self {
        self.floor = Some(z);
        self
    }

    /// The same picture with the edges of a box.
    #[must_use]
    pub fn with_frame(mut self, low: [f64; 3], high: [f64; 3]) -> Self {
        self.frame = Some([low, high]);
        self
    }

    /// The same picture with a title.
    #[must_use]
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The picture as a complete SVG document. The same spheres always give the same text.
    ///
    /// # Errors
    /// Arrays of different lengths, a position, radius or bound that is not finite, a radius that is not positive, an
    /// empty scalar range, an elevation or width outside its bounds. A scalar that is not finite is no error: its sphere
    /// is grey.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        self.check()?;
        Ok(draw::picture(self))
    }

    fn check(&self) -> Result<(), ReportError> {
        let expected = self.positions.len();
        for (what, found) in [("radii", self.radii.len()), ("scalars", self.scalars.len())] {
            if found != expected {
                return Err(ReportError::LengthMismatch {
                    what: format!("picture, positions and {what}"),
                    expected,
                    found,
                });
            }
        }
        let finite = |p: &[f64; 3]| p.iter().all(|v| v.is_finite());
        if let Some(index) = self.positions.iter().position(|p| !finite(p)) {
            return Err(ReportError::NotFinite { what: "picture, positions".to_owned(), index });
        }
        if let Some(index) = self.radii.iter().position(|r| !(r.is_finite() && *r > 0.0)) {
            return Err(ReportError::Invalid(format!(
                "picture: radius {} of sphere {index} must be positive and finite",
                self.radii[index]
            )));
        }
        if let Some([low, high]) = self.scalar_range
            && !(low.is_finite() && high.is_finite() && low < high)
        {
            return Err(ReportError::Invalid(format!(
                "picture: scalar range {low} to {high} must be finite and rising"
            )));
        }
        if let View::Angles { azimuth, elevation } = self.view
            && !(azimuth.is_finite() && (-90.0..=90.0).contains(&elevation))
        {
            return Err(ReportError::Invalid(format!(
                "picture: azimuth {azimuth} must be finite and elevation {elevation} within -90 and 90 degrees"
            )));
        }
        if self.floor.is_some_and(|z| !z.is_finite()) || self.frame.is_some_and(|f| !f.iter().all(finite)) {
            return Err(ReportError::Invalid("picture: floor and frame must be finite".to_owned()));
        }
        if !(200.0..=4000.0).contains(&self.width) {
            return Err(ReportError::Invalid(format!(
                "picture: width {} must be within 200 and 4000",
                self.width
            )));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
