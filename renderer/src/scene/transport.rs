//! Which light paths a scene asks for.

use crate::lights::LightSampling;

/// How light is looked for at a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// By points on lights, and by the material's own directions only where these cannot be connected to.
    Light,
    /// By the material's own directions.
    Material,
    /// By both, weighted by the power heuristic.
    #[default]
    Both,
}

/// What is done at a surface that both reflects and refracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Branch {
    /// Follow both, until a branch's weight falls below 1/64; then as `Fresnel`.
    Both,
    /// Follow one of the two with equal probability, and double its weight.
    Half,
    /// Follow one with the probability of its share of the energy.
    #[default]
    Fresnel,
}

impl Branch {
    /// Every way, with its name in scene files and on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("both", Self::Both), ("half", Self::Half), ("fresnel", Self::Fresnel)];
}

/// Which light paths are followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegratorSettings {
    /// Longest path in edges: 1 sees lights only, 2 adds direct light on surfaces; `None` for no limit.
    pub max_depth: Option<u32>,
    /// Paths of this many edges and more go on only by chance (Russian roulette).
    pub rr_depth: u32,
    /// What is done at a surface that both reflects and refracts.
    pub branch: Branch,
    /// How light is looked for.
    pub strategy: Strategy,
    /// How points on lights are chosen.
    pub light_sampling: LightSampling,
    /// Whether the camera sees no light: neither the sky nor the shapes that emit, but what is behind those.
    pub hide_emitters: bool,
    /// Whether samples of neighbouring pixels share what their paths find at second surfaces, unless the scene has a shutter.
    pub reuse: bool,
    /// Whether paths from lights, too, look for what reaches diffuse first surfaces by way of others (`integrator/light_paths.rs`);
    /// not where the camera sees through shapes that emit.
    pub light_paths: bool,
}

impl IntegratorSettings {
    /// Paths of any length, with Russian roulette from the fifth edge.
    pub const PATH: Self = Self {
        max_depth: None,
        rr_depth: 5,
        branch: Branch::Fresnel,
        strategy: Strategy::Both,
        light_sampling: LightSampling::Auto,
        hide_emitters: false,
        reuse: false,
        light_paths: false,
    };

    /// Lights and direct light only.
    pub const DIRECT: Self = Self { max_depth: Some(2), ..Self::PATH };
}
