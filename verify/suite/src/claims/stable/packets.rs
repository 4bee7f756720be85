//! Rays that go the same way are walked together, and find what each finds alone.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::accel::{Accel, Object};
use renderer::ray::{Hit, Ray};
use renderer::shapes::{Shape, ShapeSettings};
use verify::claim::{Claim, Evidence, Run, claim};
use verify::error::InputError;
use verify::share;

use super::numbers::Numbers;
use super::watertight::ball;
use crate::setup::subject;

/// Rays that go the same way, and rays that are traced at once.
const BUNDLE: u64 = 64;
const BATCH: u64 = 64 * BUNDLE;

/// Columns and rows of each mesh: so many that the tree has inner nodes and leaves overlap.
const SIDE: u32 = 64;

pub(super) fn claims() -> Vec<Claim> {
    let says = "rays that go the same way, from one point and from several, meet what each meets alone, where two bodies cut one another";
    let spoilt = |hits: &mut [Option<Hit>]| {
        if let Some(hit) = hits.iter_mut().flatten().next() {
            hit.t = hit.t.next_up();
        }
    };
    vec![
        claim("stable/packets/as-alone", says)
            .rejects("one distance of 4,096 is a rounding longer", move |run| differing(run, spoilt))
            .by(|run| differing(run, |_| ())),
    ]
}

/// Judges how many rays of bundles find together what they don't find alone, after `spoil` has changed what each batch found.
fn differing(run: &Run, spoil: impl Fn(&mut [Option<Hit>])) -> Result<Evidence, InputError> {
    let objects = [0, 1].map(|body| {
        let settings = ShapeSettings::Mesh(Arc::new(ball(run.seed.wrapping_add(body), SIDE)));
        Shape::new(&settings, &DAffine3::IDENTITY, false).map(Object::still).map_err(subject)
    });
    let accel = Accel::new(objects.into_iter().collect::<Result<_, _>>()?, [0.0, 0.0]);
    let bound = 1e-4;
    let trials = share::trials_for(bound)?.next_multiple_of(BATCH) * run.effort;
    let (mut found, mut blocked) = (Vec::new(), Vec::new());
    let (mut alone, mut alone_blocked) = (Vec::new(), Vec::new());
    let mut differing = 0;
    for batch in 0..trials / BATCH {
        let rays: Vec<Ray> = (0..BATCH).map(|i| ray(run.seed, batch * BATCH + i)).collect();
        accel.closest(&rays, &mut found);
        accel.occluded(&rays, &mut blocked);
        spoil(&mut found);
        for ((ray, hit), is_blocked) in rays.iter().zip(&found).zip(&blocked) {
            let ray = std::slice::from_ref(ray);
            accel.closest(ray, &mut alone);
            accel.occluded(ray, &mut alone_blocked);
            differing += u64::from(alone[0] != *hit || alone_blocked[0] != *is_blocked);
        }
    }
    share::judge("share of rays that find something else", differing, trials, bound)
}

/// A ray of a bundle: from one point, or from around it, to around a point within the bodies.
fn ray(seed: u64, index: u64) -> Ray {
    let (bundle, own) = (Numbers::new(seed, index / BUNDLE), Numbers::new(!seed, index));
    let from = bundle.between(1.6, 4.0) * bundle.direction();
    let target = bundle.unit() * bundle.direction();
    let spread = bundle.one_of([0.0, 0.03]);
    let around = |point: DVec3, radius: f64| point + radius * own.unit() * own.direction();
    let (from, target) = (around(from, spread), around(target, 0.03));
    let reach = bundle.one_of([f64::INFINITY, 3.0]);
    #[expect(clippy::cast_possible_truncation, reason = "how far a ray reaches is f32")]
    let t_max = reach as f32;
    Ray { t_max, ..Ray::new(from.as_vec3(), (target - from).normalize().as_vec3(), 0.0) }
}
