//! Pictures that claims rendered on their way, kept for the page.

use std::sync::{Mutex, PoisonError};

use crate::report::Gallery;

static KEPT: Mutex<Vec<Gallery>> = Mutex::new(Vec::new());

/// Keeps a picture for the page; a second one of the same name takes the first one's place.
pub fn keep(picture: Gallery) {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    kept.retain(|other| other.name != picture.name);
    kept.push(picture);
}

/// All pictures kept since the last call, by name.
pub fn take() -> Vec<Gallery> {
    let mut kept = std::mem::take(&mut *KEPT.lock().unwrap_or_else(PoisonError::into_inner));
    kept.sort_by(|a, b| a.name.cmp(&b.name));
    kept
}
