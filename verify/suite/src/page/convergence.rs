//! Error against sample count on logarithmic axes: points with bands, and the slope that theory predicts.

use maud::{Markup, html};
use plotters::prelude::*;

use super::chart::{self, DrawingError, GRID, INK, LINES};
use crate::figures::three;
use crate::report::picture::LineData;

/// The chart, and its legend with measured and predicted slopes.
pub(super) fn draw(lines: &[LineData]) -> Markup {
    html! {
        (chart_of(lines))
        table.legend {
            tr { th { "" } th { "" } th { "slope" } th { "99.9 % limits" } th { "theory" } }
            @for (line, colour) in lines.iter().zip(LINES.iter().cycle()) {
                tr {
                    td { span.dot style=(format!("background:rgb({} {} {})", colour.0, colour.1, colour.2)) {} }
                    td { (line.name) }
                    td { (number(line.slope[0])) }
                    td { (number(line.slope[1])) " to " (number(line.slope[2])) }
                    td { (number(Some(line.theory))) }
                }
            }
        }
        p.note { "Root mean square error against sample count. Bands: ± 3 standard errors. Dashed: the theory's slope." }
    }
}

fn number(value: Option<f32>) -> String {
    three(value.map(f64::from))
}

fn chart_of(lines: &[LineData]) -> Markup {
    let drawn: Vec<Vec<[f64; 3]>> = lines.iter().map(|line| positive(&line.points)).collect();
    let points = || drawn.iter().flatten();
    let x = chart::range(points().map(|p| p[0].ln()));
    let y = chart::range(points().flat_map(|p| [p[1].ln() - 3.0 * p[2], p[1].ln() + 3.0 * p[2]]));
    let (Some(x), Some(y)) = (x, y) else { return html! { p.note { "No point to draw." } } };
    chart::svg(400, "error against sample count", |area| {
        let [x, y] = [x, y].map(|[low, high]| [(low - 0.2).exp(), (high + 0.2).exp()]);
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(44)
            .y_label_area_size(70)
            .build_cartesian_2d((x[0]..x[1]).log_scale(), (y[0]..y[1]).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID)
            .axis_style(INK)
            .label_style(chart::text())
            .x_desc("samples")
            .y_desc("root mean square error")
            .x_label_formatter(&|v| chart::power_of_ten(*v))
            .y_label_formatter(&|v| chart::power_of_ten(*v))
            .draw()?;
        for ((line, points), colour) in lines.iter().zip(&drawn).zip(LINES.iter().cycle()) {
            chart.draw_series([Polygon::new(band(points), colour.mix(0.18).filled())])?;
            chart
                .draw_series(LineSeries::new(points.iter().map(|p| (p[0], p[1])), colour.stroke_width(2)))?;
            chart.draw_series(points.iter().map(|p| Circle::new((p[0], p[1]), 3, colour.filled())))?;
            if let Some(ends) = theory(points, f64::from(line.theory)) {
                chart.draw_series(DashedLineSeries::new(ends, 5, 4, INK.stroke_width(1)))?;
            }
        }
        Ok::<(), DrawingError>(())
    })
}

/// Points that logarithmic axes can show.
fn positive(points: &[[f32; 3]]) -> Vec<[f64; 3]> {
    points.iter().filter(|p| p[0] > 0.0 && p[1] > 0.0).map(|p| p.map(f64::from)).collect()
}

/// The outline of three standard errors to either side.
fn band(points: &[[f64; 3]]) -> Vec<(f64, f64)> {
    let side = |sign: f64| move |p: &[f64; 3]| (p[0], p[1] * (sign * 3.0 * p[2]).exp());
    points.iter().map(side(1.0)).chain(points.iter().rev().map(side(-1.0))).collect()
}

/// The ends of a line of the theory's slope through the points' middle.
fn theory(points: &[[f64; 3]], slope: f64) -> Option<[(f64, f64); 2]> {
    let (first, last) = (points.first()?, points.last()?);
    #[expect(clippy::cast_precision_loss, reason = "a plot has few points")]
    let count = points.len() as f64;
    let mean = |i: usize| points.iter().map(|p| p[i].ln()).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    Some([first[0], last[0]].map(|n| (n, (y + slope * (n.ln() - x)).exp())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_power_law_lie_on_the_theorys_line() {
        let points = [[1.0, 8.0, 0.0], [4.0, 4.0, 0.0], [16.0, 2.0, 0.0]];
        let [a, b] = theory(&points, -0.5).expect("there are points");
        // Exponentials and logarithms of numbers near 1: rounding stays below 1e-12.
        assert!((a.1 - 8.0).abs() < 1e-12 && (b.1 - 2.0).abs() < 1e-12);
    }

    #[test]
    fn what_a_logarithm_cannot_show_is_left_out() {
        assert_eq!(positive(&[[1.0, 0.0, 0.1], [2.0, 1.0, 0.1]]).len(), 1);
        assert!(draw(&[]).into_string().contains("No point"));
    }
}
