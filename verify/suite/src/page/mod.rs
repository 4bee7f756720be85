//! The page: everything that a run found, in one HTML file without network, made from the report's data alone.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use verify::claim::Verdict;

use crate::report::Report;

mod calibration;
mod chart;
mod claim;
pub(crate) mod colour;
mod convergence;
mod curve;
mod gallery;
mod groups;
pub(crate) mod heat;
mod stability;

const STYLE: &str = include_str!("style.css");

/// The page of a report.
pub fn html(report: &Report) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "Lightproof: " (headline(report)) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (header(report))
                (gallery::section(&report.gallery))
                (errors(report))
                (groups::sections(&report.claims))
                (stability::section(&report.stability))
                (calibration::section(&report.calibration))
                (footer(report))
            }
        }
    }
    .into_string()
}

/// The verdicts in a few words.
fn headline(report: &Report) -> String {
    let total = report.claims.len() + report.errors.len();
    if report.all_hold() {
        return format!("all {total} claims hold");
    }
    let [fails, undecided] = [Verdict::Fails, Verdict::Undecided].map(|verdict| report.count(verdict));
    let mut parts = vec![format!("{} of {total} claims hold", report.count(Verdict::Holds))];
    let others = [(fails, "fail"), (undecided, "undecided"), (report.errors.len(), "could not run")];
    parts
        .extend(others.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")));
    parts.join(", ")
}

fn header(report: &Report) -> Markup {
    let controls = report.claims.iter().flat_map(|claim| &claim.controls);
    let rejected = controls.clone().filter(|control| control.rejected).count();
    html! {
        header {
            h1 { "Lightproof" }
            p.lead { "A distribution ray tracer, measured against what it should be." }
            p.headline.bad[!report.all_hold()] { (headline(report)) }
            ul.tiles {
                @for verdict in [Verdict::Holds, Verdict::Fails, Verdict::Undecided] {
                    li.(verdict) { b { (report.count(verdict)) } " " (verdict) }
                }
                li { b { (rejected) " of " (controls.count()) } " wrong versions rejected" }
            }
            p.facts {
                "Level " b { (report.level) } ", seed " b { (report.seed) } ", " (format!("{:.1}", report.seconds)) " s on "
                (report.machine) ". Version " (report.lightproof) "."
            }
            (how_to_read())
        }
    }
}

fn how_to_read() -> Markup {
    html! {
        details.how {
            summary { "How to read this" }
            p {
                "A claim has a " b { "bound" } ": the largest defect that it tolerates. It " b.holds { "holds" }
                " when the defect is below the bound with 99.9 % confidence; it " b.fails { "fails" }
                " when three runs in a row, with fresh random numbers and ever more samples, each reject “exactly right” at 1 in 1000; else it is "
                b.undecided { "undecided" } ", which never counts as a pass."
            }
            p {
                "Not being rejected shows nothing by itself. So each claim states the smallest defect that " b { "would have been caught" }
                " with 90 % power, and rejects " b { "wrong versions" }
                " of its subject in the same run. " b { "p" } " is the probability of a result at least as far off if the subject is exactly right."
            }
        }
    }
}

fn errors(report: &Report) -> Markup {
    html! {
        @if !report.errors.is_empty() {
            section {
                h2 { "Could not run" }
                @for error in &report.errors { p.fails { code { (error.id) } " " (error.message) } }
            }
        }
    }
}

fn footer(report: &Report) -> Markup {
    html! {
        footer {
            p { "Repeat this run: " code { "lightproof verify --level " (report.level) " --seed " (report.seed) } }
        }
    }
}
