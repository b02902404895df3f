use proptest::prelude::*;

use super::*;

fn value(text: &str, dimension: Dimension) -> f64 {
    parse_as(text, dimension).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn values_users_write() {
    // Decimal prefixes are exact, so equality is bitwise.
    for (text, expected, dimension) in [
        ("1e5 N/m", 1e5, Dimension::STIFFNESS),
        ("1 mm", 1e-3, Dimension::LENGTH),
        ("3 mm", 3e-3, Dimension::LENGTH),
        ("5 cm/s", 0.05, Dimension::VELOCITY),
        ("2500 kg/m^3", 2500.0, Dimension::DENSITY),
        ("2.5 g/cm^3", 2500.0, Dimension::DENSITY),
        ("1.2e-3", 1.2e-3, Dimension::DIMENSIONLESS),
        ("-9.81 m/s^2", -9.81, Dimension::ACCELERATION),
        ("-9.81 m s⁻²", -9.81, Dimension::ACCELERATION),
        ("7um", 7e-6, Dimension::LENGTH),
        ("7 µm", 7e-6, Dimension::LENGTH),
        ("7 μm", 7e-6, Dimension::LENGTH),
        ("70 GPa", 70e9, Dimension::PRESSURE),
        ("+.5 ms", 0.5e-3, Dimension::TIME),
        ("2 min", 120.0, Dimension::TIME),
        ("1 h", 3600.0, Dimension::TIME),
        ("120 1/min", 2.0, Dimension::RATE),
        ("3/s", 3.0, Dimension::RATE),
        ("3 kHz", 3000.0, Dimension::RATE),
        ("4 N.m", 4.0, Dimension::TORQUE),
        ("4 N·m", 4.0, Dimension::TORQUE),
        ("4 N*m", 4.0, Dimension::TORQUE),
        ("4 N m", 4.0, Dimension::ENERGY),
        ("4 kg/(m s^2)", 4.0, Dimension::PRESSURE),
        ("4 kg/m/s^2", 4.0, Dimension::PRESSURE),
        ("4 kg m^-1 s^(-2)", 4.0, Dimension::PRESSURE),
        ("6 mW", 6e-3, Dimension::POWER),
        ("2 mrad/s", 2e-3, Dimension::ANGULAR_VELOCITY),
        ("9 (m/s)^2", 9.0, Dimension::new(2, 0, -2)),
        ("1.E2 g", 0.1, Dimension::MASS),
    ] {
        assert_eq!(value(text, dimension), expected, "{text}");
    }
}

#[test]
fn degrees_become_radians() {
    // One multiplication by a rounded constant: two roundings, each half a unit in the last place.
    let tolerance = 2.0 * f64::EPSILON;
    assert!((value("30 deg", Dimension::DIMENSIONLESS) - std::f64::consts::FRAC_PI_6).abs() < tolerance);
    assert!((value("30°", Dimension::DIMENSIONLESS) - std::f64::consts::FRAC_PI_6).abs() < tolerance);
    assert!((value("90 deg/s", Dimension::RATE) - std::f64::consts::FRAC_PI_2).abs() < tolerance);
}

#[test]
fn messages_users_see() {
    for (text, expected) in [
        ("fast", "`fast` does not start with a number; write a number and its unit, such as `2.5 mm`"),
        ("", "`` does not start with a number; write a number and its unit, such as `2.5 mm`"),
        (
            "1.2.3 N/m",
            "`1.2.3 N/m` does not start with a number; write a number and its unit, such as `2.5 mm`",
        ),
        ("inf", "`inf` is not a finite number"),
        ("-NaN N/m", "`-NaN N/m` is not a finite number"),
        ("1e999 N/m", "`1e999 N/m` is not a finite number"),
        ("1e99999999999 N/m", "`1e99999999999 N/m` is not a finite number"),
        ("1 newton/m", "unknown unit `newton`; did you mean `N`?"),
        ("1 parsec", "unknown unit `parsec`; known units are m, g, s, N, Pa, J, Hz, rad, W, min, h and deg"),
        ("1 mm", "expected a stiffness in N/m, but `1 mm` is a length in m"),
        ("1 J", "expected a stiffness in N/m, but `1 J` is an energy or torque in J"),
        ("17", "expected a stiffness in N/m, but `17` has no unit"),
        (
            "1 N/m s",
            "cannot read the unit `N/m s`: a product after `/` needs parentheses, such as `kg/(m s^2)`",
        ),
        ("1 N/", "cannot read the unit `N/`: it ends where a unit should follow"),
        ("1 N^0.5", "cannot read the unit `N^0.5`: a power must be a whole number"),
        ("1 N^x", "cannot read the unit `N^x`: a power must be a whole number from -127 to 127"),
        ("1 (N/m", "cannot read the unit `(N/m`: a parenthesis is not closed"),
        ("1 N/m)", "cannot read the unit `N/m)`: a closing parenthesis has no partner"),
        ("1 m^127 m", "cannot read the unit `m^127 m`: a power is out of range"),
        ("1 2 N", "cannot read the unit `2 N`: a number stands where a unit should"),
    ] {
        let error = parse_as(text, Dimension::STIFFNESS).expect_err(text);
        assert_eq!(error.to_string(), expected, "{text}");
    }
}

#[test]
fn deep_parentheses_are_refused_not_recursed() {
    let text = format!("1 {}m{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(matches!(parse(&text), Err(UnitError::BadUnit { reason: "too many parentheses", .. })));
}

proptest! {
    #[test]
    fn printed_quantities_read_back(
        value in any::<f64>().prop_filter("finite", |v| v.is_finite()),
        length in any::<i8>(), mass in any::<i8>(), time in any::<i8>(),
    ) {
        let quantity = Quantity { value, dimension: Dimension::new(length, mass, time) };
        // Exact, because the prefix of the printed kilogram cancels the power of ten of the gram.
        let back = parse(&quantity.to_string()).unwrap();
        prop_assert_eq!(back.value.to_bits(), quantity.value.to_bits());
        prop_assert_eq!(back.dimension, quantity.dimension);
    }

    #[test]
    fn small_dimensions_read_back(length in -4i8..=4, mass in -2i8..=2, time in -4i8..=4) {
        let quantity = Quantity { value: 0.1, dimension: Dimension::new(length, mass, time) };
        prop_assert_eq!(parse(&quantity.to_string()).unwrap(), quantity);
    }

    #[test]
    fn a_prefix_is_the_same_as_an_exponent(mantissa in -1e6f64..1e6) {
        prop_assert_eq!(
            parse(&format!("{mantissa} um")).unwrap().value,
            format!("{mantissa}e-6").parse::<f64>().unwrap()
        );
    }

    #[test]
    fn no_text_panics(text in "[-+0-9eE. /*^()a-zA-Zµ°²⁻]{0,24}") {
        let _ = parse(&text);
    }

    #[test]
    fn no_unicode_panics(text in any::<String>()) {
        let _ = parse(&text);
        let _ = parse(&format!("1 {text}"));
    }
}
