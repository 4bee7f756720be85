//! What numeric stability costs: routine by routine, the usual form against ours.

use maud::{Markup, html};

use crate::figures::three;
use crate::report::StabilityRow;

/// The table; nothing without rows.
pub(super) fn section(rows: &[StabilityRow]) -> Markup {
    html! {
        @if !rows.is_empty() {
            section {
                h2 { "What stability costs" }
                p {
                    "The largest error of each routine over hard inputs, in its usual form and in ours, and the time of a call of either. "
                    "Errors in units of the last column but one; ∞ where a form gives no number or decides wrongly. "
                    "Where a shape or a material is asked, its time includes making it."
                }
                table.legend {
                    tr { th { "routine" } th { "usual form" } th { "its error" } th { "ours" } th { "bound" } th { "unit" } th { "ns, usual / ours" } }
                    @for row in rows {
                        tr {
                            td { (row.routine) }
                            td { (row.naive) }
                            td { @if row.naive_error.is_none() { "∞" } @else { (three(row.naive_error)) } }
                            td { (three(row.error)) }
                            td { (three(Some(row.bound))) }
                            td { (row.unit) }
                            td { (three(Some(row.naive_ns))) " / " (three(Some(row.ours_ns))) }
                        }
                    }
                }
            }
        }
    }
}
