//! How many cases of a law are tried, and where those that broke one are kept.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::FileFailurePersistence;

/// `cases` of each law; 8 and 64 times as many where `VERIFY_LEVEL` is standard or exhaustive, as it does with claims. What breaks a
/// law is tried first from then on: its seed goes to a file beside the test's.
pub(crate) fn config(cases: u32) -> ProptestConfig {
    let factor = match std::env::var("VERIFY_LEVEL").as_deref() {
        Ok("standard") => 8,
        Ok("exhaustive") => 64,
        _ => 1,
    };
    let regressions = FileFailurePersistence::WithSource("proptest-regressions");
    ProptestConfig {
        cases: cases * factor,
        // Laws that leave out most of what is drawn try on.
        max_global_rejects: 16 * cases * factor,
        failure_persistence: Some(Box::new(regressions)),
        ..ProptestConfig::default()
    }
}
