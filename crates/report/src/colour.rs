//! Colours that readers with a colour-vision deficiency can tell apart.

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red, 0 to 255.
    pub red: u8,
    /// Green, 0 to 255.
    pub green: u8,
    /// Blue, 0 to 255.
    pub blue: u8,
}

impl Colour {
    /// A colour from its three parts.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// The series palette: Okabe and Ito 2008, "Color universal design", without its yellow, which is too faint for a
    /// thin line on white. Black is not in the list either, because it vanishes on a dark page.
    pub const PALETTE: [Self; 6] = [
        Self::new(0x00, 0x72, 0xB2),
        Self::new(0xD5, 0x5E, 0x00),
        Self::new(0x00, 0x9E, 0x73),
        Self::new(0xCC, 0x79, 0xA7),
        Self::new(0xE6, 0x9F, 0x00),
        Self::new(0x56, 0xB4, 0xE9),
    ];

    /// `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }

    /// The colour `weight` of the way to `other`; `weight` is held within 0 and 1.
    #[must_use]
    pub fn mix(self, other: Self, weight: f64) -> Self {
        let w = weight.max(0.0).min(1.0);
        let part = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * w).round() as u8;
        Self::new(part(self.red, other.red), part(self.green, other.green), part(self.blue, other.blue))
    }
}

/// Ten equally spaced stations of matplotlib's viridis map.
const VIRIDIS: [Colour; 10] = [
    Colour::new(0x44, 0x01, 0x54),
    Colour::new(0x48, 0x28, 0x78),
    Colour::new(0x3E, 0x49, 0x89),
    Colour::new(0x31, 0x68, 0x8E),
    Colour::new(0x26, 0x82, 0x8E),
    Colour::new(0x1F, 0x9E, 0x89),
    Colour::new(0x35, 0xB7, 0x79),
    Colour::new(0x6E, 0xCE, 0x58),
    Colour::new(0xB5, 0xDE, 0x2B),
    Colour::new(0xFD, 0xE7, 0x25),
];

/// The viridis colour map, perceptually even and readable in grey: 0 is dark violet, 1 is yellow. Values outside
/// 0 to 1 take the nearest end; NaN takes the low end.
#[must_use]
pub fn viridis(fraction: f64) -> Colour {
    let place = fraction.max(0.0).min(1.0) * (VIRIDIS.len() - 1) as f64;
    let low = (place.floor() as usize).min(VIRIDIS.len() - 2);
    VIRIDIS[low].mix(VIRIDIS[low + 1], place - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_meets_its_stations_and_its_ends() {
        for (k, station) in VIRIDIS.iter().enumerate() {
            assert_eq!(viridis(k as f64 / 9.0), *station);
        }
        assert_eq!(viridis(-3.0), VIRIDIS[0]);
        assert_eq!(viridis(7.0), VIRIDIS[9]);
        assert_eq!(viridis(f64::NAN), VIRIDIS[0]);
    }

    #[test]
    fn viridis_grows_lighter_all_the_way() {
        let light =
            |c: Colour| 0.2126 * f64::from(c.red) + 0.7152 * f64::from(c.green) + 0.0722 * f64::from(c.blue);
        let values: Vec<f64> = (0..=50).map(|k| light(viridis(f64::from(k) / 50.0))).collect();
        assert!(values.windows(2).all(|w| w[1] > w[0] - 1.0), "{values:?}");
    }

    #[test]
    fn hex_has_six_digits() {
        assert_eq!(Colour::new(0, 10, 255).hex(), "#000aff");
    }
}
