//! Drawing a sampler's points and counting them.

use std::sync::Arc;

use super::Target;
use crate::domain::Domain;
use crate::histogram::Histogram;
use crate::points::fill;

/// What a sampler gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drawn<P> {
    /// A point that follows the density.
    Point(P),
    /// One of the points that have a probability of their own, such as a mirror's direction, by its place in the list.
    Atom(usize),
    /// Nothing, on purpose.
    Discarded,
}

impl<P> From<Option<P>> for Drawn<P> {
    fn from(point: Option<P>) -> Self {
        point.map_or(Self::Discarded, Self::Point)
    }
}

/// Draws samples of one sampler and counts them.
pub(super) type Subject = Box<dyn Fn(&Draw) -> Histogram + Send + Sync>;

/// What to draw.
pub(super) struct Draw {
    pub(super) seed: u64,
    pub(super) n: u64,
    pub(super) defect: Option<Defect>,
}

/// A planted defect: one of the sampler's numbers, u, replaced by u^exponent.
#[derive(Clone, Copy)]
pub(super) struct Defect {
    pub(super) axis: usize,
    pub(super) exponent: f64,
}

/// The loop that draws a sampler's points and counts them; compiled for each sampler.
pub(super) fn subject<D: Domain, const N: usize>(
    target: &Arc<Target<D>>,
    sampler: impl Fn([f64; N]) -> Drawn<D::Point> + Send + Sync + 'static,
) -> Subject {
    let target = target.clone();
    Box::new(move |draw| {
        let mut histogram = target.histogram();
        for index in 0..draw.n {
            let mut u = [0.0; N];
            fill(draw.seed, index, &mut u);
            if let Some(Defect { axis, exponent }) = draw.defect
                && let Some(u) = u.get_mut(axis)
            {
                *u = u.powf(exponent);
            }
            match sampler(u) {
                Drawn::Point(point) => target.add(&mut histogram, point),
                Drawn::Atom(atom) => histogram.add_atom(atom),
                Drawn::Discarded => histogram.add_discarded(),
            }
        }
        histogram
    })
}

/// The exponent 1 + δ for which u^(1 + δ) of uniform u has a given RMS relative error over equal columns.
pub(super) fn exponent_of(rms: f64, columns: usize) -> f64 {
    let columns = columns.max(2) as f64;
    let reached = |delta: f64| {
        let mut square = 0.0;
        let (mut edge, mut below) = (0.0, 0.0);
        while edge < columns {
            edge += 1.0;
            let upto = (edge / columns).powf(1.0 / (1.0 + delta));
            square += columns * (upto - below - 1.0 / columns).powi(2);
            below = upto;
        }
        square.sqrt()
    };
    let mut high = 1.0;
    while reached(high) < rms && high < 1e6 {
        high *= 2.0;
    }
    1.0 + crate::power::bisect([0.0, high], |delta| reached(delta) < rms)
}
