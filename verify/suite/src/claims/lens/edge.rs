//! Depth of field at edges: the blur is the share of a disk of confusion that the edge cuts off.

use glam::DVec3;
use renderer::camera::{FovAxis, Projection};
use renderer::film::FilmSettings;
use renderer::scene::{IntegratorSettings, ObjectSettings, SceneDescription};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, Level};
use verify::filter::Kernel;
use verify::lens::{circle_of_confusion, edge_spread_over_pixel};

use super::super::film::{Exact, Films};
use crate::bounds;
use crate::setup::{fixed, lamp, look, pixel_middles, rectangle_at, spot};

/// Distance of the plane in focus, on which a pixel is 1 wide.
pub(super) const FOCUS: f64 = 20.0;

/// Pixels of a row.
const ROW: [u32; 2] = [12, 1];

/// Where edges are seen, in pixels from the middle.
const EDGE: f64 = 0.3;

/// A camera at the origin that looks along −z with +x to the right, a lens, and the focus at [`FOCUS`].
pub(super) fn lens_view(size: [u32; 2], lens_radius: f64, objects: Vec<ObjectSettings>) -> SceneDescription {
    let emission = IntegratorSettings { max_depth: Some(1), ..IntegratorSettings::DIRECT };
    let mut description = spot(DVec3::ZERO, -DVec3::Z, objects, emission);
    description.film = FilmSettings { width: size[0], height: size[1], ..description.film };
    let fov = 2.0 * (0.5 * f64::from(size[0]) / FOCUS).atan().to_degrees();
    description.camera.projection =
        Projection::Perspective { fov, axis: FovAxis::X, lens_radius, focus_distance: FOCUS };
    description.camera.to_world = fixed(look(DVec3::ZERO, -DVec3::Z, DVec3::Y));
    description
}

/// A lens's radius, the depth of an edge, and where it is seen.
#[derive(Clone, Copy)]
struct Blur {
    aperture: f64,
    depth: f64,
}

/// A row that sees the edge of a half-plane, bright to the left.
fn row(blur: Blur) -> SceneDescription {
    let x = EDGE * blur.depth / FOCUS;
    let middle = DVec3::new(x - 1e3, 0.0, -blur.depth);
    let half_plane = rectangle_at(middle, 1e3 * DVec3::X, 1e3 * DVec3::Y);
    lens_view(ROW, blur.aperture, vec![lamp(ShapeSettings::Rectangle, half_plane)])
}

/// Radii of the lens and depths of the edge: nearer than the focus, far beyond it, and a little beyond.
const BLURS: [Blur; 3] = [
    Blur { aperture: 2.0, depth: 10.0 },
    Blur { aperture: 3.0, depth: 100.0 },
    Blur { aperture: 5.0, depth: 23.0 },
];

pub(super) fn claims() -> Vec<Claim> {
    vec![
        spread("lens/edge/spread", (Level::Standard, 4096)),
        spread("lens/edge/quick", (Level::Quick, 64)),
        in_focus(),
    ]
}

fn spread(id: &'static str, (level, samples): (Level, u32)) -> Claim {
    let exact = |Blur { aperture, depth }: Blur| {
        let radius = circle_of_confusion(aperture, FOCUS, depth);
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| p[0]).collect();
        let value = |x: f64| edge_spread_over_pixel((EDGE - x - 0.5) / radius, (EDGE - x + 0.5) / radius);
        Exact::on_curve(["pixel, from the middle", "radiance"], &positions, value)
    };
    // Few samples see only a large mistake.
    let far = match level {
        Level::Quick => ("edges half as far again", [1.0, 1.5]),
        Level::Standard | Level::Exhaustive => ("edges 5 % too far", [1.0, 1.05]),
    };
    Films {
        id: String::from(id),
        says: String::from(
            "edges out of focus show the integral of the edge spread function of a uniform disk of confusion",
        ),
        level,
        samples,
        unit: 1.0,
        bound: if level == Level::Quick { bounds::PIXEL_QUICK } else { bounds::PIXEL },
        right: [1.0, 1.0],
        wrong: vec![("a diameter taken for a radius", [2.0, 1.0]), far],
    }
    .claim(
        |[aperture, depth]| {
            let wrong = |b: Blur| Blur { aperture: aperture * b.aperture, depth: depth * b.depth };
            BLURS.map(wrong).map(row).into()
        },
        move || BLURS.map(exact).into(),
    )
}

/// Radii of lenses that see the plane in focus alike.
const APERTURES: [f64; 3] = [0.0, 1.0, 4.0];

fn in_focus() -> Claim {
    let exact = || {
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| p[0]).collect();
        let pixel = Kernel::Box { radius: 0.5 };
        Exact::on_curve(["pixel, from the middle", "radiance"], &positions, |x| pixel.edge(EDGE - x, 0.0))
    };
    Films {
        id: String::from("lens/focus/any-aperture"),
        says: String::from(
            "an edge in the plane in focus is as sharp through a lens of any radius as through a pinhole",
        ),
        level: Level::Standard,
        samples: 512,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: FOCUS,
        wrong: vec![("30 % behind the focus", 1.3 * FOCUS), ("half the distance of the focus", 0.5 * FOCUS)],
    }
    .claim(
        |depth| APERTURES.map(|aperture| row(Blur { aperture, depth })).into(),
        move || APERTURES.map(|_| exact()).into(),
    )
}
