//! Scene files: what they mean, what is refused with which message, and that nothing makes the reader panic.

mod folder;

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
fn unknown_things_are_refused_with_place_name_and_what_is_accepted() {
    let cases: [(&str, &[&str]); 9] = [
        ("<foo/>", &["s.xml:3:1: element <foo>;", "shape", "are accepted"]),
        (
            r#"<shape type="teapot"/>"#,
            &["s.xml:3:8: shape plugin 'teapot' is not supported;", "cube, cylinder"],
        ),
        (
            r#"<shape type="sphere"><float name="radios" value="1"/></shape>"#,
            &["s.xml:3:22: unknown <float> 'radios' in shape sphere;", "radius", "to_world", "<bsdf>"],
        ),
        (
            r#"<bsdf type="principled" id="x"/>"#,
            &["s.xml:3:7: bsdf plugin 'principled' is not supported;", "dielectric"],
        ),
        (
            r#"<bsdf type="roughconductor"><string name="distribution" value="phong"/></bsdf>"#,
            &["s.xml:3:57: 'distribution' is 'phong'; beckmann, ggx are accepted"],
        ),
        (
            r#"<bsdf type="conductor"><string name="material" value="Xx"/></bsdf>"#,
            &["s.xml:3:48:", "'Xx'", "Au"],
        ),
        (
            r#"<bsdf type="dielectric"><string name="int_ior" value="jam"/></bsdf>"#,
            &["s.xml:3:48:", "diamond"],
        ),
        (r#"<float name="a" value="1"/>"#, &["s.xml:3:1: unknown <float> 'a' in scene;", "<shape>"]),
        (r#"<shape type="sphere" colour="1"/>"#, &["s.xml:3:22: attribute 'colour' of <shape>;", "type"]),
    ];
    for (body, parts) in cases {
        expect_parts(&refused(body), parts);
    }
}

#[test]
fn wrong_values_are_refused_with_place_name_and_what_is_accepted() {
    let sphere = |part: &str| refused(&format!(r#"<shape type="sphere">{part}</shape>"#));
    let cases: [(&str, &[&str]); 11] = [
        (r#"<float name="radius" value="1m"/>"#, &["s.xml:3:43: value is '1m'; a finite number is accepted"]),
        (r#"<float name="radius" value="nan"/>"#, &["s.xml:3:43:", "'nan'; a finite number is accepted"]),
        (
            r#"<float name="radius" value="-1"/>"#,
            &["s.xml:3:22: 'radius' is -1; a radius above 0 is accepted"],
        ),
        (r#"<float name="radius" value="0"/>"#, &["s.xml:3:22: 'radius' is 0;"]),
        (
            r#"<string name="radius" value="1"/>"#,
            &["s.xml:3:22: 'radius' as <string>; <float>, <integer> is accepted"],
        ),
        (
            r#"<float name="radius" value="1"/><float name="radius" value="1"/>"#,
            &["s.xml:3:54: 'radius' for the second time"],
        ),
        (
            r#"<boolean name="flip_normals" value="1"/>"#,
            &["s.xml:3:51: 'flip_normals' is '1'; true, false are accepted"],
        ),
        (r#"<point name="center" x="1"/>"#, &["s.xml:3:22: <point> has no attribute 'y'"]),
        (
            r#"<transform name="to_world"><scale value="0"/></transform>"#,
            &["s.xml:3:22: to_world:", "singular", "invertible"],
        ),
        (
            r#"<transform name="to_world"><rotate x="2" angle="3"/></transform>"#,
            &["s.xml:3:49: rotation axis of length 2"],
        ),
        (r#"<ref id="nobody"/>"#, &["s.xml:3:27: no object has the id 'nobody';"]),
    ];
    for (part, parts) in cases {
        expect_parts(&sphere(part), parts);
    }
    let glass = r#"<bsdf type="dielectric"><float name="int_ior" value="0"/></bsdf>"#;
    expect_parts(
        &refused(glass),
        &["s.xml:3:47: 'int_ior' is 0; an index of refraction above 0 is accepted"],
    );
    let white = r#"<bsdf type="diffuse"><rgb name="reflectance" value="1.5"/></bsdf>"#;
    expect_parts(&refused(white), &["s.xml:3:22: bsdf diffuse: reflectance is 1.5; 0 to 1 is accepted"]);
    let two = "<bsdf type=\"diffuse\" id=\"x\"/>\n<bsdf type=\"diffuse\" id=\"x\"/>";
    expect_parts(&refused(two), &["s.xml:4:1: id 'x' is taken by", "s.xml:3:1"]);
    let inside = r#"<bsdf type="twosided" id="a"><ref id="a"/></bsdf>"#;
    expect_parts(&refused(inside), &["s.xml:3:1: a bsdf inside itself"]);
    let lone = r#"<emitter type="area"><rgb name="radiance" value="1"/></emitter>"#;
    expect_parts(&refused(lone), &["s.xml:3:1: an area emitter that no shape has"]);
}

#[test]
fn films_of_no_or_too_many_pixels_are_refused() {
    let film = |part: &str| {
        let sensor = format!(
            "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>\n<film type=\"hdrfilm\">{part}</film></sensor>"
        );
        Folder::new(&[("s.xml", &format!("<scene version=\"3.0.0\">{sensor}</scene>"))]).refused()
    };
    let width = |value: &str| film(&format!(r#"<integer name="width" value="{value}"/>"#));
    expect_parts(&width("0"), &["s.xml:2:22: 'width' is 0; 1 to 4294967295 is accepted"]);
    expect_parts(&width("-5"), &["s.xml:2:22: 'width' is -5;"]);
    expect_parts(
        &width("1000000"),
        &["s.xml:2:22: a film of 1000000 × 576 pixels; 1 to 2^28 pixels are accepted"],
    );
    expect_parts(&width("1.5"), &["s.xml:2:44: 'width' is '1.5'; a whole number is accepted"]);
    expect_parts(
        &film(r#"<integer name="crop_offset_x" value="8"/><integer name="crop_width" value="761"/>"#),
        &["s.xml:2:63: 'crop_width' is 761 from 8 on; 1 to 760 is accepted"],
    );
    expect_parts(
        &film(r#"<integer name="crop_offset_y" value="576"/>"#),
        &["s.xml:2:22: 'crop_offset_y' is 576; 0 to 575 is accepted"],
    );
    expect_parts(
        &film(r#"<rfilter type="sinc"/>"#),
        &["s.xml:2:31: rfilter plugin 'sinc'", "box, catmullrom, gaussian, lanczos, mitchell, tent"],
    );
}

#[test]
fn files_that_are_missing_broken_or_go_round_in_circles_are_refused() {
    let obj = |name: &str| {
        refused(&format!(r#"<shape type="obj"><string name="filename" value="{name}"/></shape>"#))
    };
    expect_parts(&obj("no.obj"), &["s.xml:3:43: filename 'no.obj': No such file"]);
    expect_parts(&obj("empty.obj"), &["empty.obj: a mesh without faces; one face or more is accepted"]);
    expect_parts(&obj("bad.obj"), &["bad.obj:1:7: 'nan'; a finite number is accepted"]);
    expect_parts(
        &refused(r#"<include filename="no.xml"/>"#),
        &["s.xml:3:10: filename 'no.xml': No such file"],
    );
    expect_parts(&refused("<shape"), &["s.xml:4:", "well-formed XML is accepted"]);
    expect_parts(&refused("hello"), &["s.xml:2:", "text between elements"]);
    let loops = [
        ("s.xml", "<scene version='3.0.0'><include filename='t.xml'/></scene>"),
        ("t.xml", "<scene>\n<include filename='s.xml'/></scene>"),
    ];
    expect_parts(&Folder::new(&loops).refused(), &["t.xml:2:10: include loop:", "s.xml →", "t.xml →"]);
    expect_parts(&Folder::new(&[]).refused(), &["s.xml: No such file"]);
    expect_parts(
        &Folder::new(&[("s.xml", "<scene version='3.0.0'/>")]).refused(),
        &["s.xml:1:1: a scene without a <sensor>"],
    );
    expect_parts(
        &Folder::new(&[("s.xml", "<scene/>")]).refused(),
        &["s.xml:1:1: <scene> has no attribute 'version'"],
    );
    expect_parts(
        &Folder::new(&[("s.xml", "<scene version='0.6.0'/>")]).refused(),
        &["s.xml:1:8: format version '0.6.0'", "3.x.y"],
    );
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
    assert_eq!(scene.objects[0].radiance, Rgb::new(1.0, 2.0, 3.0));
    assert!(matches!(*scene.objects[0].material, Material::Mirror(_)));
    assert_eq!(notes, ["the scene has no <integrator>: paths of any length are followed"]);
    assert!(scene.lights.is_empty());
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
    for (a, b) in scene.objects[0].radiance.to_array().into_iter().zip(light) {
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
fn nests_and_trees_without_end_are_refused() {
    let deep = format!("{}{}", "<bsdf type=\"twosided\">".repeat(5000), "</bsdf>".repeat(5000));
    expect_parts(&refused(&deep), &["elements nested too deep; 64 levels are accepted"]);
    let chain: String = (0..500)
        .map(|i| format!("<bsdf type='twosided' id='b{i}'><ref id='b{}'/></bsdf>\n", i + 1))
        .collect();
    expect_parts(&refused(&format!("{chain}<bsdf type='diffuse' id='b500'/>")), &["bsdfs nested too deep"]);
    let doubling: String =
        (0..60).map(|i| format!("<default name='p{}_' value='$p{i}_$p{i}_'/>", i + 1)).collect();
    expect_parts(&refused(&format!("<default name='p0_' value='x'/>{doubling}")), &["a value longer than"]);
    let tree =
        |next: usize| format!("<scene>{}</scene>", format!("<include filename='{next}.xml'/>").repeat(10));
    let names: Vec<(String, String)> = (0..20).map(|i| (format!("{i}.xml"), tree(i + 1))).collect();
    let main = with_sensor("<include filename='0.xml'/>");
    let mut files: Vec<(&str, &str)> = names.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    files.extend([("s.xml", main.as_str()), ("20.xml", "<scene/>")]);
    expect_parts(&Folder::new(&files).refused(), &["too many inclusions; up to 1000 files"]);
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
