//! Claims about images: rows and small films that the renderer makes, against exact values pixel by pixel.

use std::borrow::Cow;
use std::sync::{Arc, LazyLock, OnceLock};

use renderer::sampling::SamplerKind;
use renderer::scene::{Scene, SceneDescription};
use verify::claim::{Claim, Evidence, Level, Picture, Run, claim};
use verify::error::InputError;
use verify::estimate::{Estimate, Replicate};
use verify::mean::{CONTROL_FACTOR, FEWEST_REPLICATES, MeanClaim, judge};
use verify::seeds::derive;

use crate::setup::{built, image};

/// Points at which an exact curve is drawn.
const CURVE_POINTS: u32 = 120;

/// Samples of a replicate that must fall on the rarer side of an edge: with fewer, in a tail, a mean over replicates is not
/// near normal.
const FEWEST_SAMPLES: f64 = 16.0;

/// Rounding of images: positions and radiances are f32; 16 roundings of 2⁻²⁴ that all agree.
const ROUNDING: f64 = 1e-6;

/// Smaller controls: their mistakes show with an eighth of the samples, where that is enough: with 8 instead of 64, a shutter that closes 10 %
/// early passed with 3 of 71 seeds.
const CONTROL_SHARE: u32 = 8;
const FEWEST_OF_CONTROL: u32 = 64;

