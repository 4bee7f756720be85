//! A sampler with some of its decisions drawn anew: what changes with them is their part of the variance.

use super::{Decision, DecisionSet, SampleId, Sampler, Vertex};

/// Takes the decisions of a set from `fresh` and all others from `kept`.
#[derive(Debug, Clone, Copy)]
pub struct Redrawn<S> {
    kept: S,
    fresh: S,
    decisions: [DecisionSet; 2],
}

impl<S: Sampler> Redrawn<S> {
    /// Redraws, at bounce 0 and at every later one, the `decisions` of these two sets.
    pub const fn new(kept: S, fresh: S, decisions: [DecisionSet; 2]) -> Self {
        Self { kept, fresh, decisions }
    }

    fn source(&self, vertex: Vertex, decision: Decision) -> &S {
        let [first, later] = &self.decisions;
        let redrawn = if vertex.bounce == 0 { first } else { later };
        if redrawn.contains(decision) { &self.fresh } else { &self.kept }
    }
}

impl<S: Sampler> Sampler for Redrawn<S> {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        self.source(vertex, decision).draw_1d(sample, vertex, decision)
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        self.source(vertex, decision).draw_2d(sample, vertex, decision)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Independent;

    #[test]
    fn what_is_redrawn_comes_from_the_other_sampler_at_its_bounce_only() {
        let (kept, fresh) = (Independent::new(0), Independent::new(1));
        let later = DecisionSet::EMPTY.with(Decision::Lobe);
        let sampler = Redrawn::new(kept, fresh, [DecisionSet::EMPTY.with(Decision::Time), later]);
        let sample = SampleId { pixel: [3, 4], replicate: 0, index: 5 };
        for (bounce, decision, source) in [
            (0, Decision::Time, fresh),
            (0, Decision::Lobe, kept),
            (2, Decision::Time, kept),
            (2, Decision::Lobe, fresh),
        ] {
            let vertex = Vertex { bounce, ..Vertex::default() };
            let expected = source.draw_1d(sample, vertex, decision);
            assert_eq!(sampler.draw_1d(sample, vertex, decision), expected, "{bounce} {decision:?}");
        }
    }
}
