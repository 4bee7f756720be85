//! A picture of a test's cells that any browser shows: observed, expected, residual in standard deviations, and the worst cells.

use std::fmt::Write as _;

use crate::claim::{Evidence, Picture};

/// Side of a map, pixels.
const SIDE: f64 = 260.0;
/// Space around maps and lines of text.
const GAP: f64 = 20.0;
/// Height of a line of text.
const LINE: f64 = 18.0;
/// Residuals of this many standard deviations and more have the scale's last colour.
const SATURATION: f64 = 4.0;
/// Cells that are named.
const WORST: usize = 5;

/// Counts, from none to the most.
const SEQUENTIAL: [[f64; 3]; 3] = [[38.0, 24.0, 74.0], [36.0, 122.0, 134.0], [250.0, 230.0, 60.0]];
/// Residuals: too few, as expected, too many.
const DIVERGING: [[f64; 3]; 3] = [[20.0, 70.0, 150.0], [240.0, 240.0, 238.0], [150.0, 24.0, 36.0]];

/// A cell and how far its count is from the expected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Column and row.
    pub cell: [usize; 2],
    /// Count observed.
    pub observed: f64,
    /// Count expected.
    pub expected: f64,
    /// (observed − expected)/√expected; infinite where a count is that cannot be.
    pub deviations: f64,
}

/// The cells of a picture by the size of their residuals, the largest first, at most `most`; none for pictures without cells.
#[must_use]
pub fn worst_cells(picture: &Picture, most: usize) -> Vec<Residual> {
    let Picture::Cells { shape, observed, expected, .. } = picture else { return Vec::new() };
    let residual = |(place, (&observed, &expected)): (usize, (&f64, &f64))| Residual {
        cell: [place % shape[0], place / shape[0]],
        observed,
        expected,
        deviations: deviations(observed, expected),
    };
    let mut cells: Vec<Residual> = observed.iter().zip(expected).enumerate().map(residual).collect();
    cells.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    cells.truncate(most);
    cells
}

fn deviations(observed: f64, expected: f64) -> f64 {
    if observed == expected { 0.0 } else { (observed - expected) / expected.sqrt() }
}

/// Draws the first picture of cells of a test as an SVG file's text.
///
/// * `title`: what was tested; `command`: how to repeat it.
///
/// Returns: `None` if the evidence has no picture of cells.
#[must_use]
pub fn svg(title: &str, command: &str, evidence: &Evidence) -> Option<String> {
    let picture = evidence.pictures.iter().find(|picture| matches!(picture, Picture::Cells { .. }))?;
    let Picture::Cells { shape, axes, observed, expected } = picture else { return None };
    let top = observed.iter().chain(expected).fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
    let residuals: Vec<f64> = observed.iter().zip(expected).map(|(o, e)| deviations(*o, *e)).collect();
    let count = |value: &f64| colour(&SEQUENTIAL, value / top);
    let residual = |value: &f64| colour(&DIVERGING, 0.5 + 0.5 * value / SATURATION);
    let maps = [
        (format!("observed, 0 to {top} a cell"), observed.iter().map(count).collect::<Vec<_>>()),
        (String::from("expected, the same scale"), expected.iter().map(count).collect()),
        (format!("residual, −{SATURATION} to +{SATURATION} σ"), residuals.iter().map(residual).collect()),
    ];
    let worst = worst_cells(picture, WORST);
    let width = 3.0 * SIDE + 4.0 * GAP;
    let height = SIDE + 3.0 * GAP + LINE * (worst.len() as f64 + 8.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut line = Lines { text: &mut text, y: GAP };
    line.add(title);
    line.add(&format!("p {:.2e}, n {}", evidence.p_value, evidence.n));
    line.add(&evidence.method);
    let maps_top = line.y + LINE;
    for (place, (name, colours)) in maps.iter().enumerate() {
        let x = GAP + place as f64 * (SIDE + GAP);
        map(line.text, [x, maps_top], *shape, colours);
        line.label([x, maps_top - 5.0], name);
    }
    line.y = maps_top + SIDE + LINE;
    let [x_axis, y_axis] = axes;
    line.add(&format!("across: {x_axis}; upwards: {y_axis}; {} × {} cells. The worst:", shape[0], shape[1]));
    for Residual { cell, observed, expected, deviations } in worst {
        let [column, row] = cell;
        line.add(&format!(
            "column {column}, row {row}: observed {observed}, expected {expected:.1}, residual {deviations:+.2} σ"
        ));
    }
    line.add(&format!("repeat with: {command}"));
    text += "</svg>\n";
    Some(text)
}

/// Text that is written line by line.
struct Lines<'a> {
    text: &'a mut String,
    y: f64,
}

