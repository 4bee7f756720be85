//! The table of claims, by group; each row opens to what was found.

use maud::{Markup, html};
use verify::claim::Verdict;

use super::claim;
use crate::figures::{count, probability, three};
use crate::report::ClaimReport;

/// One section a group, in the order in which groups first appear.
pub(super) fn sections(claims: &[ClaimReport]) -> Markup {
    html! {
        @for group in claims.chunk_by(|a, b| a.group() == b.group()) {
            @let holding = group.iter().filter(|claim| claim.verdict == Verdict::Holds).count();
            section {
                h2 { (group[0].group()) small { " " (holding) " of " (group.len()) " hold" } }
                div.row.head aria-hidden="true" {
                    span { "verdict" } span { "claim" } span { "defect: at most / bound" } span { "would have caught" } span { "p" } span { "samples" }
                    span { "wrong versions rejected" } span { "time" }
                }
                @for claim in group { (row(claim)) }
            }
        }
    }
}

fn row(claim: &ClaimReport) -> Markup {
    let rejected = claim.controls.iter().filter(|control| control.rejected).count();
    html! {
        details.claim id=(claim.id) open[claim.verdict != Verdict::Holds] {
            summary.row {
                span { span.badge.(claim.verdict) { (claim.verdict) } }
                span.says { (claim.says) code { (claim.id) } }
                span.limit { i { "defect: at most / bound" } (limit(claim)) }
                span { i { "would have caught" } "≥ " (three(claim.resolves.value)) }
                span { i { "p" } (probability(claim.p_value)) }
                span { i { "samples" } (count(claim.n)) }
                span { i { "wrong versions rejected" } @if claim.controls.is_empty() { "–" } @else { (rejected) " of " (claim.controls.len()) } }
                span { i { "time" } (format!("{:.2} s", claim.seconds)) }
            }
            (claim::details(claim))
        }
    }
}

/// The upper limit and the bound in digits, and as a bar that the bound ends.
fn limit(claim: &ClaimReport) -> Markup {
    let share = claim.interval[1].map_or(100.0, |limit| (100.0 * limit / claim.bound).clamp(0.0, 100.0));
    html! {
        (three(claim.interval[1])) " / " (three(Some(claim.bound)))
        span.meter { span.(claim.verdict) style=(format!("width:{share:.0}%")) {} }
    }
}
