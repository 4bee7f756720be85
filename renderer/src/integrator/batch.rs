//! The third idea: work comes in batches.

use super::reuse::Reuse;
use crate::interaction::Interaction;
use crate::math::Rgb;
use crate::ray::{Hit, Ray};
use crate::sampling::{Decision, Place, SampleId, Sampler, Vertex};

/// One sample of a pixel, on its way from a place on the film to a radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Which sample it is.
    pub id: SampleId,
    /// Which samples of the batch it shares with: those of the same set.
    pub set: u32,
    /// Position on the film in pixels from the upper left corner.
    pub position: [f64; 2],
    /// The filter's signed weight there.
    pub weight: f32,
    /// When it sees the scene.
    pub time: f32,
    /// Where on the unit disk its ray crosses the lens, the middle without a lens; of a meter the numbers of its direction.
    pub lens: [f32; 2],
    /// Radiance [W m⁻² sr⁻¹] found so far.
    pub radiance: Rgb,
}

impl Sample {
    /// What it adds to its pixel.
    pub fn weighted(&self) -> Rgb {
        self.radiance * self.weight
    }
}

/// A light path being followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// Index of its sample in the batch.
    pub sample: u32,
    /// Where along the path it is.
    pub vertex: Vertex,
    /// The ray to follow next.
    pub ray: Ray,
    /// What a unit of radiance found along the ray contributes to the sample.
    pub throughput: Rgb,
    /// Product of eta² over the refractions so far: the throughput without the squeezing of solid angles.
    pub eta_scale: f32,
    /// Density per steradian with which the ray's direction was drawn; `None` for the camera and for delta lobes,
    /// which a light sample cannot replace.
    pub pdf: Option<f32>,
    /// For a path that has left a diffuse first surface and met no other one: how many times as often paths from lights find
    /// what it may find, up to the density of their start (`integrator/light_paths.rs`); else 0.
    pub odds: f32,
}

impl Path {
    /// The path after its next surface, along `ray` with the weight `weight`; `None` if nothing would come of it.
    ///
    /// * `eta2`: by which refraction there squeezes solid angles; * `pdf`, `branch`, `odds`: of the new path.
    #[inline]
    pub fn along(
        &self,
        ray: Ray,
        weight: Rgb,
        eta2: f32,
        pdf: Option<f32>,
        branch: u32,
        odds: f32,
    ) -> Option<Self> {
        let throughput = self.throughput * weight;
        let vertex = Vertex { bounce: self.vertex.bounce.saturating_add(1), branch, split: 0 };
        (!throughput.is_black()).then_some(Self {
            sample: self.sample,
            vertex,
            ray,
            throughput,
            eta_scale: self.eta_scale * eta2,
            pdf,
            odds,
        })
    }
}

/// A path's hit, ready for shading.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surface {
    /// Index of the path in the batch.
    pub path: u32,
    /// Where along the path's ray, and on what.
    pub hit: Hit,
    /// The point hit.
    pub interaction: Interaction,
}

/// A light point waiting for its shadow ray.
#[derive(Debug, Clone, Copy)]
pub struct Connection {
    /// Index of its sample in the batch.
    pub sample: u32,
    /// What it adds to the sample if nothing is in the way.
    pub contribution: Rgb,
}

/// Samples that travel together, and the working lists of the stages.
#[derive(Debug, Default)]
pub struct Batch {
    /// The samples.
    pub samples: Vec<Sample>,
    /// Indices of the samples, in the order in which their paths begin.
    pub order: Vec<u32>,
    /// Paths to follow next.
    pub paths: Vec<Path>,
    /// Room for those after them.
    pub next: Vec<Path>,
    /// Numbers for a stage's decisions.
    pub draws: Draws,
    /// Hits found for them.
    pub hits: Vec<Option<Hit>>,
    /// The hits to shade.
    pub surfaces: Vec<Surface>,
    /// Light points to connect to.
    pub connections: Vec<Connection>,
    /// Their shadow rays.
    pub shadow_rays: Vec<Ray>,
    /// Whether something is in the way.
    pub blocked: Vec<bool>,
    /// Rays, in the order of `paths`.
    pub rays: Vec<Ray>,
    /// Surfaces of samples that share.
    pub reuse: Reuse,
    /// Contributions left out because they were not finite.
    pub dropped: u64,
}

/// Numbers for the decisions of a stage.
#[derive(Debug, Default)]
pub struct Draws {
    /// What they are for.
    pub places: Vec<Place>,
    /// Of a decision of one dimension, one for each place.
    pub choices: Vec<f32>,
    /// Of a decision of two dimensions, one for each place.
    pub points: Vec<[f32; 2]>,
}

impl Draws {
    /// Asks for each sample before its first bounce.
    pub fn at_camera(&mut self, samples: &[Sample]) {
        self.places.clear();
        self.places.extend(samples.iter().map(|s| Place { sample: s.id, vertex: Vertex::default() }));
    }

    /// Asks for the path at each of `surfaces`.
    pub fn at_surfaces<'a>(
        &mut self,
        surfaces: impl Iterator<Item = &'a Surface>,
        paths: &[Path],
        samples: &[Sample],
    ) {
        let place = |surface: &Surface| {
            let path = &paths[surface.path as usize];
            Place { sample: samples[path.sample as usize].id, vertex: path.vertex }
        };
        self.places.clear();
        self.places.extend(surfaces.map(place));
    }

    /// Numbers for a decision of one dimension at the places asked for; zeros if nobody makes it.
    #[inline]
    pub fn choices<S: Sampler>(&mut self, sampler: &S, decision: Decision, is_made: bool) {
        if is_made {
            sampler.draw_1d_each(&self.places, decision, &mut self.choices);
        } else {
            self.choices.clear();
            self.choices.resize(self.places.len(), 0.0);
        }
    }

    /// Numbers for a decision of two dimensions, likewise.
    #[inline]
    pub fn points<S: Sampler>(&mut self, sampler: &S, decision: Decision, is_made: bool) {
        if is_made {
            sampler.draw_2d_each(&self.places, decision, &mut self.points);
        } else {
            self.points.clear();
            self.points.resize(self.places.len(), [0.0; 2]);
        }
    }
}

impl Batch {
    /// Takes everything out.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.paths.clear();
    }

    /// Puts in samples, each with its set.
    pub fn extend(&mut self, samples: impl Iterator<Item = (u32, SampleId)>) {
        self.samples.extend(samples.map(|(set, id)| Sample {
            id,
            set,
            position: [0.0; 2],
            weight: 1.0,
            time: 0.0,
            lens: [0.0; 2],
            radiance: Rgb::BLACK,
        }));
    }

    /// Adds a contribution to a sample, or counts it as dropped if it, or what it adds up to, is not finite.
    pub fn add(&mut self, sample: u32, contribution: Rgb) {
        let radiance = &mut self.samples[sample as usize].radiance;
        let sum = *radiance + contribution;
        if sum.is_finite() {
            *radiance = sum;
        } else {
            self.dropped += 1;
        }
    }

    /// Makes samples black that are not finite once they are weighed, and counts them as dropped.
    pub fn drop_infinite(&mut self) {
        for sample in &mut self.samples {
            if !sample.weighted().is_finite() {
                self.dropped += 1;
                sample.radiance = Rgb::BLACK;
            }
        }
    }
}
