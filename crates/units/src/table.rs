//! The names of units and prefixes.

use crate::Dimension;

/// A named unit: `10^exponent * factor` in SI base units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unit {
    pub(crate) exponent: i32,
    pub(crate) factor: f64,
    pub(crate) dimension: Dimension,
}

/// Units that take a decimal prefix: name, power of ten to SI, dimension.
const PREFIXABLE: &[(&str, i32, Dimension)] = &[
    ("m", 0, Dimension::LENGTH),
    ("g", -3, Dimension::MASS),
    ("s", 0, Dimension::TIME),
    ("N", 0, Dimension::FORCE),
    ("Pa", 0, Dimension::PRESSURE),
    ("J", 0, Dimension::ENERGY),
    ("Hz", 0, Dimension::RATE),
    ("rad", 0, Dimension::DIMENSIONLESS),
    ("W", 0, Dimension::POWER),
];

/// Units without prefixes: name, factor to SI, dimension.
const PLAIN: &[(&str, f64, Dimension)] = &[
    ("min", 60.0, Dimension::TIME),
    ("h", 3600.0, Dimension::TIME),
    ("deg", std::f64::consts::PI / 180.0, Dimension::DIMENSIONLESS),
    ("°", std::f64::consts::PI / 180.0, Dimension::DIMENSIONLESS),
];

/// Decimal prefixes; the micro sign has two code points.
const PREFIXES: &[(&str, i32)] = &[
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// Long names that people write; they are suggested, not accepted, so that one quantity has one spelling.
const LONG_NAMES: &[(&str, &str)] = &[
    ("meter", "m"),
    ("metre", "m"),
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("micron", "um"),
    ("gram", "g"),
    ("kilogram", "kg"),
    ("second", "s"),
    ("sec", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("joule", "J"),
    ("hertz", "Hz"),
    ("watt", "W"),
    ("radian", "rad"),
    ("degree", "deg"),
];

/// Looks up one unit name, with its prefix if it has one. Exact names win, so `min` is the minute.
pub(crate) fn unit(name: &str) -> Option<Unit> {
    if let Some(&(_, factor, dimension)) = PLAIN.iter().find(|(plain, _, _)| *plain == name) {
        return Some(Unit { exponent: 0, factor, dimension });
    }
    let base = |name: &str| PREFIXABLE.iter().find(|(known, _, _)| *known == name);
    if let Some(&(_, exponent, dimension)) = base(name) {
        return Some(Unit { exponent, factor: 1.0, dimension });
    }
    PREFIXES.iter().find_map(|&(prefix, power)| {
        let &(_, exponent, dimension) = base(name.strip_prefix(prefix)?)?;
        Some(Unit { exponent: exponent + power, factor: 1.0, dimension })
    })
}

/// The known unit name that looks most like `name`, if any is close.
pub(crate) fn nearest(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    if let Some((_, symbol)) = LONG_NAMES.iter().find(|(long, _)| *long == lower || *long == singular) {
        return Some((*symbol).to_string());
    }
    let length = name.chars().count();
    // One edit in two letters already names another unit; only wrong capitals are a safe guess there.
    let allowed = if length <= 2 { 0 } else { 1 };
    let mut best: Option<(usize, String)> = None;
    for known in symbols() {
        let distance = strsim::osa_distance(&lower, &known.to_lowercase());
        if distance <= allowed && best.as_ref().is_none_or(|(least, _)| distance < *least) {
            best = Some((distance, known));
        }
    }
    best.map(|(_, known)| known)
}

/// Every accepted name, unprefixed names first and common prefixes before rare ones, so that ties go to them.
fn symbols() -> impl Iterator<Item = String> {
    let bare = PREFIXABLE.iter().map(|(name, _, _)| (*name).to_string());
    let plain = PLAIN.iter().map(|(name, _, _)| (*name).to_string());
    let prefixed = ["m", "k", "u", "c", "M", "G", "n", "d", "p", "f", "T"]
        .iter()
        .flat_map(|prefix| PREFIXABLE.iter().map(move |(name, _, _)| format!("{prefix}{name}")));
    bare.chain(plain).chain(prefixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_has_two_meanings() {
        let mut names: Vec<String> = symbols().collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
        for name in names {
            assert!(unit(&name).is_some(), "{name} is suggested but not accepted");
        }
    }

    #[test]
    fn suggestions() {
        assert_eq!(nearest("pa").as_deref(), Some("Pa"));
        assert_eq!(nearest("Newtons").as_deref(), Some("N"));
        assert_eq!(nearest("KG").as_deref(), Some("kg"));
        assert_eq!(nearest("degs").as_deref(), Some("deg"));
        assert_eq!(nearest("radd").as_deref(), Some("rad"));
        assert_eq!(nearest("parsec"), None);
        assert_eq!(nearest("q"), None);
    }
}
