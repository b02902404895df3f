//! Numbers as text: shortest decimal that reads back to the same bits.

/// Integers up to here are exact in a double.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Appends a finite number: an integer without point or exponent, anything else in the shortest form that reads back
/// to the same bits.
pub(crate) fn push(out: &mut Vec<u8>, value: f64) {
    if value.abs() < EXACT && value.trunc() == value {
        if value == 0.0 && value.is_sign_negative() {
            out.extend_from_slice(b"-0");
        } else {
            push_integer(out, value as i64);
        }
    } else {
        out.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes());
    }
}

/// Appends an integer.
pub(crate) fn push_integer(out: &mut Vec<u8>, value: i64) {
    let mut digits = [0u8; 20];
    let mut start = digits.len();
    let mut rest = value.unsigned_abs();
    loop {
        start -= 1;
        digits[start] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    if value < 0 {
        start -= 1;
        digits[start] = b'-';
    }
    out.extend_from_slice(&digits[start..]);
}

/// A number as text.
pub(crate) fn text(value: f64) -> String {
    let mut out = Vec::new();
    push(&mut out, value);
    String::from_utf8_lossy(&out).into_owned()
}

/// Reads a finite number; `None` for anything else, overflow to infinity included.
pub(crate) fn parse(text: &str) -> Option<f64> {
    // Rust also reads `inf`, `infinity` and `nan`.
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn integers_look_like_integers() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (100.0, "100"),
            (-3.0, "-3"),
            (0.1, "0.1"),
            (1e-7, "1e-7"),
            (9_007_199_254_740_991.0, "9007199254740991"),
        ] {
            assert_eq!(text(value), expected);
        }
        let mut out = Vec::new();
        push_integer(&mut out, i64::MIN);
        assert_eq!(out, i64::MIN.to_string().into_bytes());
    }

    #[test]
    fn only_finite_numbers_are_read() {
        for bad in ["inf", "-inf", "nan", "NaN", "infinity", "1e999", "", "x", "0x10", "1d5", "1 2"] {
            assert_eq!(parse(bad), None, "{bad}");
        }
        assert_eq!(parse("-1.5e-3"), Some(-1.5e-3));
    }

    proptest! {
        #[test]
        fn reads_back_the_same_bits(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let shown = text(value);
            prop_assert!(shown.len() <= LONGEST);
            prop_assert_eq!(parse(&shown).map(f64::to_bits), Some(bits));
        }
    }

    /// `-1.2345678901234567e-308`.
    const LONGEST: usize = 24;
}
