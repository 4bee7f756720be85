//! Scenes and inputs that the benchmarks share.
