//! Measured points on an exact curve, and their distance from it in standard errors below.

use maud::{Markup, html};
use plotters::prelude::*;

use super::chart::{self, DrawingError, GRID, INK, LINES};
use crate::figures::three;

/// Half the height of the strip of residuals, in standard errors.
const STRIP: f64 = 5.0;

type Area<'a, 'b> = DrawingArea<SVGBackend<'b>, plotters::coord::Shift>;

/// The chart and its caption.
pub(super) fn draw(axes: &[&str; 2], exact: &[[f32; 2]], measured: &[[f32; 3]]) -> Markup {
    let exact: Vec<(f64, f64)> = exact.iter().map(|p| (f64::from(p[0]), f64::from(p[1]))).collect();
    let measured: Vec<[f64; 3]> = measured.iter().map(|p| p.map(f64::from)).collect();
    let x = chart::range(exact.iter().map(|p| p.0).chain(measured.iter().map(|p| p[0])));
    let spread = measured.iter().flat_map(|p| [p[1] - 3.0 * p[2], p[1] + 3.0 * p[2]]);
    let y = chart::range(exact.iter().map(|p| p.1).chain(spread));
    let (Some(x), Some(y)) = (x, y) else { return html! { p.note { "No point to draw." } } };
    let residuals: Vec<(f64, f64)> =
        measured.iter().filter_map(|p| Some((p[0], residual(p[1] - at(&exact, p[0])?, p[2])))).collect();
    let picture = chart::svg(430, &format!("{} against {}", axes[1], axes[0]), |area| {
        let (upper, lower) = area.split_vertically(290);
        draw_values(&upper, axes, [x, y], (&exact, &measured))?;
        draw_residuals(&lower, x, &residuals)
    });
    let largest = residuals.iter().fold(0.0f64, |a, p| a.max(p.1.abs()));
    html! {
        (picture)
        p.note { (axes[1]) " against " (axes[0]) ". Line: exact. Bars: ± 3 standard errors. Below: measured − exact in standard errors; the largest of "
            (residuals.len()) " is " (three(Some(largest))) "." }
    }
}

fn draw_values(
    area: &Area<'_, '_>,
    axes: &[&str; 2],
    [x, y]: [[f64; 2]; 2],
    (exact, measured): (&[(f64, f64)], &[[f64; 3]]),
) -> Result<(), DrawingError> {
    let margin = 0.05 * (y[1] - y[0]);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(24)
        .y_label_area_size(70)
        .build_cartesian_2d(x[0]..x[1], y[0] - margin..y[1] + margin)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(INK)
        .label_style(chart::text())
        .y_desc(axes[1])
        .x_label_formatter(&|v| three(Some(*v)))
        .y_label_formatter(&|v| three(Some(label(*v, y))))
        .draw()?;
    chart.draw_series(LineSeries::new(exact.iter().copied(), INK.stroke_width(1)))?;
    let style = LINES[0].stroke_width(2);
    chart.draw_series(
        measured.iter().map(|&[x, y, se]| PathElement::new([(x, y - 3.0 * se), (x, y + 3.0 * se)], style)),
    )?;
    chart.draw_series(measured.iter().map(|&[x, y, _]| Circle::new((x, y), 3, LINES[0].filled())))?;
    Ok(())
}

fn draw_residuals(area: &Area<'_, '_>, x: [f64; 2], residuals: &[(f64, f64)]) -> Result<(), DrawingError> {
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(24)
        .y_label_area_size(70)
        .build_cartesian_2d(x[0]..x[1], -STRIP..STRIP)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(INK)
        .label_style(chart::text())
        .y_desc("residual, σ")
        .y_labels(5)
        .x_label_formatter(&|v| three(Some(*v)))
        .draw()?;
    chart.draw_series([PathElement::new([(x[0], 0.0), (x[1], 0.0)], INK)])?;
    let clipped = residuals.iter().map(|&(x, r)| (x, r.clamp(-STRIP, STRIP)));
    chart.draw_series(clipped.map(|place| Circle::new(place, 3, LINES[0].filled())))?;
    Ok(())
}

/// A value on an axis, the zero that steps from its ends miss by rounding included.
fn label(value: f64, [low, high]: [f64; 2]) -> f64 {
    if value.abs() < 1e-9 * (high - low) { 0.0 } else { value }
}

/// A difference in standard errors; 0 where nothing differs, also of a value without error.
fn residual(difference: f64, error: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / error }
}

/// The curve at `x`: its own value where it has that point, else between its neighbours; none outside.
fn at(exact: &[(f64, f64)], x: f64) -> Option<f64> {
    if let Some(point) = exact.iter().find(|point| point.0 == x) {
        return Some(point.1);
    }
    let pair = exact.windows(2).find(|pair| (pair[0].0..pair[1].0).contains(&x))?;
    let t = (x - pair[0].0) / (pair[1].0 - pair[0].0);
    Some(pair[0].1 * (1.0 - t) + pair[1].1 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_between_its_points() {
        let exact = [(0.0, 0.0), (2.0, 4.0)];
        assert_eq!(
            [at(&exact, 0.0), at(&exact, 1.0), at(&exact, 2.0), at(&exact, 3.0)],
            [Some(0.0), Some(2.0), Some(4.0), None]
        );
    }

    #[test]
    fn a_value_without_error_is_on_its_curve_or_far_from_it() {
        assert_eq!(
            [residual(0.0, 0.0), residual(0.5, 0.25), residual(-1.0, 0.0)],
            [0.0, 2.0, f64::NEG_INFINITY]
        );
    }

    #[test]
    fn zero_is_labelled_zero() {
        assert_eq!([label(-1e-19, [-1e-3, 1e-3]), label(1e-4, [-1e-3, 1e-3])], [0.0, 1e-4]);
    }

    #[test]
    fn nothing_to_draw_is_said() {
        assert!(draw(&["x", "y"], &[], &[]).into_string().contains("No point"));
    }
}