/// What the pixels of one film should show.
pub(super) struct Exact {
    /// What the abscissa and the value are, with units.
    pub axes: [&'static str; 2],
    /// Abscissa and exact value of each pixel, row by row.
    pub pixels: Vec<[f64; 2]>,
    /// The curve on which they lie.
    pub curve: Vec<[f64; 2]>,
}

impl Exact {
    /// Pixels at `positions`, on the curve of `value`.
    pub(super) fn on_curve(axes: [&'static str; 2], positions: &[f64], value: impl Fn(f64) -> f64) -> Self {
        let pixels: Vec<[f64; 2]> = positions.iter().map(|&x| [x, value(x)]).collect();
        let low = positions.iter().copied().fold(f64::INFINITY, f64::min);
        let high = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let between = |i: u32| low + (high - low) * f64::from(i) / f64::from(CURVE_POINTS);
        let mut curve: Vec<[f64; 2]> =
            (0..=CURVE_POINTS).map(between).map(|x| [x, value(x)]).chain(pixels.iter().copied()).collect();
        curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self { axes, pixels, curve }
    }

    /// Pixels whose values have no common curve: the line joins them.
    pub(super) fn pixels(axes: [&'static str; 2], mut pixels: Vec<[f64; 2]>) -> Self {
        let curve = pixels.clone();
        pixels.shrink_to_fit();
        Self { axes, pixels, curve }
    }
}

/// A claim that films show what they should: the same number of scenes and of exact films.
pub(super) struct Films<P> {
    /// The claim's name.
    pub id: String,
    /// Its sentence.
    pub says: String,
    /// The level from which it runs.
    pub level: Level,
    /// Samples a pixel and replicate.
    pub samples: u32,
    /// The scale of values, in which errors count; also the value of a sample that sees all light.
    pub unit: f64,
    /// Largest error of a pixel, in units of the scale.
    pub bound: f64,
    /// The right parameter of the scenes.
    pub right: P,
    /// Wrong ones, by their mistakes.
    pub wrong: Vec<(&'static str, P)>,
}

impl<P: Copy + Send + Sync + 'static> Films<P> {
    /// The claim; `scenes` makes the films' scenes from a parameter, `exact` what they should show with the right one.
    pub(super) fn claim(
        self,
        scenes: impl Fn(P) -> Vec<SceneDescription> + Send + Sync + 'static,
        exact: impl Fn() -> Vec<Exact> + Send + Sync + 'static,
    ) -> Claim {
        let Self { id, says, level, samples, unit, bound, right, wrong } = self;
        let scenes = Arc::new(scenes);
        let same = scenes.clone();
        let test = Arc::new(LazyLock::new(move || {
            let scenes = same(right).iter().map(built).collect();
            Test { scenes, exact: exact(), samples, unit, bound, first: OnceLock::new() }
        }));
        let mut builder = claim(id, says).bound(bound);
        for (name, parameter) in wrong {
            let (test, scenes) = (test.clone(), scenes.clone());
            builder = builder.rejects(name, move |run| {
                let scenes: Vec<Scene> = scenes(parameter).iter().map(built).collect();
                test.judge(&draw(
                    &scenes,
                    run,
                    (test.samples / CONTROL_SHARE).max(FEWEST_OF_CONTROL.min(test.samples)),
                ))
            });
        }
        let control = test.clone();
        builder
            .rejects("2.2 × resolution", move |run| control.control(run))
            .by(move |run| test.judge(&test.values(run)))
            .from_level(level)
    }
}

/// Scenes with what they should show.
struct Test {
    scenes: Vec<Scene>,
    exact: Vec<Exact>,
    samples: u32,
    unit: f64,
    bound: f64,
    /// The first run with its values, which the control moves.
    first: OnceLock<(Run, Values)>,
}

/// The values of each pixel of each film, one a replicate.
type Values = Vec<Vec<Vec<f64>>>;

impl Test {
    /// The subject's values of a run.
    fn values(&self, run: &Run) -> Cow<'_, Values> {
        let (first, values) = self.first.get_or_init(|| (*run, draw(&self.scenes, run, self.samples)));
        if first == run { Cow::Borrowed(values) } else { Cow::Owned(draw(&self.scenes, run, self.samples)) }
    }

    /// The subject's own values, each moved by 2.2 resolutions.
    fn control(&self, run: &Run) -> Result<Evidence, InputError> {
        let mut values = self.values(run).into_owned();
        let resolution = self.judge(&values)?.resolution.value;
        values.iter_mut().flatten().flatten().for_each(|v| *v += CONTROL_FACTOR * resolution * self.unit);
        self.judge(&values)
    }

    fn judge(&self, values: &Values) -> Result<Evidence, InputError> {
        let (mut claims, mut means) = (Vec::new(), Vec::new());
        let mut pictures = Vec::new();
        for (exact, values) in self.exact.iter().zip(values) {
            if exact.pixels.len() != values.len() {
                let given = values.len() as u64;
                return Err(InputError::TooFew { what: "pixels", given, needed: exact.pixels.len() as u64 });
            }
            for group in groups(&exact.pixels, FEWEST_SAMPLES / f64::from(self.samples), self.unit) {
                let mean = |of: &dyn Fn(usize) -> f64| {
                    group.iter().map(|&i| of(i)).sum::<f64>() / group.len() as f64
                };
                let claim = MeanClaim::in_units_of(self.unit, mean(&|i| exact.pixels[i][1]), self.bound);
                claims.push(MeanClaim { rounding: ROUNDING, ..claim });
                let replicates = 0..values[0].len();
                means.push(replicates.map(|r| Replicate::from(mean(&|i| values[i][r]))).collect());
            }
            pictures.push(self.picture(exact, values));
        }
        let mut evidence = judge(&claims, &means)?;
        evidence.resolution.quantity = "error of a pixel";
        evidence.pictures = pictures;
        Ok(evidence)
    }

    fn picture(&self, exact: &Exact, values: &[Vec<f64>]) -> Picture {
        let point = |(pixel, values): (&[f64; 2], &Vec<f64>)| {
            let replicates: Vec<Replicate> = values.iter().copied().map(Replicate::from).collect();
            let estimate = Estimate::of(&replicates);
            let count = f64::from(self.samples) * values.len() as f64;
            let error = estimate.standard_error.max(self.rare(pixel[1], count)).hypot(ROUNDING * self.unit);
            [pixel[0], estimate.mean, error]
        };
        let measured = exact.pixels.iter().zip(values).map(point).collect();
        Picture::Curve { axes: exact.axes, exact: exact.curve.clone(), measured }
    }

    /// The error that `count` samples leave in a tail, where replicates that all see the same side of an edge do not tell theirs.
    fn rare(&self, exact: f64, count: f64) -> f64 {
        let value = exact / self.unit;
        let share = value.abs().min((1.0 - value).abs());
        if share < FEWEST_SAMPLES / f64::from(self.samples) {
            self.unit * (share / count).sqrt()
        } else {
            0.0
        }
    }
}

fn draw(scenes: &[Scene], run: &Run, samples: u32) -> Values {
    let film = |(stream, scene): (u64, &Scene)| {
        let pixels = scene.film.width as usize * scene.film.height as usize;
        let mut values = vec![Vec::new(); pixels];
        for replicate in 0..FEWEST_REPLICATES * run.effort {
            let seed = derive(run.seed, stream, replicate);
            let rendering = image(scene, SamplerKind::Sobol, samples, seed);
            for (list, pixel) in values.iter_mut().zip(&rendering.pixels) {
                list.push(pixel.mean.iter().sum::<f64>() / 3.0);
            }
        }
        values
    };
    (0..).zip(scenes).map(film).collect()
}

/// Pixels to judge together: one by one where both sides of an edge are seen often enough; in tails so many neighbours that
/// their sum is; all that are wholly dark, and all that are wholly bright, as one each.
///
/// * `enough`: share of light, or of its absence, that a pixel needs to be judged alone.
fn groups(pixels: &[[f64; 2]], enough: f64, unit: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..pixels.len()).collect();
    order.sort_by(|&a, &b| pixels[a][0].total_cmp(&pixels[b][0]));
    let (mut dark, mut bright, mut alone, mut tails) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut tail: (Vec<usize>, f64) = (Vec::new(), 0.0);
    for i in order {
        let value = pixels[i][1] / unit;
        let share = value.abs().min((1.0 - value).abs());
        if value.abs() < ROUNDING {
            dark.push(i);
        } else if (1.0 - value).abs() < ROUNDING {
            bright.push(i);
        } else if share >= enough {
            alone.push(vec![i]);
        } else {
            tail.0.push(i);
            tail.1 += share;
        }
        if tail.1 >= enough {
            tails.push(std::mem::take(&mut tail).0);
        }
    }
    // What is left of the tails is too rare by itself.
    match tails.last_mut().or(alone.last_mut()) {
        Some(neighbour) => neighbour.append(&mut tail.0),
        None => dark.append(&mut tail.0),
    }
    alone.extend(tails);
    alone.extend([dark, bright].into_iter().filter(|group| !group.is_empty()));
    alone
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_judged_together_and_every_pixel_once() {
        let values = [0.0, 0.0, 0.004, 0.004, 0.004, 0.3, 0.9, 0.9999, 1.0];
        let pixels: Vec<[f64; 2]> = (0u32..).zip(values).map(|(i, v)| [f64::from(i), v]).collect();
        let groups = groups(&pixels, 0.01, 1.0);
        assert_eq!(groups, [vec![5], vec![6], vec![2, 3, 4, 7], vec![0, 1], vec![8]]);
    }

    #[test]
    fn a_curve_passes_through_its_pixels() {
        let exact = Exact::on_curve(["x", "y"], &[2.0, 0.5, 1.0], |x| x * x);
        assert_eq!(exact.pixels, [[2.0, 4.0], [0.5, 0.25], [1.0, 1.0]]);
        assert!(exact.pixels.iter().all(|p| exact.curve.contains(p)));
        assert!(exact.curve.windows(2).all(|w| w[0][0] <= w[1][0]));
    }
}
