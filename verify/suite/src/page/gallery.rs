//! The rendered scenes.

use maud::{Markup, html};

use super::heat::data_uri;
use crate::report::Gallery;

/// The scenes side by side; nothing without scenes.
pub(super) fn section(scenes: &[Gallery]) -> Markup {
    html! {
        @if !scenes.is_empty() {
            section.gallery {
                @for scene in scenes {
                    figure {
                        img src=(data_uri(&scene.png)) alt=(scene.name);
                        figcaption { b { (scene.name) } " " (scene.caption) }
                    }
                }
            }
        }
    }
}
