//! The irradiance meter: how scene files ask for it, and a sky whose irradiance is known.

mod folder;

use renderer::camera::Projection;
use renderer::integrator::PathTracer;
use renderer::render::{RenderSettings, render};
use renderer::sampling::SamplerKind;
use renderer::scene::{Effect, Scene, SceneDescription};

use folder::Folder;

const METER: &str = r#"<sensor type="irradiancemeter"><film type="hdrfilm"><integer name="width" value="3"/>
<integer name="height" value="2"/><rfilter type="box"/></film></sensor>"#;

/// A folder with the scene of `body`.
fn with(body: &str) -> Folder {
    Folder::new(&[("s.xml", &format!("<scene version=\"3.0.0\">\n{body}\n</scene>"))])
}

/// The scene of `body`.
fn read(body: &str) -> SceneDescription {
    with(body).read(&[]).unwrap().0
}

#[test]
fn a_meter_under_an_even_sky_measures_pi_times_its_radiance() {
    for shape in ["rectangle", "disk", "sphere"] {
        let sky = r#"<emitter type="constant"><rgb name="radiance" value="0.5, 1, 2"/></emitter>"#;
        let body = format!(
            r#"<shape type="{shape}"><transform name="to_world"><translate x="5"/></transform>{METER}</shape>
            {sky}<integrator type="direct"/>"#
        );
        let description = read(&body);
        assert!(matches!(description.camera.projection, Projection::IrradianceMeter { .. }));
        let scene = Scene::new(&description).unwrap();
        assert!(scene.effects.contains(Effect::Lens));
        let settings =
            RenderSettings { sampler: SamplerKind::Sobol, samples: 64, replicates: 1, seed: 0, threads: 1 };
        let image = render(&scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ()).unwrap();
        assert_eq!((image.width, image.height), (3, 2));
        for pixel in image.pixels {
            for (value, radiance) in pixel.mean.into_iter().zip([0.5, 1.0, 2.0]) {
                let exact = std::f64::consts::PI * radiance;
                assert!((value / exact - 1.0).abs() < 1e-7, "{shape}: {value}"); // π in f32, and one product
            }
        }
    }
}

#[test]
fn what_a_meter_cannot_be_is_refused_by_name() {
    let wide = METER.replace("box", "gaussian");
    let turned = METER.replace("<film", r#"<transform name="to_world"><translate x="1"/></transform><film"#);
    let camera = r#"<sensor type="perspective"><float name="fov" value="40"/></sensor>"#;
    for (body, message) in [
        (format!(r#"<shape type="disk">{wide}</shape>"#), "the rfilter 'box' is accepted"),
        (format!(r#"<shape type="disk">{turned}</shape>"#), "'to_world'"),
        (format!(r#"{camera}<shape type="disk">{METER}</shape>"#), "a second <sensor>; one is accepted"),
        (
            format!(r#"<shape type="disk">{METER}</shape><shape type="disk">{METER}</shape>"#),
            "a second <sensor>",
        ),
        (format!(r#"<shape type="disk">{camera}</shape>"#), "sensor plugin 'perspective'"),
        (
            format!(r#"{camera}<shape type="shapegroup"><shape type="disk">{METER}</shape></shape>"#),
            "a sensor in a shapegroup",
        ),
    ] {
        let refused = with(&body).refused();
        assert!(refused.contains(message), "{refused}");
    }
}

#[test]
fn the_directions_of_a_meter_cannot_be_left_out() {
    let mut description = read(&format!(r#"<shape type="disk">{METER}</shape>"#));
    let refused = description.leave_out(Effect::Lens).expect_err("a meter without directions").to_string();
    assert!(refused.contains("irradiancemeter"), "{refused}");
}
