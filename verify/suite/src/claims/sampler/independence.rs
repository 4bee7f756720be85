//! Numbers for different purposes have nothing to do with each other, in real renders.

use renderer::sampling::SamplerKind;
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::independence::{Tally, judge_tallies};
use verify::mean::CONTROL_FACTOR;
use verify::seeds::derive;

use super::recording::{Place, Recording, Reuse, SAMPLES};
use crate::bounds;
use crate::wrong::samplers::{Question, in_pairs, lens_for_time, shared_by_neighbours};

pub(super) fn claims() -> Vec<Claim> {
    // The default's at the quick level; a run of the others costs as much.
    let first = |kind| if kind == SamplerKind::default() { Level::Quick } else { Level::Standard };
    SamplerKind::ALL.map(|kind| independence(kind).from_level(first(kind))).into()
}

/// The claim that all pairs of numbers are independent: of one sample, of neighbouring pixels, of replicates, of seeds; of successive
/// samples too where these do not form a set.
fn independence(kind: SamplerKind) -> Claim {
    let says = format!(
        "{} numbers of a render are independent: each decision of each bounce from 0 to 3 of every other, of its neighbours' in pixel, replicate and seed{}",
        kind.name(),
        if kind == SamplerKind::Independent { ", and of the sample before" } else { ", over randomisations" }
    );
    let confused = move |question: fn(Question) -> Question| {
        move |run: &Run| judge(kind, run, |seed| Recording::of(kind, seed, Some(question)), None)
    };
    let mut builder = claim(format!("sampler/{}/independence", kind.name()), says)
        .rejects("the lens's numbers for the shutter", confused(lens_for_time))
        .rejects("neighbouring pixels share numbers", confused(shared_by_neighbours));
    if kind == SamplerKind::Independent {
        builder = builder.rejects("successive samples share numbers", confused(in_pairs));
    }
    builder
        .rejects("a lens number in some shutter times, 2.2 × resolution", move |run| {
            let right = |seed| Recording::of(kind, seed, None);
            let resolution = judge(kind, run, right, None)?.resolution.value;
            judge(kind, run, right, Some(Reuse { share: CONTROL_FACTOR * resolution, seed: run.seed }))
        })
        .by(move |run| judge(kind, run, |seed| Recording::of(kind, seed, None), None))
}

/// Records renders of consecutive seeds, two at a time, and judges all pairs of numbers.
fn judge(
    kind: SamplerKind,
    run: &Run,
    record: impl Fn(u64) -> Result<Recording, InputError>,
    reuse: Option<Reuse>,
) -> Result<Evidence, InputError> {
    let mut tallies = Tallies::new(kind);
    for i in 0..run.effort {
        let seed = derive(run.seed, 0, i);
        let mut both = [record(seed)?, record(seed.wrapping_add(1))?];
        if let Some(reuse) = reuse {
            both.iter_mut().for_each(|recording| recording.reuse(Place::LENS, Place::TIME, reuse));
        }
        tallies.add(&both);
    }
    judge_tallies(&tallies.list(), bounds::CORRELATION)
}

/// Tallies by what is paired.
struct Tallies {
    /// One number with another of the same sample: the earlier place's index, the later one's, and their tally.
    within: Vec<(usize, usize, Tally)>,
    right: Vec<Tally>,
    below: Vec<Tally>,
    replicates: Vec<Tally>,
    seeds: Vec<Tally>,
    /// Empty where successive samples form a set.
    samples: Vec<Tally>,
}

impl Tallies {
    fn new(kind: SamplerKind) -> Self {
        let names = Place::names();
        let each =
            |with: &str| names.iter().map(|name| Tally::new(format!("{name} and its {with}"))).collect();
        let pairs = (0..names.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let within = pairs.map(|(a, b)| (a, b, Tally::new(format!("{} and {}", names[a], names[b]))));
        Self {
            within: within.collect(),
            right: each("right neighbour's"),
            below: each("lower neighbour's"),
            replicates: each("next replicate's"),
            seeds: each("next seed's"),
            samples: if kind == SamplerKind::Independent { each("next sample's") } else { Vec::new() },
        }
    }

    fn add(&mut self, both: &[Recording; 2]) {
        for recording in both {
            for set in 0..Recording::SETS {
                // the same index in both sets, where a number that is shared would be
                let index = Recording::chosen(set);
                let numbers = recording.numbers(set, index);
                for (a, b, tally) in &mut self.within {
                    push(tally, numbers[*a], numbers[*b]);
                }
                for (tallies, neighbour) in [
                    (&mut self.right, Recording::right_of(set)),
                    (&mut self.below, Recording::below(set)),
                    (&mut self.replicates, Recording::next_replicate(set)),
                ] {
                    if let Some(neighbour) = neighbour {
                        push_each(tallies, numbers, recording.numbers(neighbour, index));
                    }
                }
                let [first, second] = [0, SAMPLES - 1].map(|index| recording.numbers(set, index));
                push_each(&mut self.samples, first, second);
            }
        }
        for set in 0..Recording::SETS {
            let [a, b] = both.each_ref().map(|recording| recording.numbers(set, Recording::chosen(set)));
            push_each(&mut self.seeds, a, b);
        }
    }

    fn list(self) -> Vec<Tally> {
        let Self { within, right, below, replicates, seeds, samples } = self;
        let within = within.into_iter().map(|(_, _, tally)| tally);
        within.chain([right, below, replicates, seeds, samples].into_iter().flatten()).collect()
    }
}

fn push_each(tallies: &mut [Tally], a: &[f32], b: &[f32]) {
    for (tally, (&a, &b)) in tallies.iter_mut().zip(a.iter().zip(b)) {
        push(tally, a, b);
    }
}

/// Adds a pair of which both have been drawn.
///
/// Whether a number is drawn depends on those before it alone, so a number that is drawn is independent of all before it, whatever
/// these made of the path.
fn push(tally: &mut Tally, a: f32, b: f32) {
    if !a.is_nan() && !b.is_nan() {
        tally.push([a, b].map(f64::from));
    }
}
