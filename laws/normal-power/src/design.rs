//! Parameters that have no closed form, found from the restitution that they give.

/// The coefficient at which `restitution`, which falls from one at zero, is `wanted` in (0, 1]. `scale` is a guess of its
/// size. The result is good to 1e-12 of itself, or to the accuracy of `restitution`.
pub(crate) fn coefficient(wanted: f64, scale: f64, restitution: impl Fn(f64) -> f64) -> f64 {
    if wanted >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (scale, scale);
    while low > f64::MIN_POSITIVE && restitution(low) <= wanted {
        low *= 0.25;
    }
    while high < f64::MAX && restitution(high) > wanted {
        high *= 4.0;
    }
    while high - low > 1e-12 * high {
        let middle = if high > 2.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) };
        if middle <= low || middle >= high {
            break;
        }
        if restitution(middle) > wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_root_from_any_guess() {
        for scale in [1e-12, 1.0, 1e9] {
            for wanted in [1.0, 0.999, 0.5, 1e-3] {
                let found = coefficient(wanted, scale, |c: f64| (-3.0 * c).exp());
                assert!((found + f64::ln(wanted) / 3.0).abs() < 1e-11, "{scale} {wanted} {found}");
            }
        }
    }
}
