//! Numbers as people read them: three significant digits at most, and a dash for what is not known.

/// Writes a number with up to three significant digits: `0.0123`, `45.6`, `0.01`, `1.23e-7`; a dash where there is none.
pub fn three(value: Option<f64>) -> String {
    let Some(value) = value else { return String::from("–") };
    let scientific = format!("{value:.2e}");
    let Some((digits, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(0) if value == 0.0 => String::from("0"),
        Ok(exponent @ -4..=2) => {
            let decimals = usize::try_from(2 - exponent).unwrap_or(0);
            String::from(without_zeros(&format!("{value:.decimals$}")))
        }
        _ => format!("{}e{exponent}", without_zeros(digits)),
    }
}

/// Writes a count: in full below 100 000, else as `2.2e6`.
pub fn count(value: u64) -> String {
    if value < 100_000 {
        return value.to_string();
    }
    #[expect(clippy::cast_precision_loss, reason = "three digits are shown")]
    let value = value as f64;
    three(Some(value))
}

/// Writes a probability; one that is too small for its type as such, since no probability of a result that happened is zero.
pub fn probability(value: Option<f64>) -> String {
    if value == Some(0.0) { String::from("< 1e-300") } else { three(value) }
}

/// A decimal fraction without zeros at its end.
fn without_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_and_no_more() {
        let cases = [
            (0.0, "0"),
            (0.01, "0.01"),
            (0.012_345, "0.0123"),
            (45.67, "45.7"),
            (100.0, "100"),
            (999.9, "1e3"),
            (1.234e-7, "1.23e-7"),
            (-0.5, "-0.5"),
        ];
        for (value, text) in cases {
            assert_eq!(three(Some(value)), text);
        }
        assert_eq!(three(None), "–");
        assert_eq!((count(99_999), count(2_200_000)), (String::from("99999"), String::from("2.2e6")));
    }
}