impl Lines<'_> {
    fn add(&mut self, words: &str) {
        self.label([GAP, self.y], words);
        self.y += LINE;
    }

    fn label(&mut self, [x, y]: [f64; 2], words: &str) {
        let words = words.replace('&', "&amp;").replace('<', "&lt;");
        *self.text += &format!("<text x=\"{x}\" y=\"{y}\">{words}</text>\n");
    }
}

/// Rectangles of the cells, the first row at the bottom.
fn map(text: &mut String, [left, top]: [f64; 2], [columns, rows]: [usize; 2], colours: &[[f64; 3]]) {
    let (w, h) = (SIDE / columns as f64, SIDE / rows as f64);
    *text += "<g shape-rendering=\"crispEdges\">\n";
    for (place, [r, g, b]) in colours.iter().enumerate() {
        let (x, y) = (left + (place % columns) as f64 * w, top + (rows - 1 - place / columns) as f64 * h);
        // Writing to a string never fails.
        let _ = writeln!(
            text,
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\" fill=\"rgb({r:.0},{g:.0},{b:.0})\"/>"
        );
    }
    *text += "</g>\n";
}

/// The colour at a place of a scale, 0 to 1; what lies outside takes the colour of the nearer end.
fn colour(scale: &[[f64; 3]; 3], at: f64) -> [f64; 3] {
    let along = 2.0 * at.clamp(0.0, 1.0);
    let (from, t) = if along < 1.0 { (0, along) } else { (1, along - 1.0) };
    std::array::from_fn(|i| scale[from][i] * (1.0 - t) + scale[from + 1][i] * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::Resolution;

    fn evidence(pictures: Vec<Picture>) -> Evidence {
        Evidence {
            method: String::from("chi-square <test>"),
            n: 303,
            statistic: 18.0,
            dof: Some(3.0),
            p_value: 4.4e-4,
            estimate: 0.2,
            interval: [0.1, 0.3],
            bound: 0.01,
            resolution: Resolution { quantity: "RMS relative error over cells", value: 0.25, power: 0.9 },
            doubts: Vec::new(),
            pictures,
        }
    }

    fn cells() -> Picture {
        let (observed, expected) = (vec![100.0, 130.0, 70.0, 3.0], vec![100.0, 100.0, 100.0, 0.0]);
        Picture::Cells { shape: [2, 2], axes: ["r²", "φ"], observed, expected }
    }

    #[test]
    fn the_picture_names_its_worst_cells_and_its_command() {
        let text = svg("my disk", "cargo test my_disk", &evidence(vec![cells()])).expect("there are cells");
        for part in [
            "my disk",
            "&lt;test>",
            "repeat with: cargo test my_disk",
            "column 1, row 1: observed 3, expected 0.0, residual +inf",
            "column 1, row 0: observed 130, expected 100.0, residual +3.00",
        ] {
            assert!(text.contains(part), "{part} is missing");
        }
        assert_eq!(text.matches("<rect").count(), 1 + 3 * 4);
        // The fullest cell has the last colour of the scale, an empty one the first; both are there once.
        for [r, g, b] in [SEQUENTIAL[2], SEQUENTIAL[0]] {
            assert_eq!(text.matches(&format!("fill=\"rgb({r:.0},{g:.0},{b:.0})\"")).count(), 1, "{text}");
        }
        assert_eq!(svg("", "", &evidence(Vec::new())), None);
    }

    #[test]
    fn all_of_the_picture_is_in_its_frame() {
        let text = svg("my disk", "cargo test my_disk", &evidence(vec![cells()])).expect("there are cells");
        let value = |element: &str, name: &str| -> f64 {
            let (_, rest) = element.split_once(&format!(" {name}=\"")).expect("the element has it");
            rest.split('"').next().and_then(|number| number.parse().ok()).expect("it is a number")
        };
        let mut elements =
            text.split('<').filter(|element| element.contains("width=") || element.contains(" y="));
        let frame = elements.next().expect("the svg comes first");
        let [width, height] = ["width", "height"].map(|name| value(frame, name));
        for element in elements.filter(|element| element.contains(" y=")) {
            let is_cell = element.starts_with("rect");
            let [w, h] = ["width", "height"].map(|name| if is_cell { value(element, name) } else { 0.0 });
            let (x, y) = (value(element, "x"), value(element, "y"));
            // Numbers are written to a hundredth of a pixel.
            assert!(x >= 0.0 && y >= 0.0 && x + w <= width + 0.01 && y + h <= height + 0.01, "{element}");
        }
    }

    #[test]
    fn scales_have_their_ends_and_middle() {
        assert_eq!(colour(&DIVERGING, 0.5), DIVERGING[1]);
        assert_eq!((colour(&SEQUENTIAL, -1.0), colour(&SEQUENTIAL, 7.0)), (SEQUENTIAL[0], SEQUENTIAL[2]));
    }
}
