//! Scene files: what they mean, and (`refusals`) what is refused with which message.

#[path = "../folder/mod.rs"]
mod folder;
mod refusals;

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use renderer::camera::{FovAxis, Projection};
use renderer::film::{Crop, Filter};
use renderer::io::read_scene;
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::sampling::SamplerKind;
use renderer::scene::{Branch, LightSettings, Scene, SceneDescription};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;

use folder::Folder;

/// A scene with a sensor, and `body` from line 3 on.
fn with_sensor(body: &str) -> String {
    let sensor = r#"<sensor type="perspective"><float name="fov" value="40"/></sensor>"#;
    format!("<scene version=\"3.0.0\">\n{sensor}\n{body}\n</scene>")
}

fn read(body: &str) -> (SceneDescription, Vec<String>) {
    Folder::new(&[("s.xml", &with_sensor(body))]).read(&[]).unwrap()
}

fn refused(body: &str) -> String {
    Folder::new(&[("s.xml", &with_sensor(body)), ("empty.obj", "# nothing\n"), ("bad.obj", "v 0 0 nan\n")])
        .refused()
}

fn expect_parts(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
    assert!(!message.contains('\n'), "one line: {message}");
}

#[test]
fn parameters_come_from_overrides_then_from_the_first_default() {
    let text = with_sensor(
        r#"<default name="r" value="2"/><default name="r" value="9"/><default name="ra" value="5"/>
        <shape type="sphere"><float name="radius" value="$r"/></shape><shape type="sphere"><float name="radius" value="0.$ra"/></shape>"#,
    );
    let folder = Folder::new(&[("s.xml", &text)]);
    let radii = |overrides: &[(&str, &str)]| {
        let (scene, _) = folder.read(overrides).unwrap();
        let radius = |shape: &ShapeSettings| match shape {
            ShapeSettings::Sphere { radius, .. } => *radius,
            other => panic!("a sphere, not {other:?}"),
        };
        scene.objects.iter().map(|o| radius(&o.shape)).collect::<Vec<_>>()
    };
    assert_eq!(radii(&[]), [2.0, 0.5]);
    assert_eq!(radii(&[("r", "3"), ("ra", "25")]), [3.0, 0.25]);
    let unknown = folder.read(&[("q", "1")]).unwrap_err().to_string();
    expect_parts(&unknown, &["s.xml: -Dq: the scene has no parameter 'q'; r, ra are accepted"]);
    let wrong = folder.read(&[("r", "x")]).unwrap_err().to_string();
    expect_parts(&wrong, &["s.xml:4:51: value is 'x'; a finite number is accepted"]);
    expect_parts(
        &refused(r#"<shape type="sphere"><float name="radius" value="$no"/></shape>"#),
        &["s.xml:3:43: parameter $no has no value"],
    );
}

#[test]
fn includes_aliases_and_later_ids_are_resolved() {
    let main = with_sensor(
        "<include filename=\"part.xml\"/>\n<alias id=\"m\" as=\"n\"/>\n<emitter type=\"area\" id=\"late\"><rgb name=\"radiance\" value=\"1, 2, 3\"/></emitter>",
    );
    let part = r#"<scene version="3.0.0"><bsdf type="conductor" id="m"/><shape type="sphere"><ref id="n"/><ref id="late"/></shape></scene>"#;
    let (scene, notes) = Folder::new(&[("s.xml", &main), ("part.xml", part)]).read(&[]).unwrap();
    assert_eq!(scene.objects[0].radiance, Rgb::new(1.0, 2.0, 3.0).into());
    assert!(matches!(*scene.objects[0].material, Material::Mirror(_)));
    assert_eq!(notes, ["the scene has no <integrator>: paths of any length are followed"]);
    assert!(scene.lights.is_empty());
}

#[test]
fn radiance_may_be_a_texture() {
    let light = |color: &str| {
        format!(
            "<shape type=\"rectangle\"><emitter type=\"area\"><texture name=\"radiance\" type=\"checkerboard\">\n{color}</texture></emitter></shape>"
        )
    };
    let (scene, _) = read(&light(r#"<rgb name="color1" value="3, 2, 1"/>"#));
    let radiance = [[0.1, 0.1], [0.9, 0.1]].map(|uv| scene.objects[0].radiance.eval(uv));
    assert_eq!(radiance, [Rgb::splat(0.4), Rgb::new(3.0, 2.0, 1.0)]);
    let negative = refused(&light(r#"<rgb name="color1" value="3, 2, -1"/>"#));
    expect_parts(&negative, &["s.xml:3:", "'radiance' has a negative channel; 0 or more is accepted"]);
}

#[test]
fn srgb_is_one_colour_as_a_texture_and_as_a_spectrum() {
    let scene = |tag: &str, color: &str| {
        let value = |name: &str| format!(r#"<{tag} type="srgb" name="{name}">{color}</{tag}>"#);
        let (reflectance, radiance) = (value("reflectance"), value("radiance"));
        format!(
            r#"<shape type="sphere"><bsdf type="diffuse">{reflectance}</bsdf><emitter type="area">{radiance}</emitter></shape>"#
        )
    };
    let color = r#"<rgb name="color" value="0.5, 0.25, 1"/>"#;
    let bright = r#"<rgb name="color" value="3, 0, 1"/>"#;
    for tag in ["texture", "spectrum"] {
        let object = &read(&scene(tag, color)).0.objects[0];
        let expected = Texture::from(Rgb::new(0.5, 0.25, 1.0));
        assert_eq!(object.radiance, expected);
        assert_eq!(*object.material, Material::new_diffuse(expected).unwrap());
        expect_parts(
            &refused(&scene(tag, bright)),
            &["s.xml:3:", "'color' has a channel outside 0 to 1; beside 'unbounded' true"],
        );
        expect_parts(&refused(&scene(tag, "")), &[&format!("{tag} srgb has no 'color'; it must be given")]);
        let unbounded = format!(r#"{bright}<boolean name="unbounded" value="true"/>"#);
        let light = format!(
            r#"<shape type="sphere"><emitter type="area"><{tag} type="srgb" name="radiance">{unbounded}</{tag}></emitter></shape>"#
        );
        assert_eq!(read(&light).0.objects[0].radiance, Texture::from(Rgb::new(3.0, 0.0, 1.0)));
    }
    let regular = scene("spectrum", color).replace("srgb", "regular");
    expect_parts(&refused(&regular), &["spectrum plugin 'regular'", "srgb is accepted"]);
}

#[test]
fn transforms_compose_from_top_to_bottom() {
    let body = r#"<shape type="cube"><transform name="to_world"><scale value="2, 3, 4"/><rotate y="1" angle="90"/><translate x="1" z="5"/>
        <matrix value="1 0 0 10  0 1 0 0  0 0 1 0  0 0 0 1"/></transform></shape>"#;
    let (scene, _) = read(body);
    let at = scene.objects[0].to_world.at(0.0).transform_point3(DVec3::new(1.0, 1.0, 1.0));
    // (2, 3, 4) turns by 90° about y into (4, 3, −2) and moves by (11, 0, 5)
    assert!(at.distance(DVec3::new(15.0, 3.0, 3.0)) < 1e-14, "{at}"); // some roundings of numbers up to 15 in f64
    let look = r#"<shape type="cube"><transform name="to_world"><lookat origin="1,2,3" target="4 5 7" up="0,1,0"/></transform></shape>"#;
    let m = read(look).0.objects[0].to_world.at(0.0);
    // Mitsuba 3.9.1's matrix of this lookat, to six decimals
    let theirs = [[0.8, -0.308697, 0.514496], [0.0, 0.857493, 0.514496], [-0.6, -0.411597, 0.685994]];
    for (row, expected) in theirs.into_iter().enumerate() {
        for (column, expected) in expected.into_iter().enumerate() {
            assert!((m.matrix3.col(column)[row] - expected).abs() < 0.6e-6, "{row} {column}"); // half of the last decimal
        }
    }
    assert_eq!(m.translation, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn animations_have_keys_and_the_shutter_its_interval() {
    let body = r#"<shape type="sphere"><animation name="to_world"><transform time="0"><translate x="-1"/></transform>
        <transform time="2"><translate x="3"/></transform></animation></shape>"#;
    let motion = read(body).0.objects[0].to_world.clone();
    assert_eq!(motion.at(1.0), DAffine3::from_translation(DVec3::X));
    let falling = r#"<shape type="sphere"><animation name="to_world"><transform time="1"/><transform time="1"><translate x="1"/></transform></animation></shape>"#;
    expect_parts(&refused(falling), &["s.xml:3:22: to_world: key time is 1;"]);
    let sensor = "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/><float name='shutter_open' value='0.25'/><float name='shutter_close' value='CLOSE'/></sensor></scene>";
    let folder = |close: &str| Folder::new(&[("s.xml", &sensor.replace("CLOSE", close))]);
    let shutter = folder("0.75").read(&[]).unwrap().0.camera.shutter;
    assert_eq!((shutter.open, shutter.close), (0.25, 0.75));
    expect_parts(
        &folder("0").refused(),
        &["shutter_close is 0; a moment not before shutter_open is accepted"],
    );
}

#[test]
fn a_whole_scene_is_what_it_says() {
    let text = r#"<scene version="3.0.0">
        <integrator type="distribution"><integer name="max_depth" value="7"/><string name="branch" value="half"/></integrator>
        <sensor type="thinlens"><float name="fov" value="30"/><string name="fov_axis" value="y"/><float name="aperture_radius" value="0.1"/>
          <float name="focus_distance" value="5"/><float name="near_clip" value="1"/>
          <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="4"/><integer name="crop_offset_x" value="3"/><integer name="crop_width" value="5"/><rfilter type="mitchell"><float name="B" value="0.2"/></rfilter></film>
          <sampler type="ldsampler"><integer name="sample_count" value="32"/><integer name="seed" value="7"/></sampler></sensor>
        <shape type="rectangle"><emitter type="area"><spectrum name="radiance" value="400:0, 500:8, 600:15.6, 700:18.4"/></emitter></shape>
        <shape type="cylinder"><bsdf type="diffuse"><float name="reflectance" value="0.25"/></bsdf></shape>
        <emitter type="constant"><spectrum name="radiance" value="2"/></emitter>
        <emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="4"/></emitter></scene>"#;
    let (scene, notes) = Folder::new(&[("s.xml", text)]).read(&[]).unwrap();
    let lens = Projection::Perspective { fov: 30.0, axis: FovAxis::Y, lens_radius: 0.1, focus_distance: 5.0 };
    assert_eq!(scene.camera.projection, lens);
    assert_eq!((scene.film.width, scene.film.height), (8, 4));
    assert_eq!(scene.film.crop, Some(Crop { offset: [3, 0], size: [5, 4] }));
    assert_eq!(scene.film.filter, Filter::Mitchell { b: 0.2, c: 1.0 / 3.0 });
    assert_eq!((scene.sampler.kind, scene.sampler.spp, scene.sampler.seed), (SamplerKind::Sobol, 32, 7));
    assert_eq!((scene.integrator.max_depth, scene.integrator.branch), (Some(7), Branch::Half));
    let light = [20.710_836, 10.854_634, 2.771_152]; // references/spectra/cbox_rgb.csv, light_radiance
    for (a, b) in scene.objects[0].radiance.eval([0.0; 2]).to_array().into_iter().zip(light) {
        assert!((a - b).abs() < 1e-5 * b, "{a} against {b}"); // the bound asked of the conversion
    }
    assert_eq!(*scene.objects[0].material, Material::new_diffuse(Texture::from(Rgb::BLACK)).unwrap());
    assert_eq!(*scene.objects[1].material, Material::new_diffuse(Texture::from(Rgb::splat(0.25))).unwrap());
    assert!(matches!(scene.lights[0], LightSettings::Constant { radiance } if radiance.r > 2.0 * 1.2));
    let point = LightSettings::Point { position: DVec3::new(1.0, 2.0, 3.0), intensity: Rgb::splat(4.0) };
    assert_eq!(scene.lights[1], point);
    let noted = |parts: &[&str]| notes.iter().any(|note| parts.iter().all(|part| note.contains(part)));
    assert_eq!(notes.len(), 2);
    assert!(noted(&["s.xml:4:51: 'near_clip' has no effect: nothing is cut off"]), "{notes:?}");
    assert!(noted(&["'ldsampler' is read as 'sobol'"]), "{notes:?}");
}

fn sensor(plugin: &str, part: &str) -> Folder {
    let text = format!(r#"<scene version="3.0.0"><sensor type="{plugin}">{part}</sensor></scene>"#);
    Folder::new(&[("s.xml", &text)])
}

#[test]
fn a_focal_length_is_that_of_film_of_35_mm() {
    let length = |value: &str| format!(r#"<string name="focal_length" value="{value}"/>"#);
    // Mitsuba 3.9.1's x_fov of films of w × h pixels, f32
    for (part, [w, h], x_fov) in [
        (String::new(), [8.0, 6.0], 38.184_841_f64),
        (length("50mm"), [6.0, 8.0], 29.105_461),
        (length("35"), [8.0, 6.0], 52.622_543),
        (length("35 mm"), [8.0, 6.0], 52.622_543),
    ] {
        let Projection::Perspective { fov, axis, .. } =
            sensor("perspective", &part).read(&[]).unwrap().0.camera.projection
        else {
            panic!("a perspective camera");
        };
        assert_eq!(axis, FovAxis::Diagonal);
        let width = (fov / 2.0).to_radians().tan() * w / f64::hypot(w, h);
        let error = 2.0 * width.atan().to_degrees() - x_fov;
        assert!(error.abs() < 0.5e-6 + 64.0 * 2.0_f64.powi(-24), "{part}: {error}"); // the last decimal here, and their rounding to f32 below 64
    }
    for (part, message) in [
        (length("0mm"), "s.xml:1:79: 'focal_length' is '0mm'; a positive number of millimetres"),
        (length("35m"), "s.xml:1:79: 'focal_length' is '35m';"),
        (length("35mm") + r#"<float name="fov" value="40"/>"#, "s.xml:1:79: 'focal_length' beside 'fov';"),
        (r#"<string name="fov_axis" value="y"/>"#.into(), "s.xml:1:51: 'fov_axis' without 'fov';"),
    ] {
        expect_parts(&sensor("perspective", &part).refused(), &[message]);
    }
}

#[test]
fn lenses_focus_at_the_far_plane_unless_they_say_where() {
    let focus = |part: &str| {
        let radius = r#"<float name="aperture_radius" value="0.1"/>"#;
        let (scene, notes) = sensor("thinlens", &format!("{radius}{part}")).read(&[]).unwrap();
        match scene.camera.projection {
            Projection::Perspective { focus_distance, .. } => (focus_distance, notes.join("; ")),
            other => panic!("a lens, not {other:?}"),
        }
    };
    let (distance, notes) = focus("");
    assert_eq!(distance, 1e4);
    expect_parts(&notes, &["s.xml:1:24: no 'focus_distance': the lens focuses at 'far_clip', 10000"]);
    assert_eq!(focus(r#"<float name="far_clip" value="77"/>"#).0, 77.0);
    let (distance, notes) =
        focus(r#"<float name="far_clip" value="77"/><float name="focus_distance" value="3"/>"#);
    assert_eq!(distance, 3.0);
    expect_parts(&notes, &["'far_clip' has no effect"]);
}

#[test]
fn layers_and_microfacets_have_their_parameters() {
    let material = |bsdf: &str| {
        let (scene, notes) = read(&format!(r#"<shape type="sphere">{bsdf}</shape>"#));
        (Material::clone(&scene.objects[0].material), notes)
    };
    let kind = |bsdf: &str| {
        let (material, _) = material(bsdf);
        let debug = format!("{material:?}");
        debug.split(|c: char| !c.is_alphanumeric()).next().unwrap_or("").to_owned()
    };
    let mask = |opacity: &str| format!(r#"<bsdf type="mask">{opacity}<bsdf type="diffuse"/></bsdf>"#);
    let two = r#"<bsdf type="diffuse"/><bsdf type="plastic"/>"#;
    let blend = format!(r#"<bsdf type="blendbsdf"><float name="weight" value="0.25"/>{two}</bsdf>"#);
    assert_eq!(kind(r#"<bsdf type="roughdielectric"/>"#), "RoughDielectric");
    assert_eq!(kind(r#"<bsdf type="thindielectric"/>"#), "ThinDielectric");
    assert_eq!(kind(r#"<bsdf type="plastic"/>"#), "Plastic");
    assert_eq!(kind(r#"<bsdf type="roughplastic"/>"#), "RoughPlastic");
    assert_eq!(kind(&mask("")), "Mask");
    assert_eq!(kind(&blend), "Blend");
    // An effect at its null value is absent.
    assert_eq!(kind(&mask(r#"<float name="opacity" value="1"/>"#)), "Diffuse");
    assert_eq!(kind(r#"<bsdf type="roughdielectric"><float name="alpha" value="0"/></bsdf>"#), "Dielectric");
    let board =
        r#"<bsdf type="mask"><texture name="opacity" type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#;
    let (_, notes) = material(board);
    assert!(notes.iter().any(|n| n.contains("color0 and color1 are exchanged")), "{notes:?}");
    let alone = r#"<bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/></bsdf>"#;
    expect_parts(&refused(alone), &["s.xml:3:1: bsdf blendbsdf with other than two <bsdf>;"]);
    let brushed = r#"<bsdf type="roughplastic"><float name="alpha_u" value="0.1"/></bsdf>"#;
    expect_parts(&refused(brushed), &["unknown <float> 'alpha_u' in bsdf roughplastic;", "alpha"]);
}

#[test]
fn spots_and_environments_have_their_parameters() {
    let cone = r#"<emitter type="spot"><rgb name="intensity" value="1 2 3"/><float name="cutoff_angle" value="40"/>
        <transform name="to_world"><lookat origin="1,2,3" target="1,2,5" up="0,1,0"/></transform></emitter>"#;
    let (scene, _) = read(cone);
    let LightSettings::Spot { position, axis, intensity, angles } = &scene.lights[0] else {
        panic!("a spot, not {:?}", scene.lights)
    };
    assert_eq!((*position, *axis), (DVec3::new(1.0, 2.0, 3.0), DVec3::Z));
    assert_eq!((*intensity, *angles), (Rgb::new(1.0, 2.0, 3.0), [30.0, 40.0]));
    let wide = r#"<emitter type="spot"><float name="cutoff_angle" value="200"/></emitter>"#;
    expect_parts(
        &refused(wide),
        &["s.xml:3:22:", "cutoff_angle is 200; an angle in (0, 180] degrees is accepted"],
    );
    expect_parts(&refused(r#"<emitter type="envmap"/>"#), &["s.xml:3:1: emitter envmap has no 'filename'"]);
    expect_parts(&refused(r#"<emitter type="sunsky"/>"#), &["emitter plugin 'sunsky'", "envmap"]);
}

#[test]
fn the_hash_sees_files_and_overrides() {
    let text = with_sensor(
        r#"<default name="f" value="a.obj"/><shape type="obj"><string name="filename" value="$f"/></shape>"#,
    );
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let folder = Folder::new(&[("s.xml", &text), ("a.obj", triangle), ("b.obj", &format!("{triangle}\n"))]);
    let hash = |overrides: &[(&str, &str)]| folder.read(overrides).unwrap().0.hash;
    assert_eq!(hash(&[]), hash(&[]));
    assert_ne!(hash(&[]), hash(&[("f", "a.obj")]));
    assert_ne!(hash(&[("f", "a.obj")]), hash(&[("f", "b.obj")]));
}

fn references() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/scenes")
}

fn reference_scenes() -> Vec<PathBuf> {
    let files = fs::read_dir(references()).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "xml")).collect();
    scenes.sort();
    scenes
}

#[test]
fn every_reference_scene_loads_without_a_note_and_builds() {
    let scenes = reference_scenes();
    assert!(scenes.len() >= 7, "{scenes:?}");
    for path in scenes {
        let (scene, notes) = read_scene(&path, &[("res".into(), "4".into())]).unwrap();
        assert_eq!(notes, [""; 0], "{}", path.display());
        assert_eq!(scene.film.width, 4);
        Scene::new(&scene).unwrap();
    }
}

#[test]
fn instances_are_copies_of_their_group() {
    let group = r#"<shape type="shapegroup" id="pair"><shape type="sphere"><float name="radius" value="2"/></shape>
        <shape type="disk"><transform name="to_world"><translate z="3"/></transform></shape></shape>"#;
    let copy = |moved: &str| format!(r#"<shape type="instance"><ref id="pair"/>{moved}</shape>"#);
    let there = r#"<transform name="to_world"><scale value="2"/><translate x="1"/></transform>"#;
    let (scene, notes) = read(&format!("{group}{}{}", copy(""), copy(there)));
    assert_eq!(scene.objects.len(), 4, "a group alone shows nothing: {notes:?}");
    let at = |i: usize| scene.objects[i].to_world.at(0.0).transform_point3(DVec3::ZERO);
    let places = [DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0), DVec3::X, DVec3::new(1.0, 0.0, 6.0)];
    assert_eq!([0, 1, 2, 3].map(at), places);
    // A reflection would turn a sphere inside out; one of an instance does not, in Mitsuba 3.9.1
    let reflected = copy(r#"<transform name="to_world"><scale x="-1"/></transform>"#);
    let flipped: Vec<bool> =
        read(&format!("{group}{reflected}")).0.objects.iter().map(|o| o.flip_normals).collect();
    assert_eq!(flipped, [true, false]);
    let refuse = |body: &str, parts: &[&str]| expect_parts(&refused(body), parts);
    refuse(&copy(""), &["pair"]);
    refuse(r#"<shape type="instance"/>"#, &["an instance of nothing; one <shape> of type shapegroup"]);
    refuse(r#"<shape type="instance"><shape type="sphere"/></shape>"#, &["sphere", "shapegroup"]);
    let lamp = r#"<shape type="sphere"><emitter type="area"/></shape>"#;
    refuse(&format!(r#"<shape type="shapegroup">{lamp}</shape>"#), &["an emitter in a shapegroup"]);
    let nested = r#"<shape type="shapegroup"><shape type="instance"/></shape>"#;
    refuse(nested, &["instance", "sphere"]);
    let moving = r#"<animation name="to_world"><transform time="0"/><transform time="1"><rotate y="1" angle="90"/></transform></animation>"#;
    refuse(&format!("{group}{}", copy(moving)), &["a moving instance", "is accepted"]);
}

#[test]
fn two_sided_takes_a_material_for_each_side() {
    let grey = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf>"#;
    let sides = |inner: &str| format!(r#"<shape type="sphere"><bsdf type="twosided">{inner}</bsdf></shape>"#);
    let (scene, _) = read(&sides(&format!("{grey}{}", r#"<bsdf type="conductor"/>"#)));
    let bsdf = scene.objects[0].material.bsdf([0.0; 2]);
    let up = DVec3::Z.as_vec3();
    assert!(!bsdf.eval(up, up).is_black() && bsdf.eval(-up, -up).is_black());
    expect_parts(&refused(&sides("")), &["other than one or two <bsdf>"]);
}
