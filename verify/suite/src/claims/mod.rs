//! What is asserted about the renderer: one file a group, all of them in one list for the tests, the program and the page.

use verify::claim::{Claim, Level};

mod convergence;
mod counted;
mod effect;
mod film;
mod filter;
mod fresnel;
mod furnace;
mod generator;
mod image;
mod irradiance;
mod jittered;
mod lens;
mod light;
mod lobe;
mod material;
mod pointwise;
mod recorded;
mod relation;
mod sampler;
mod shadow;
mod shutter;
mod stable;
mod warp;

pub use image::{references, set_references};
pub use stable::table as stability_table;

/// The groups that a claim's name may begin with.
pub const GROUPS: [&str; 19] = [
    "generator",
    "sampler",
    "warp",
    "lens",
    "shutter",
    "filter",
    "light",
    "material",
    "irradiance",
    "shadow",
    "fresnel",
    "lobe",
    "furnace",
    "relation",
    "image",
    "convergence",
    "cost",
    "stable",
    "effect",
];

/// Every claim, by group.
pub fn all() -> Vec<Claim> {
    [
        generator::claims(),
        sampler::claims(),
        convergence::claims(),
        warp::claims(),
        lens::claims(),
        shutter::claims(),
        filter::claims(),
        light::claims(),
        irradiance::claims(),
        shadow::claims(),
        fresnel::claims(),
        lobe::claims(),
        material::claims(),
        furnace::claims(),
        relation::claims(),
        effect::claims(),
        image::claims(),
        stable::claims(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The claims that belong to `level`: those of the levels below it, and its own.
pub fn at(level: Level) -> Vec<Claim> {
    all().into_iter().filter(|claim| claim.first_level() <= level).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn names_are_unique_and_have_a_group_a_subject_and_a_property() {
        let mut seen = HashSet::new();
        for claim in all() {
            let id = claim.id();
            let parts: Vec<&str> = id.split('/').collect();
            let lower = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-./".contains(c);
            assert!(
                parts.len() == 3 && parts.iter().all(|part| !part.is_empty()),
                "{id}: group/subject/property"
            );
            assert!(GROUPS.contains(&parts[0]), "{id}: {} is not a group", parts[0]);
            assert!(id.chars().all(lower), "{id}: lower case letters, digits, hyphens and points");
            assert!(seen.insert(String::from(id)), "{id} is there twice");
        }
    }
}
