//! The scenes: each the simplest one that shows its effect.

use std::f64::consts::{FRAC_1_PI, PI};

use verify::coverage::{circle_in_rectangle, lens_area};
use verify::filter::Kernel;
use verify::fresnel::reflectance;
use verify::irradiance::{
    Receiver, behind_half_plane, from_parallel_disk, from_parallel_rectangle, from_sphere, furnace_radiance,
};
use verify::lens::{circle_of_confusion, edge_spread_over_pixel};
use verify::motion::moving_edge;
use verify::quadrature::{Tolerance, integrate_2d};
use verify::shadow::behind_ball;

use super::Analytic;
use super::xml::{
    BOX, Surface, document, from_above, pinhole, rectangle, shape, sphere, thin_lens, with_body,
};

/// Every scene.
pub fn all() -> Vec<Analytic> {
    vec![
        edge("edge-tent", 0.4, Kernel::Tent { radius: 1.0 }, r#"<rfilter type="tent"/>"#),
        edge("edge-box", 1.1, Kernel::Box { radius: 0.5 }, r#"<rfilter type="box"/>"#),
        zone_plate(),
        lit_by_rectangle(),
        lit_by_sphere(),
        penumbra(),
        ball_shadow(),
        defocused_edge(),
        defocused_disk(),
        moving(),
        furnace(),
        fresnel(),
    ]
}

/// The mean of a function over the square pixel around `middle`, its side 1, to a thousandth of the claims' bound.
fn over_pixel([x, y]: [f64; 2], f: impl Fn([f64; 2]) -> f64) -> f64 {
    let tolerance = Tolerance { relative: 0.0, absolute: 2e-6, pieces: 4000 };
    integrate_2d(&f, [[x - 0.5, x + 0.5], [y - 0.5, y + 0.5]], tolerance).value
}

fn edge(name: &'static str, angle: f64, kernel: Kernel, filter: &str) -> Analytic {
    let (size, distance) = ([16, 16], 0.3);
    let says = "A half-plane of radiance 1, whose edge leans, through a pixel filter";
    let degrees = angle.to_degrees();
    let steps = format!(
        r#"<scale value="100"/><translate x="{}"/><rotate z="1" angle="{degrees}"/>"#,
        distance - 100.0
    );
    let content = shape("rectangle", Surface::Lamp, &steps);
    let xml = document(says, 1, (&from_above(10.0, 1.0, size[0]), filter), size, &content);
    let exact = move |[x, y]: [f64; 2]| kernel.edge(distance - x * angle.cos() - y * angle.sin(), angle);
    Analytic { name, says, xml, size, exact: Box::new(exact), scale: 1.0, mitsuba: true }
}

fn zone_plate() -> Analytic {
    const RINGS: u32 = 19;
    let size = [12, 12];
    let says = "Rings of radiance 1 and 0 about the lower left corner, the n-th ending at the radius 4√n";
    let radius = |n: u32| 4.0 * f64::from(n).sqrt();
    let disk = |n: u32| {
        let (r, z) = (radius(n), -0.01 * f64::from(n));
        let steps = format!(r#"<scale x="{r}" y="{r}"/><translate x="-6" y="-6" z="{z}"/>"#);
        shape("disk", if n % 2 == 1 { Surface::Lamp } else { Surface::Diffuse(0.0) }, &steps)
    };
    let content: String = (1..=RINGS).map(disk).collect();
    let xml = document(says, 1, (&from_above(10.0, 1.0, size[0]), BOX), size, &content);
    let exact = move |[x, y]: [f64; 2]| {
        let pixel = [[x + 5.5, x + 6.5], [y + 5.5, y + 6.5]];
        let sign = |n: u32| if n % 2 == 1 { 1.0 } else { -1.0 };
        (1..=RINGS).map(|n| sign(n) * circle_in_rectangle(radius(n), pixel)).sum()
    };
    Analytic { name: "zone-plate", says, xml, size, exact: Box::new(exact), scale: 1.0, mitsuba: true }
}

/// A white floor z = 0 seen from the height `eye`, below `content`; the radiance is the irradiance over π.
fn floor(
    (name, says): (&'static str, &'static str),
    (eye, pixel, size): (f64, f64, [u32; 2]),
    content: &str,
    irradiance: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    brightest: f64,
) -> Analytic {
    let floor = rectangle([100.0, 100.0], [0.0; 3], false, Surface::Diffuse(1.0));
    let xml = document(says, 2, (&from_above(eye, pixel, size[0]), BOX), size, &(floor + content));
    let exact = move |middle| FRAC_1_PI * over_pixel(middle, |p: [f64; 2]| irradiance(p.map(|c| pixel * c)));
    Analytic { name, says, xml, size, exact: Box::new(exact), scale: FRAC_1_PI * brightest, mitsuba: true }
}

fn lit_by_rectangle() -> Analytic {
    let content = rectangle([1.5, 1.0], [0.7, 0.4, 3.0], true, Surface::Lamp);
    let light = |[x, y]: [f64; 2]| from_parallel_rectangle([-0.8 - x, 2.2 - x], [-0.6 - y, 1.4 - y], 3.0);
    let says = "A white floor under a rectangle of radiance 1";
    floor(("lit-by-rectangle", says), (1.0, 0.5, [16, 16]), &content, light, light([0.7, 0.4]))
}

fn lit_by_sphere() -> Analytic {
    let centre = [0.5, -0.3, 2.5];
    let content = sphere(centre, 0.8, Surface::Lamp);
    let light = move |[x, y]: [f64; 2]| {
        from_sphere(Receiver { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0] }, centre, 0.8)
    };
    let says = "A white floor under a sphere of radiance 1";
    floor(("lit-by-sphere", says), (1.0, 0.5, [16, 16]), &content, light, light([0.5, -0.3]))
}

fn penumbra() -> Analytic {
    let content = rectangle([3.0, 2.0], [0.0, 0.0, 8.0], true, Surface::Lamp)
        + &rectangle([50.0, 50.0], [0.11 - 50.0, 0.0, 4.0], false, Surface::Diffuse(0.0));
    let ranges = [[-3.0, 3.0], [-2.0, 2.0]];
    let light = move |at| behind_half_plane(ranges, [4.0, 8.0], 0.11, at);
    let open = behind_half_plane(ranges, [4.0, 8.0], -99.0, [0.0; 2]);
    let says = "A white floor under a rectangle of radiance 1, half hidden by a half-plane";
    floor(("penumbra", says), (2.0, 0.6, [16, 16]), &content, light, open)
}

fn ball_shadow() -> Analytic {
    let light = r#"<scale value="3"/><rotate x="1" angle="180"/><translate z="8"/>"#;
    let content = shape("disk", Surface::Lamp, light) + &sphere([0.0, 0.0, 3.5], 0.7, Surface::Diffuse(0.0));
    let seen = |[x, y]: [f64; 2]| {
        behind_ball([3.0, 8.0], [0.7, 3.5], x.hypot(y))
            .expect("near the axis the ball is seen before the light")
    };
    let says = "A white floor under a disk of radiance 1, a black ball before it";
    floor(("ball-shadow", says), (2.0, 0.15, [8, 8]), &content, seen, from_parallel_disk(3.0, 8.0, 0.0))
}

fn defocused_edge() -> Analytic {
    let (size, depth) = ([16, 4], 10.0);
    let says = "A half-plane of radiance 1 at half the distance in focus, through a lens of radius 2";
    let content = rectangle([100.0, 100.0], [0.15 - 100.0, 0.0, -depth], false, Surface::Lamp);
    let xml = document(says, 1, (&thin_lens(2.0, 20.0, size[0]), BOX), size, &content);
    let radius = circle_of_confusion(2.0, 20.0, depth);
    let exact = move |[x, _]: [f64; 2]| edge_spread_over_pixel((-0.2 - x) / radius, (0.8 - x) / radius);
    Analytic { name: "defocused-edge", says, xml, size, exact: Box::new(exact), scale: 1.0, mitsuba: true }
}

fn defocused_disk() -> Analytic {
    let size = [7, 7];
    let says = "A disk of radiance 1 before the plane in focus, through a lens of radius 9";
    let steps = r#"<scale x="0.88" y="0.88"/><translate x="0.08" y="-0.04" z="-16"/>"#;
    let content = shape("disk", Surface::Lamp, steps);
    let xml = document(says, 1, (&thin_lens(9.0, 20.0, size[0]), BOX), size, &content);
    let confusion = circle_of_confusion(9.0, 20.0, 16.0);
    let share = move |[x, y]: [f64; 2]| {
        lens_area(confusion, 1.1, (x - 0.1).hypot(y + 0.05)) / (PI * confusion * confusion)
    };
    let exact = Box::new(move |middle| over_pixel(middle, share));
    Analytic { name: "defocused-disk", says, xml, size, exact, scale: 1.0, mitsuba: true }
}

fn moving() -> Analytic {
    let size = [16, 4];
    let says = "A half-plane of radiance 1 that moves 3.3 pixels to the right while the shutter is open";
    let at = |time: u32, x: f64| {
        format!(r#"<transform time="{time}"><scale value="100"/><translate x="{}"/></transform>"#, x - 100.0)
    };
    let body = format!("    <animation name=\"to_world\">{}{}</animation>\n", at(0, -1.7), at(1, 1.6));
    let shutter =
        "    <float name=\"shutter_open\" value=\"0\"/>\n    <float name=\"shutter_close\" value=\"1\"/>\n";
    let sensor = from_above(10.0, 1.0, size[0]) + shutter;
    let xml = document(says, 1, (&sensor, BOX), size, &with_body("rectangle", Surface::Lamp, &body));
    let exact = Box::new(|[x, _]: [f64; 2]| moving_edge(-1.7 - (x - 0.5), 3.3));
    Analytic { name: "moving-edge", says, xml, size, exact, scale: 1.0, mitsuba: false }
}

fn furnace() -> Analytic {
    let size = [4, 4];
    let says = "The inside of a box that emits 1 and reflects half, in paths of at most 6 edges";
    let content = r#"  <shape type="cube">
    <transform name="to_world"><scale value="2"/></transform>
    <boolean name="flip_normals" value="true"/>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf>
    <emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter>
  </shape>
"#;
    let sensor = pinhole(60.0, r#"origin="0.3, 0.2, -0.5" target="1, 1, 1" up="0, 1, 0""#);
    let xml = document(says, 6, (&sensor, BOX), size, content);
    let exact = Box::new(|_: [f64; 2]| furnace_radiance(1.0, 0.5, Some(5)));
    Analytic { name: "furnace", says, xml, size, exact, scale: 2.0, mitsuba: true }
}

fn fresnel() -> Analytic {
    let (size, fov) = ([32, 4], 80.0_f64);
    let says =
        "Glass of index 1.5 over a black floor under a sky of radiance 1: its reflectance from 5° to 85°";
    let content = r#"  <shape type="rectangle">
    <transform name="to_world"><scale x="1000" y="1000"/></transform>
    <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>
  </shape>
  <emitter type="constant"><rgb name="radiance" value="1, 1, 1"/></emitter>
"#;
    let black = rectangle([2000.0, 2000.0], [0.0, 0.0, -1.0], false, Surface::Diffuse(0.0));
    // Down at 45°, with the image's right, view × up = (0, −1, −1)/√2, towards the point below the eye.
    let sensor = pinhole(fov, r#"origin="0, 0, 1" target="0, 1, 0" up="1, 0, 0""#);
    let xml = document(says, 3, (&sensor, BOX), size, &(content.to_owned() + &black));
    let half = (0.5 * fov).to_radians().tan() / (0.5 * f64::from(size[0]));
    let exact = move |middle| {
        over_pixel(middle, |[x, y]: [f64; 2]| {
            let (x, y) = (half * x, half * y);
            let down = (1.0 + x) * std::f64::consts::FRAC_1_SQRT_2;
            reflectance(down / (1.0 + x * x + y * y).sqrt(), 1.5)
        })
    };
    Analytic { name: "fresnel", says, xml, size, exact: Box::new(exact), scale: 1.0, mitsuba: true }
}
