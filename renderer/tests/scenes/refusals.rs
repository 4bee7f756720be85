//! What the reader refuses, with place, name and what is accepted.

use super::{Folder, expect_parts, refused, with_sensor};

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
