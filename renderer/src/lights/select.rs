//! Which light to connect to.

use super::Light;

/// All lights of a scene, each chosen with the same probability.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    lights: Vec<Light>,
    background: Option<usize>,
}

impl Lights {
    /// The set of `lights`.
    pub fn new(lights: Vec<Light>) -> Self {
        let background = lights.iter().position(Light::is_background);
        Self { lights, background }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Whether a choice is to be made.
    pub fn needs_choice(&self) -> bool {
        self.lights.len() > 1
    }

    /// Every light.
    pub fn as_slice(&self) -> &[Light] {
        &self.lights
    }

    /// The light of index `light`.
    pub fn get(&self, light: u32) -> &Light {
        &self.lights[light as usize]
    }

    /// The light beyond all shapes, if there is one.
    pub fn background(&self) -> Option<&Light> {
        self.background.map(|i| &self.lights[i])
    }

    /// The light for `u` in [0, 1).
    pub fn choose(&self, u: f32) -> &Light {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "u·n lies in [0, n)")]
        let index = (u * self.lights.len() as f32) as usize;
        &self.lights[index.min(self.lights.len() - 1)]
    }

    /// The probability of each light.
    pub fn pmf(&self) -> f32 {
        1.0 / self.lights.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn the_last_number_below_one_chooses_the_last_light() {
        let light = |r| Light::Constant { radiance: Rgb::splat(r) };
        let lights = Lights::new(vec![light(1.0), light(2.0), light(3.0)]);
        assert_eq!(lights.choose(1.0 - f32::EPSILON / 2.0), &light(3.0));
        assert_eq!(lights.choose(0.0), &light(1.0));
    }
}
