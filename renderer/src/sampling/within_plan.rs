//! A sampler that insists on its plan: what a scene doesn't call for must not be drawn.

use super::{Decision, DecisionSet, SampleId, Sampler, Vertex};

/// Passes every draw on to `S` and panics on one that the plan doesn't have.
#[derive(Debug, Clone, Copy)]
pub struct WithinPlan<S> {
    sampler: S,
    first: DecisionSet,
    later: DecisionSet,
}

impl<S: Sampler> WithinPlan<S> {
    /// Wraps `sampler`; the decisions `first` are made at bounce 0, those of `later` at every later one.
    pub const fn new(sampler: S, first: DecisionSet, later: DecisionSet) -> Self {
        Self { sampler, first, later }
    }

    fn check(&self, vertex: Vertex, decision: Decision) {
        let planned = if vertex.bounce == 0 { self.first } else { self.later };
        assert!(planned.contains(decision), "{decision:?} at {vertex:?} is not planned");
    }
}

/// # Panics
/// On a decision that the plan doesn't have at its bounce.
impl<S: Sampler> Sampler for WithinPlan<S> {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        self.check(vertex, decision);
        self.sampler.draw_1d(sample, vertex, decision)
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        self.check(vertex, decision);
        self.sampler.draw_2d(sample, vertex, decision)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Independent;

    const SAMPLE: SampleId = SampleId { pixel: [0, 0], replicate: 0, index: 0 };

    fn planned() -> WithinPlan<Independent> {
        let first = DecisionSet::EMPTY.with(Decision::Time);
        let later = DecisionSet::EMPTY.with(Decision::Direction);
        WithinPlan::new(Independent::new(0), first, later)
    }

    #[test]
    fn what_is_planned_is_passed_on() {
        let vertex = Vertex::default();
        let direct = Independent::new(0).draw_1d(SAMPLE, vertex, Decision::Time);
        assert_eq!(planned().draw_1d(SAMPLE, vertex, Decision::Time), direct);
        let later = Vertex { bounce: 1, ..vertex };
        let direct = Independent::new(0).draw_2d(SAMPLE, later, Decision::Direction);
        assert_eq!(planned().draw_2d(SAMPLE, later, Decision::Direction), direct);
    }

    #[test]
    #[should_panic(expected = "Lens")]
    fn what_is_not_planned_panics() {
        planned().draw_2d(SAMPLE, Vertex::default(), Decision::Lens);
    }

    #[test]
    #[should_panic(expected = "Time")]
    fn what_is_planned_at_another_bounce_panics() {
        planned().draw_1d(SAMPLE, Vertex { bounce: 1, ..Vertex::default() }, Decision::Time);
    }
}
