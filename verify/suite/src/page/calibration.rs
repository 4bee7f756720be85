//! Error rates of the tests themselves: p-values of right subjects, and how often defects are found.

use maud::{Markup, html};

use crate::figures::three;
use crate::report::Calibration;

/// Size of a small chart.
const WIDTH: f64 = 180.0;
const HEIGHT: f64 = 70.0;

/// Largest defect of the power curve, in resolutions.
const LARGEST: f64 = 1.6;

/// The kinds of tests in a table; nothing without any.
pub(super) fn section(found: &[Calibration]) -> Markup {
    let mut kinds: Vec<&str> = found.iter().map(|c| c.kind.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    html! {
        @if !found.is_empty() {
            section.calibration {
                h2 { "How often the tests err" }
                p.note {
                    "Left: p-values of right subjects, which are uniform where a test is exact; the line is what uniform ones have. Rejected: right runs that a level "
                    "of 0.1, 0.01 and 0.001 rejects, and the 99.99 % limits of a right test. Right: share of runs that reject a defect at 0.001 against its size in "
                    "resolutions; dashed, 90 % at one resolution is what every claim on this page states. Filled: the long form; open: the short one, which runs with all tests."
                }
                table.legend {
                    tr { th { "test" } th { "p-values" } th { "rejected" } th { "power" } th { "found at 1" } }
                    @for kind in kinds { (row(&found.iter().filter(|c| c.kind == kind).collect::<Vec<_>>())) }
                }
            }
        }
    }
}

/// The forms of one kind; there is at least one.
fn row(forms: &[&Calibration]) -> Markup {
    let first = forms.iter().find(|c| c.form == "long").or(forms.first());
    html! {
        @if let Some(first) = first {
            tr {
                td { b { (first.kind) } br; (first.says) br; "Resolution " (three(Some(first.resolution))) ", " (first.quantity) "." }
                td { (histogram(first)) }
                td { @for form in forms { (rates(form)) } }
                td { (power(forms)) }
                td { @for form in forms { (at_one(form)) br; } }
            }
        }
    }
}

fn rates(form: &Calibration) -> Markup {
    html! {
        @for rate in &form.rates {
            span.fails[!(rate.low..=rate.high).contains(&rate.rejected) && rate.rejected > 0] { (rate.rejected) }
            " (" (rate.low) "–" (rate.high) "), "
        }
        "of " (form.nulls) br;
    }
}

fn at_one(form: &Calibration) -> Markup {
    let found = form.power.iter().find(|[size, _]| *size == 1.0).map(|[_, share]| 100.0 * share);
    html! { (three(found)) " % of " (form.runs) }
}

fn histogram(form: &Calibration) -> Markup {
    #[expect(clippy::cast_precision_loss, reason = "a drawing")]
    let counts: Vec<f64> = form.histogram.iter().map(|&count| count as f64).collect();
    let even = counts.iter().sum::<f64>() / counts.len().max(1) as f64;
    let top = counts.iter().fold(1.5 * even, |a, &b| a.max(b)).max(1.0);
    let width = WIDTH / counts.len().max(1) as f64;
    let y = |count: f64| HEIGHT * (1.0 - count / top);
    html! {
        svg.small viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(format!("p-values of {}", form.kind)) {
            @for (i, &count) in counts.iter().enumerate() {
                rect x=(i as f64 * width + 0.5) y=(y(count)) width=(width - 1.0) height=(HEIGHT - y(count)) {}
            }
            line x1="0" x2=(WIDTH) y1=(y(even)) y2=(y(even)) {}
        }
    }
}

fn power(forms: &[&Calibration]) -> Markup {
    let place = |[size, share]: [f64; 2]| [WIDTH * size / LARGEST, 5.0 + (HEIGHT - 10.0) * (1.0 - share)];
    let path = |form: &Calibration| {
        let point = |(i, p): (usize, &[f64; 2])| {
            let [x, y] = place(*p);
            format!("{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" })
        };
        form.power.iter().enumerate().map(point).collect::<String>()
    };
    let [one, stated] = place([1.0, 0.9]);
    html! {
        svg.small viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label="power against the defect's size" {
            line.dashed x1="0" x2=(one) y1=(stated) y2=(stated) {}
            line.dashed x1=(one) x2=(one) y1=(stated) y2=(HEIGHT) {}
            @for form in forms {
                path d=(path(form)) {}
                @for p in &form.power {
                    circle.open[form.form == "short"] cx=(place(*p)[0]) cy=(place(*p)[1]) r="3" {}
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::calibration::{Rate, read};

    fn found(form: &str) -> Calibration {
        Calibration {
            kind: String::from("mean"),
            says: String::from("32 replicates"),
            form: String::from(form),
            seed: 1,
            nulls: 1000,
            histogram: vec![50; 20],
            rates: vec![Rate { level: 0.1, rejected: 200, low: 65, high: 139 }],
            quantity: String::from("error of the mean"),
            resolution: 0.1,
            runs: 200,
            power: vec![[0.5, 0.1], [1.0, 0.905]],
        }
    }

    #[test]
    fn one_row_a_kind_with_both_forms() {
        let page = section(&[found("short"), found("long")]).into_string();
        assert_eq!((page.matches("<b>mean</b>").count(), page.matches("90.5 %").count()), (1, 2));
        assert_eq!(page.matches("<rect").count(), 20);
        assert!(page.contains("class=\"fails\""), "a rate outside its limits stands out");
        assert_eq!(section(&[]).into_string(), "");
    }

    #[test]
    fn the_committed_calibration_covers_every_kind_and_is_within_its_limits() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/calibration");
        let all = read(&folder).expect("calibrations");
        assert!(
            all.len() >= 18 && all.iter().all(|c| c.form == "long" && c.nulls >= 10_000 && c.runs >= 1000)
        );
        for kind in &all {
            // Where nothing is left to chance, p is always 1.
            let certain = kind.histogram.last() == Some(&kind.nulls);
            let within = |rate: &Rate| {
                (rate.low..=rate.high).contains(&rate.rejected) || certain && rate.rejected == 0
            };
            assert!(kind.rates.iter().all(within), "{}", kind.kind);
            let found = kind.power.iter().find(|[size, _]| *size == 1.0).map_or(0.0, |[_, share]| *share);
            assert!((0.85..=0.95).contains(&found), "{}: {found}", kind.kind);
        }
    }
}
