//! The page: everything that a run found, in one HTML file without network, made from the report's data alone.

use maud::{DOCTYPE, html};

use crate::report::Report;

/// The page of a report.
pub fn html(report: &Report) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head { meta charset="utf-8"; title { "Lightproof" } }
            body {
                h1 { "Lightproof" }
                table { @for claim in &report.claims { tr { td { (claim.verdict) } td { (claim.id) } td { (claim.says) } } } }
            }
        }
    }
    .into_string()
}
