//! Statistics over data sets.

/// Arithmetic mean; NaN of nothing.
#[must_use]
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation with n - 1; NaN of fewer than two.
#[must_use]
pub(super) fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return f64::NAN;
    }
    let centre = mean(values);
    (values.iter().map(|x| (x - centre).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
}

/// The quantile at `share` of the sorted values, with linear interpolation; NaN of nothing.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place below the length")]
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - place.floor()) * (sorted[above] - sorted[below])
}

/// The middle value.
#[must_use]
pub(super) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// How many values satisfy `test`, as a number to compare.
#[must_use]
pub(super) fn count(values: &[f64], test: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|x| test(**x)).count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!((mean(&values), median(&values), count(&values, |x| x > 2.5)), (2.5, 2.5, 2.0));
        assert_eq!((quantile(&values, 0.0), quantile(&values, 1.0), quantile(&values, 0.25)), (1.0, 4.0, 1.75));
        assert!((standard_deviation(&values) - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15, "n - 1");
        assert!(median(&[]).is_nan() && mean(&[]).is_nan() && standard_deviation(&[1.0]).is_nan(), "of nothing");
    }
}
