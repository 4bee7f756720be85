//! Statistics that test samplers and estimators, and say what they could have seen.
//!
//! The crate knows no renderer and shows no third-party type: points are `[f64; N]` and slices, subjects are closures.

pub mod chi_square;
pub mod claim;
pub mod convergence;
pub mod coverage;
pub mod cube;
pub mod discrepancy;
pub mod domain;
pub mod error;
pub mod estimate;
pub mod filter;
pub mod fresnel;
pub mod goodness;
pub mod histogram;
pub mod image;
pub mod independence;
pub mod integrands;
pub mod irradiance;
pub mod lens;
pub mod linear_complexity;
pub mod mean;
pub mod motion;
pub mod nets;
pub mod picture;
pub mod points;
pub mod power;
pub mod quadrature;
pub mod seeds;
pub mod shadow;
pub mod share;
mod tails;
pub mod welch;
