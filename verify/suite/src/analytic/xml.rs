//! The pieces of the scene files.

/// A film's view of the plane z = 0 from above: parallel rays, x to the right, y upwards, a pixel `pixel` wide.
pub(super) fn from_above(eye: f64, pixel: f64, width: u32) -> String {
    let half = 0.5 * pixel * f64::from(width);
    format!(
        r#"  <sensor type="orthographic">
    <transform name="to_world">
      <scale x="{half}" y="{half}"/>
      <lookat origin="0, 0, {eye}" target="0, 0, 0" up="0, 1, 0"/>
    </transform>
"#
    )
}

/// A thin lens at the origin that looks along −z, in focus at `focus`, where a pixel is 1 wide.
pub(super) fn thin_lens(aperture: f64, focus: f64, width: u32) -> String {
    let fov = 2.0 * (0.5 * f64::from(width) / focus).atan().to_degrees();
    format!(
        r#"  <sensor type="thinlens">
    <float name="fov" value="{fov}"/>
    <string name="fov_axis" value="x"/>
    <float name="aperture_radius" value="{aperture}"/>
    <float name="focus_distance" value="{focus}"/>
    <transform name="to_world">
      <lookat origin="0, 0, 0" target="0, 0, -1" up="0, 1, 0"/>
    </transform>
"#
    )
}

/// A pinhole with a full angle of view over the width.
pub(super) fn pinhole(fov: f64, lookat: &str) -> String {
    format!(
        r#"  <sensor type="perspective">
    <float name="fov" value="{fov}"/>
    <string name="fov_axis" value="x"/>
    <transform name="to_world">
      <lookat {lookat}/>
    </transform>
"#
    )
}

/// A whole scene: paths of at most `depth` edges, the sensor with its film, and what is in the scene.
pub(super) fn document(
    says: &str,
    depth: u32,
    (sensor, filter): (&str, &str),
    [width, height]: [u32; 2],
    content: &str,
) -> String {
    format!(
        r#"<!-- {says}. Written by lightproof analytic. -->
<scene version="3.0.0">
  <default name="spp" value="1024"/>
  <integrator type="path">
    <integer name="max_depth" value="{depth}"/>
    <integer name="rr_depth" value="100"/>
  </integrator>
{sensor}    <film type="hdrfilm">
      <integer name="width" value="{width}"/>
      <integer name="height" value="{height}"/>
      <string name="pixel_format" value="rgb"/>
      <string name="component_format" value="float32"/>
      {filter}
    </film>
    <sampler type="independent">
      <integer name="sample_count" value="$spp"/>
    </sampler>
  </sensor>
{content}</scene>
"#
    )
}

/// The plain average over a pixel.
pub(super) const BOX: &str = r#"<rfilter type="box"/>"#;

/// What a shape does to light.
#[derive(Clone, Copy)]
pub(super) enum Surface {
    /// Black, emitting the radiance 1.
    Lamp,
    /// Diffuse, of this reflectance.
    Diffuse(f64),
}

/// A shape of the canonical form `kind` with a transform's steps, in the order of their application.
pub(super) fn shape(kind: &str, surface: Surface, steps: &str) -> String {
    let transform = format!("    <transform name=\"to_world\">{steps}</transform>\n");
    with_body(kind, surface, &transform)
}

/// A sphere; `inward` for one whose normals point to its middle.
pub(super) fn sphere([x, y, z]: [f64; 3], radius: f64, surface: Surface) -> String {
    let body = format!(
        "    <point name=\"center\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>\n    <float name=\"radius\" value=\"{radius}\"/>\n"
    );
    with_body("sphere", surface, &body)
}

/// A shape with the elements of `body`.
pub(super) fn with_body(kind: &str, surface: Surface, body: &str) -> String {
    let (reflectance, emitter) = match surface {
        Surface::Lamp => {
            (0.0, "    <emitter type=\"area\"><rgb name=\"radiance\" value=\"1, 1, 1\"/></emitter>\n")
        }
        Surface::Diffuse(reflectance) => (reflectance, ""),
    };
    format!(
        "  <shape type=\"{kind}\">\n{body}    <bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"{reflectance}, {reflectance}, {reflectance}\"/></bsdf></bsdf>\n{emitter}  </shape>\n"
    )
}

/// A rectangle of half sides `a` and `b` around (x, y, z); `down` turns its normal from +z to −z.
pub(super) fn rectangle([a, b]: [f64; 2], [x, y, z]: [f64; 3], down: bool, surface: Surface) -> String {
    let turn = if down { "<rotate x=\"1\" angle=\"180\"/>" } else { "" };
    let steps = format!("<scale x=\"{a}\" y=\"{b}\"/>{turn}<translate x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
    shape("rectangle", surface, &steps)
}
