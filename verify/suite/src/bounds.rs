//! Every bound of every claim. One is raised only with the derivation of its new value in the commit.

/// Largest RMS relative error over cells of a sampled distribution.
///
/// About 2.2e6 samples on 200 cells settle 1 %: the error that counts alone make, √(cells / n), is then ten times below it.
pub const DISTRIBUTION: f64 = 0.01;

/// Largest share of points at which a function may differ from its closed form, or an inverse miss, by more than rounding.
///
/// Right functions never do; 76,000 points without a miss settle it.
pub const MISSES: f64 = 1e-4;

/// Largest relative error of an irradiance against its closed form.
pub const IRRADIANCE: f64 = 0.002;

/// Largest RMS relative error over cells of what the camera decides, recorded from renders; half as sharp as a distribution's own claim, whose
/// points cost a tenth as much. What counts resolve goes as the root of them: 0.2 % over cells would take a hundred times as many.
pub const RECORDED: f64 = 0.02;

/// Largest error of a filter's weighted moments, in units of the moment of 1.
pub const FILTER_MOMENT: f64 = 0.002;

/// Largest difference of two renders that should have the same mean, relative to it.
pub const RELATION: f64 = 0.002;

/// The same where little time is spent, at the quick level and on what a finer claim shows of a simpler scene: a room seen along paths of up to
/// four edges, of whose mean 2,048 samples a replicate leave an error of 1 %. Points on lights alone, directions alone, independent samples and
/// six lights together would take fifty times as many for a tenth of it.
pub const RELATION_QUICK: f64 = 0.02;

/// Largest difference of a row or column between paths that neighbours share and paths of their own, relative to the image's mean, in a room
/// without direct light on what is seen: all of an image's light is shared there, and faults in sharing it move a tenth of it and more.
pub const SHARED: f64 = 0.1;

/// Largest difference of a row or column between paths from both ends and from the camera alone, relative to the image's mean.
pub const CAUSTIC: f64 = 0.1;

/// Largest difference of two ways to estimate the same direct light, relative to it.
pub const ESTIMATORS: f64 = 0.002;

/// Largest difference between the mean of a scene's image and Mitsuba's, in percent of it.
pub const IMAGE_PERCENT: f64 = 0.5;

/// Largest relative error of the bias that a comparison finds between images of known difference.
pub const COMPARED_BIAS: f64 = 0.01;

/// Largest RMS relative error over cells of the points on a light and of the directions of a lobe.
///
/// 2.3e5 samples on 200 cells settle 3 %; their maps are built from those of `warp`, which are held to 1 %. 0.2 % over cells would take 225
/// times as many; what means show of the same lobes is held to that ([`MASS`], [`ALBEDO`], [`FURNACE`]).
pub const LOBE: f64 = 0.03;

/// Largest relative error of a solid angle that samples of a light add up to.
pub const SOLID_ANGLE: f64 = 0.005;

/// Largest difference between the share of dropped directions and what a density's integral leaves for it.
///
/// A share p of n directions has an error of √(p/n); of 4,096 in each of 32 replicates at a tenth dropped, 0.08 %, and limits of 5 of them; jittered in a square, several
/// times less.
pub const MASS: f64 = 0.002;

/// Largest relative error of a mean weight against the integral of f·cos θ.
pub const ALBEDO: f64 = 0.002;

/// Largest relative error of a mean of Fresnel's reflectance, and of light that passes a slab.
pub const FRESNEL: f64 = 0.002;

/// Largest relative difference between the means of two ways to treat a surface that reflects and refracts.
pub const BRANCH: f64 = 0.002;

/// The same at the quick level: weights of one of two halves double at each boundary, whose noise takes sixteen times the samples for the above.
pub const BRANCH_QUICK: f64 = 0.005;

/// Largest relative error of a furnace's radiance.
pub const FURNACE: f64 = 0.002;

/// The same for a scene of inter-reflections, whose noise at equal time is more than twice that of the others.
pub const INTER_REFLECTION_PERCENT: f64 = 1.0;

