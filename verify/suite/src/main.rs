//! The program `lightproof`.
fn main() {}
