//! What was found for one claim: figures, controls and pictures.

use maud::{Markup, html};

use super::heat::Cells;
use super::{convergence, curve, heat};
use crate::figures::{count, probability, three};
use crate::report::{ClaimReport, PictureData};

/// The part of a row that opens.
pub(super) fn details(claim: &ClaimReport) -> Markup {
    html! {
        div.found {
            (figures(claim))
            @for doubt in &claim.doubts { p.undecided { "Doubt: " (doubt) } }
            (controls(claim))
            @for data in &claim.pictures { (picture(data)) }
            p.note { "Repeat: " code { (claim.command) } }
        }
    }
}

fn figures(claim: &ClaimReport) -> Markup {
    let [low, high] = claim.interval;
    let power = three(claim.resolves.power.map(|power| 100.0 * power));
    html! {
        p {
            (claim.method) ": statistic " (three(claim.statistic))
            @if claim.dof.is_some() { " with " (three(claim.dof)) " degrees of freedom" }
            @if claim.p_value.is_some() { ", p = " (probability(claim.p_value)) }
            ", from " (count(claim.n)) " samples"
            @if claim.runs > 1 { " in run " (claim.runs) " of at most 3" }
            "."
        }
        p {
            "Defect (" (claim.resolves.quantity) "): " (three(claim.estimate)) ", 99.9 % limits " (three(low)) " to " (three(high))
            ", bound " (three(Some(claim.bound))) ". This run would have caught ≥ " (three(claim.resolves.value)) " with " (power) " % power."
        }
    }
}

fn controls(claim: &ClaimReport) -> Markup {
    html! {
        @if !claim.controls.is_empty() {
            table.legend {
                tr { th { "wrong version" } th { "p" } th { "" } }
                @for control in &claim.controls {
                    tr {
                        td { (control.name) }
                        td { (probability(control.p_value)) }
                        td { @if control.rejected { "rejected" } @else { span.badge.fails { "accepted: the test is blind to it" } } }
                    }
                }
            }
        }
    }
}

fn picture(data: &PictureData) -> Markup {
    match data {
        PictureData::Cells { shape, axes, observed, expected } => {
            heat::draw(&Cells { shape: *shape, axes: [&axes[0], &axes[1]], observed, expected })
        }
        PictureData::Convergence { lines } => convergence::draw(lines),
        PictureData::Curve { axes, exact, measured } => curve::draw(&[&axes[0], &axes[1]], exact, measured),
    }
}
