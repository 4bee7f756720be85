//! The text that goes with the files.

use super::Analytic;

const HEAD: &str = "# Scenes whose images mathematics knows

`NAME.xml` is a scene in Mitsuba 3's XML format, small enough to be translated by hand; `NAME.exr` is its exact image, with standard
errors of 0. Render a scene several times with different seeds and hold the images against the exact one:

    lightproof compare NAME-1.exr NAME-2.exr NAME-3.exr NAME-4.exr -- NAME.exr --max-bias 0.2

Several images tell their own errors; a single one needs `stderr.R stderr.G stderr.B` and the attribute `lightproof.replicates`.

## Conventions
- Lengths have no unit. Lights have the radiance 1 W m⁻² sr⁻¹; a pixel's value is a radiance, linear, not clamped, the same in R, G, B.
- x runs to the right of the image and y upwards; row 0 is the upper one. Most scenes are seen by parallel rays along −z: the film is as
  wide as the first two numbers of `scale` say, twice each, around the z axis.
- A pixel is the mean over its square (`box`), unless the scene names another filter: then the integral of filter times image over the
  integral of the filter, light beyond the film's border included (`sample_border` in Mitsuba).
- `max_depth` counts the edges of a path: 1 sees lights only, 2 adds light that is reflected once.
- Lamps are black and emit on the side of their normal, +z of a rectangle or disk before its transform; the steps of a transform apply
  from left to right. `flip_normals` turns a sphere's normals inward.
- `thinlens`: points on the lens are uniform on a disk of `aperture_radius`; what is in focus is a plane at `focus_distance`.
- The shutter is fully open from `shutter_open` to `shutter_close`, and times are weighted alike; a longer time is not brighter.
- `dielectric` treats light as unpolarised; the reflectance is the mean of both polarisations.

## Scenes
";

/// The README of the scenes.
pub fn readme(scenes: &[Analytic]) -> String {
    let line = |scene: &Analytic| {
        let [width, height] = scene.size;
        let note = if scene.mitsuba { "" } else { " Mitsuba 3.9.1 has no moving shapes." };
        format!("- `{}` ({width} × {height}): {}.{note}\n", scene.name, scene.says)
    };
    HEAD.to_owned() + &scenes.iter().map(line).collect::<String>()
}
