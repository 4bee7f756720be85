//! Rank 1: maps from uniform numbers to points and directions of a known density.
//!
//! Each is a pure function with its density: `square_to_x`, `x_pdf` and, where the map is one-to-one, `x_to_square`.

mod cone;
mod disk;
mod hemisphere;
mod parallelogram;
mod phong;
mod sphere;
mod spherical_rectangle;
mod spherical_triangle;
mod tent;
mod triangle;

pub use cone::{cone_pdf, cone_to_square, one_minus_cos, square_to_cone};
pub use disk::{disk_pdf, disk_polar_to_square, disk_to_square, square_to_disk, square_to_disk_polar};
pub use hemisphere::{
    cosine_hemisphere_pdf, cosine_hemisphere_to_square, hemisphere_pdf, hemisphere_to_square,
    square_to_cosine_hemisphere, square_to_hemisphere, squares_to_cosine_hemisphere,
};
pub use parallelogram::{parallelogram_pdf_area, parallelogram_to_square, square_to_parallelogram};
pub use phong::{phong_pdf, phong_to_square, square_to_phong};
pub use sphere::{sphere_pdf, sphere_to_square, square_to_sphere};
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::SphericalTriangle;
pub use tent::{tent_pdf, tent_to_unit, unit_to_tent};
pub use triangle::{square_to_triangle, square_to_triangle_folded, triangle_pdf_uv, triangle_to_square};

/// A point of the unit sphere for each `n`, without an order.
#[cfg(test)]
pub(crate) fn point(n: u32) -> glam::Vec3 {
    let fraction = |x: f32| x - x.floor();
    square_to_sphere([0.754_877, 0.569_84].map(|step| fraction(n as f32 * step)))
}
