//! Samplers that give right numbers for the wrong purpose.

use renderer::sampling::{Decision, SampleId, Sampler, Vertex};

/// What a number is asked for by.
pub type Question = (SampleId, Vertex, Decision);

/// A sampler that takes one question for another.
pub struct Confused {
    /// The sampler that is asked.
    pub inner: Box<dyn Sampler>,
    /// The question that it is asked in the place of the right one.
    pub question: fn(Question) -> Question,
}

impl Sampler for Confused {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        let (sample, vertex, decision) = (self.question)((sample, vertex, decision));
        match decision.dimensions() {
            1 => self.inner.draw_1d(sample, vertex, decision),
            _ => self.inner.draw_2d(sample, vertex, decision)[0],
        }
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let (sample, vertex, decision) = (self.question)((sample, vertex, decision));
        self.inner.draw_2d(sample, vertex, decision)
    }
}

/// The lens's numbers for the shutter as well.
pub fn lens_for_time((sample, vertex, decision): Question) -> Question {
    (sample, vertex, if decision == Decision::Time { Decision::Lens } else { decision })
}

/// The same numbers for two neighbouring columns of pixels.
pub fn shared_by_neighbours((sample, vertex, decision): Question) -> Question {
    let pixel = [sample.pixel[0] & !1, sample.pixel[1]];
    (SampleId { pixel, ..sample }, vertex, decision)
}

/// A generator whose period is 64 samples.
pub fn repeating_after_64((sample, vertex, decision): Question) -> Question {
    (SampleId { index: sample.index % 64, ..sample }, vertex, decision)
}

/// Two successive samples with the same numbers.
pub fn in_pairs((sample, vertex, decision): Question) -> Question {
    (SampleId { index: sample.index & !1, ..sample }, vertex, decision)
}

/// Samples whose first has been left out.
pub fn without_the_first((sample, vertex, decision): Question) -> Question {
    (SampleId { index: sample.index + 1, ..sample }, vertex, decision)
}

/// Both numbers of a point made of the same bits.
pub fn on_the_diagonal([x, _]: [f64; 2]) -> [f64; 2] {
    [x, x]
}

/// The first number moved into the column of an n-by-n grid in which the sample is when the grid is filled in order.
pub fn in_order([x, y]: [f64; 2], column: u32, columns: u32) -> [f64; 2] {
    [(f64::from(column) + x) / f64::from(columns), y]
}