/// The same of the maps to other shapes than the disk, for a quarter of the time: about 5.3e5 samples.
pub const SHAPES: f64 = 0.02;

/// Largest error of a slope of ln RMSE against ln N.
///
/// 600 replicates at each of four sample counts that are spaced by 4 leave a standard error of 0.32/√1200 = 0.009 and limits of 3.3 of them; the rest
/// is for the estimate.
pub const SLOPE: f64 = 0.06;

/// Largest relative error of the variance of a sampler's means against the exact variance of its family.
///
/// A variance from 4,096 replicates has the relative standard error √(2/4096) = 2.2 %; six of them at once have limits of 4.3 such errors.
pub const VARIANCE: f64 = 0.2;

/// Largest relative error of a sampler's mean discrepancy against that of its family; 4,096 replicates as for variances.
pub const DISCREPANCY: f64 = 0.1;

/// Largest RMS relative error over cells of a generator's single numbers; half as sharp as that of pairs, which contain them.
pub const GENERATOR: f64 = 0.02;

/// Largest RMS relative error over cells of one number or point of a sampler over its randomisations.
pub const MARGINAL: f64 = 0.02;

/// Largest relative error of the variance that decisions take part in.
pub const TOTAL_EFFECT: f64 = 0.03;

/// Largest relative error of the mean of an integrand over stratified or low-discrepancy points.
pub const MEAN: f64 = 0.002;

/// Largest relative error of the mean of an integrand over independent points: 10⁶ of them have an error of σ/μ/1000 = 0.1 %.
pub const MEAN_INDEPENDENT: f64 = 0.01;

/// Largest share of point sets that are not as even as they should be; 7,600 sets without a miss settle it.
pub const UNEVEN: f64 = 1e-3;

/// Largest correlation between two numbers that have nothing to do with each other.
///
/// Of about 700 pairs of streams the rarest, at the third bounce, are seen 1,750 times, with standard errors of 1/√1750 = 0.024. Limits are 5.0 of
/// them from an estimate; 5.5 more are left to the largest estimate, which is beyond that once in 40,000 runs.
pub const CORRELATION: f64 = 0.25;

/// Smallest distance of a linear complexity from theory's that is not tolerated: of random bits one of 16 or more has probability 2·4^−16 = 5e-10.
pub const LINEAR_COMPLEXITY: f64 = 16.0;

/// Largest relative difference between the means of a scene and of the same scene far away, scaled or mirrored.
pub const INVARIANCE: f64 = 0.002;

/// Largest error of a pixel against its exact value, in units of the brightest.
pub const PIXEL: f64 = 0.002;

/// The same at the quick level, whose images are a few hundredths of the work.
pub const PIXEL_QUICK: f64 = 0.02;

/// Largest error of the variance of an image of constant light, relative: tables of the filter leave weights off by 0.5 % next to a root.
pub const WEIGHT_VARIANCE: f64 = 0.02;

/// Largest error of the bias of the weighted average, in units of the bias.
pub const RATIO_BIAS: f64 = 0.2;

/// Largest relative error of the flux of a film, and of the second moment of an image out of focus.
pub const FLUX: f64 = 0.002;

/// Largest error of the variance of picking a branch, in units of that of two halves.
///
/// The variance of 32 images of 1,024 pixels has a relative standard error of up to √(2/32768) = 0.8 %.
pub const BRANCH_VARIANCE: f64 = 0.02;

/// Largest relative error of an integrating sphere's radiance.
pub const INTEGRATING_SPHERE: f64 = 0.002;

/// Largest relative error of the number of rays under roulette.
pub const ROULETTE: f64 = 0.002;

/// Largest difference between a variance and twice that of twice the samples, relative.
///
/// A variance from 480 pairs of images of 64 pixels, some much noisier than others, has a relative standard error of about 1.2 %, a difference 1.7 %.
pub const HALVED: f64 = 0.1;
