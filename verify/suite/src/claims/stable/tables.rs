//! The tables of `references/stability`: hard inputs and values to 50 digits, by `scripts/make_oracles.py`.

macro_rules! table {
    ($file:literal) => {
        include_str!(concat!("../../../../../references/stability/", $file, ".csv"))
    };
}

/// No table.
pub(super) const NONE: &str = "";

pub(super) const BECKMANN: &str = table!("beckmann");
pub(super) const BLUR_DISK: &str = table!("blur_disk");
pub(super) const CONDUCTOR: &str = table!("conductor");
pub(super) const CONE: &str = table!("cone");
pub(super) const DIELECTRIC: &str = table!("dielectric");
pub(super) const DIFFERENCE_OF_PRODUCTS: &str = table!("difference_of_products");
pub(super) const DISCRETE: &str = table!("discrete");
pub(super) const GGX: &str = table!("ggx");
pub(super) const GROUND_GLASS: &str = table!("ground_glass");
pub(super) const HALF_VECTOR: &str = table!("half_vector");
pub(super) const ONE_MINUS_COS: &str = table!("one_minus_cos");
pub(super) const PHONG: &str = table!("phong");
pub(super) const PHONG_PDF: &str = table!("phong_pdf");
pub(super) const POWER_HEURISTIC: &str = table!("power_heuristic");
pub(super) const RECTANGLE_SOLID_ANGLE: &str = table!("rectangle_solid_angle");
pub(super) const ROTATION: &str = table!("rotation");
pub(super) const SPHERE: &str = table!("sphere");
pub(super) const SPHERE_SOLID_ANGLE: &str = table!("sphere_solid_angle");
#[cfg(test)]
pub(super) const TRIANGLE: &str = table!("triangle");
pub(super) const TRIANGLE_SOLID_ANGLE: &str = table!("triangle_solid_angle");

#[cfg(test)]
mod tests {
    /// The tables are those of the script as it is: each has its hash.
    #[test]
    fn every_table_names_one_and_the_same_generator() {
        let hash = |table: &str| {
            table.lines().next().and_then(|line| line.split("SHA-256 ").nth(1)).map(String::from)
        };
        let first = hash(super::BLUR_DISK).expect("the first line names the generator's hash");
        assert_eq!(first.len(), 64);
        for table in [super::CONDUCTOR, super::GGX, super::SPHERE, super::TRIANGLE, super::ROTATION] {
            assert_eq!(hash(table).as_ref(), Some(&first));
        }
    }
}
