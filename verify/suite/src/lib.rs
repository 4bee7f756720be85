//! Our claims about our renderer, and the program `lightproof`.
//!
//! [`claims`] lists what is asserted, [`runner`] runs it, [`report`] keeps what was found as data, [`page`] draws it and [`cli`] is the
//! program around them.

pub mod analytic;
pub mod bounds;
pub mod claims;
pub mod cli;
pub mod figures;
pub mod gallery;
pub mod page;
pub mod report;
pub mod runner;
pub mod setup;
pub mod shares;
mod side;
pub mod wrong;
