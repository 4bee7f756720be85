//! Affine maps that change with time.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use smallvec::SmallVec;
use wide::f64x8;

use crate::ParamError;
use crate::math::bounds::Bounds;
use crate::math::eight::DVec3x8;

/// A keyed transform: between two keys the translation and the scale-and-shear part are interpolated linearly and the
/// rotation turns at constant speed the short way round; before the first and after the last key it rests.
///
/// Each key M is split as T·R·S with S symmetric (polar decomposition), so that rigid motions stay rigid.
///
/// # Source
/// Shoemake, Duff 1992, Matrix Animation and Polar Decomposition. Mitsuba 3 gives `animation` this meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    keys: Vec<Key>,
    /// The ways between keys, if they shift and do nothing else: by the keys themselves a moving render takes 4 % longer.
    ways: SmallVec<[Way; 1]>,
}

/// A shift at constant speed from one place to another, with rest before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Way {
    start: f64,
    /// How long it takes; for ever where nothing changes.
    length: f64,
    from: DVec3,
    to: DVec3,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Key {
    time: f64,
    affine: DAffine3,
    translation: DVec3,
    rotation: DQuat,
    stretch: DMat3,
    /// The inverse of the affine map's matrix.
    inverse: DMat3,
    /// Whether nothing, or only the translation, changes until the next key.
    rests: bool,
    shifts: bool,
}

/// A map of a motion, ready to be applied both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The map.
    pub map: DAffine3,
    /// The inverse of its matrix.
    pub inverse: DMat3,
}

/// Largest turn of a piece of the motion whose ends' boxes are joined [rad]: the joint box is then padded by at most
/// (π/16)²/8 = 0.5 % of the body's radius.
const PIECE_TURN: f64 = std::f64::consts::PI / 16.0;

impl Motion {
    /// The motion that rests at `affine`.
    ///
    /// # Errors
    /// As `keyed`.
    pub fn fixed(affine: DAffine3) -> Result<Self, ParamError> {
        Self::keyed(vec![(0.0, affine)])
    }

    /// The motion through `keys`, pairs of a time and a transform; times rise strictly.
    ///
    /// # Errors
    /// `Empty` without keys, `NotFinite`, `OutOfRange` for times that don't rise or a reflection at some keys
    /// only, `Singular`.
    pub fn keyed(keys: Vec<(f64, DAffine3)>) -> Result<Self, ParamError> {
        if keys.is_empty() {
            return Err(ParamError::Empty { name: "motion", accepted: "at least one keyed transform" });
        }
        let mut keys =
            keys.into_iter().map(|(time, affine)| Key::new(time, affine)).collect::<Result<Vec<_>, _>>()?;
        for pair in keys.windows(2) {
            if pair[1].time <= pair[0].time {
                let accepted = "a time after the key before it";
                return Err(ParamError::OutOfRange { name: "key time", value: pair[1].time, accepted });
            }
            let handedness = pair[0].affine.matrix3.determinant() * pair[1].affine.matrix3.determinant();
            if handedness < 0.0 {
                let (name, accepted) =
                    ("product of two keys' determinants", "a reflection at all keys or at none");
                return Err(ParamError::OutOfRange { name, value: handedness, accepted });
            }
        }
        for key in 1..keys.len() {
            let [from, to] = [keys[key - 1].affine, keys[key].affine];
            keys[key - 1].rests = from == to;
            keys[key - 1].shifts = from.matrix3 == to.matrix3;
        }
        let shifts = keys.iter().all(|key| key.affine.matrix3 == DMat3::IDENTITY);
        let ways = if shifts { Way::between(&keys) } else { SmallVec::new() };
        Ok(Self { keys, ways })
    }

    /// Whether every moment has the same transform.
    pub fn is_static(&self) -> bool {
        self.keys.iter().all(|k| k.affine == self.keys[0].affine)
    }

    /// The transform at `time`.
    ///
    /// A key's own transform comes back bit for bit at the key's time, and at all times if all keys are equal.
    pub fn at(&self, time: f64) -> DAffine3 {
        self.found(time).0
    }

    /// What `at(time)` gives with its inverse, which is made once where only the translation changes.
    pub fn pose(&self, time: f64) -> Pose {
        let (map, inverse) = self.found(time);
        Pose { map, inverse: inverse.unwrap_or_else(|| map.matrix3.inverse()) }
    }

    /// The transform at `time`, and the inverse of its matrix where that is a key's.
    #[inline]
    fn found(&self, time: f64) -> (DAffine3, Option<DMat3>) {
        let (from, to) = self.segment(time);
        let Some(to) = to else { return (from.affine, Some(from.inverse)) };
        let map = from.mix(to, (time - from.time) / (to.time - from.time));
        (map, from.shifts.then_some(from.inverse))
    }

    /// The translation at `time`, if the map never does anything else: as `at`, from a few numbers.
    #[inline]
    pub fn offset(&self, time: f64) -> Option<DVec3> {
        let (mut way, others) = self.ways.split_first()?;
        for other in others.iter().take_while(|other| other.start <= time) {
            way = other;
        }
        Some(way.from.lerp(way.to, way.done(time)))
    }

    /// `offset` of eight times, bit for bit.
    #[inline]
    pub fn offset_eight(&self, time: f64x8) -> Option<DVec3x8> {
        let mut offset = self.ways.first()?.eight(time);
        for way in self.ways.iter().skip(1) {
            offset = offset.replaced(time.simd_ge(f64x8::splat(way.start)), way.eight(time));
        }
        Some(offset)
    }

    /// The map at `time`, and the motion of what it maps, if nothing but the translation changes.
    pub fn shift_from(&self, time: f64) -> Option<(DAffine3, Self)> {
        let start = self.at(time);
        let shifts = self.keys.iter().all(|key| key.affine.matrix3 == start.matrix3);
        let step = |key: &Key| (key.time, DAffine3::from_translation(key.translation - start.translation));
        let shift = shifts.then(|| Self::keyed(self.keys.iter().map(step).collect()).ok())??;
        Some((start, shift))
    }

    /// The key before `time` and the one after; without the latter the motion rests at the former.
    #[inline]
    fn segment(&self, time: f64) -> (&Key, Option<&Key>) {
        match self.keys.partition_point(|k| k.time <= time) {
            0 => (&self.keys[0], None),
            after => (&self.keys[after - 1], self.keys.get(after)),
        }
    }

    /// The map followed by `outer`, at all times.
    ///
    /// Rotation and translation of `outer` commute with the interpolation; a scale doesn't in general.
    ///
    /// # Errors
    /// As `keyed`.
    pub fn then(&self, outer: &DAffine3) -> Result<Self, ParamError> {
        Self::keyed(self.keys.iter().map(|k| (k.time, *outer * k.affine)).collect())
    }

    /// A box that holds the image of `body` at every time in `[open, close]`.
    pub fn swept(&self, body: &Bounds, [open, close]: [f64; 2]) -> Bounds {
        let (times, margin) = self.pieces(body, [open, close]);
        let join = |all: Bounds, &time: &f64| all.union(&body.transformed(&self.at(time)));
        grown_by_rounding(times.iter().fold(Bounds::EMPTY, join).grown(DVec3::splat(margin)))
    }

    /// Two boxes, for `open` and for `close`, such that the box interpolated between them by time holds the image of
    /// `body` at every time in between.
    ///
    /// They are the body's own boxes at the two ends, grown alike by what the body's box at any end of a piece reaches
    /// beyond the interpolated one, and by what a piece may leave its chord. For a translation at constant speed that
    /// is nothing.
    pub fn interpolated(&self, body: &Bounds, [open, close]: [f64; 2]) -> [Bounds; 2] {
        let at = |time| body.transformed(&self.at(time));
        let ends = [at(open), at(close)];
        let (times, margin) = self.pieces(body, [open, close]);
        let (mut below, mut above) = (DVec3::ZERO, DVec3::ZERO);
        for time in times {
            let s = if open < close { (time - open) / (close - open) } else { 0.0 };
            let own = at(time);
            below = below.max(ends[0].min.lerp(ends[1].min, s) - own.min);
            above = above.max(own.max - ends[0].max.lerp(ends[1].max, s));
        }
        ends.map(|end| {
            grown_by_rounding(Bounds { min: end.min - below - margin, max: end.max + above + margin })
        })
    }

    /// Times that cut `[open, close]` into pieces on which the body's points leave their chords by at most the length
    /// that is returned too.
    ///
    /// On a piece of h of a segment's unit parameter s, a point p(s) = T + R·S·x leaves the chord between the piece's
    /// ends by at most h²/8 · max|p''|, and |p''| ≤ ω²|S·x| + 2ω|S'·x| with ω the segment's turn.
    fn pieces(&self, body: &Bounds, [open, close]: [f64; 2]) -> (Vec<f64>, f64) {
        let (mut times, mut margin) = (vec![open, close], 0.0f64);
        for pair in self.keys.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let (a, b) = (open.max(from.time), close.min(to.time));
            if a >= b || from.affine == to.affine {
                continue;
            }
            let share = (b - a) / (to.time - from.time);
            let turn = turn_between(from.rotation, to.rotation);
            let pieces = (share * turn / PIECE_TURN).ceil().max(1.0);
            let h = share / pieces;
            let largest = |m: &DMat3| body.corners().iter().map(|c| (*m * *c).length()).fold(0.0, f64::max);
            let radius = largest(&from.stretch).max(largest(&to.stretch));
            let growth = largest(&(to.stretch - from.stretch));
            margin = margin.max(h * h / 8.0 * (turn * turn * radius + 2.0 * turn * growth));
            let mut piece = 0.0;
            while piece <= pieces {
                times.push(a + (b - a) * (piece / pieces));
                piece += 1.0;
            }
        }
        (times, margin)
    }
}

impl Way {
    /// The ways between keys that do nothing but shift.
    fn between(keys: &[Key]) -> SmallVec<[Self; 1]> {
        let way = |pair: &[Key]| Self {
            start: pair[0].time,
            length: if pair[0].rests { f64::INFINITY } else { pair[1].time - pair[0].time },
            from: pair[0].translation,
            to: pair[1].translation,
        };
        match keys {
            [key] => {
                let place = key.translation;
                SmallVec::from([Self { start: key.time, length: f64::INFINITY, from: place, to: place }])
            }
            _ => keys.windows(2).map(way).collect(),
        }
    }

    /// Which part of it is done at `time`.
    #[inline]
    fn done(&self, time: f64) -> f64 {
        ((time - self.start) / self.length).clamp(0.0, 1.0)
    }

    /// The places at eight times.
    #[inline]
    fn eight(&self, time: f64x8) -> DVec3x8 {
        let done = (time - f64x8::splat(self.start)) / f64x8::splat(self.length);
        let done = done.fast_max(f64x8::ZERO).fast_min(f64x8::ONE);
        DVec3x8::splat(self.from) * (f64x8::ONE - done) + DVec3x8::splat(self.to) * done
    }
}

/// Composition in f64 rounds each coordinate within a few units of 2⁻⁵³ of the largest one.
fn grown_by_rounding(bounds: Bounds) -> Bounds {
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    bounds.grown(DVec3::splat(largest * f64::EPSILON * 32.0))
}

impl Key {
    fn new(time: f64, affine: DAffine3) -> Result<Self, ParamError> {
        if !time.is_finite() {
            return Err(ParamError::NotFinite { name: "key time", value: time });
        }
        check_affine("transform", &affine)?;
        let (rotation, stretch) = polar(affine.matrix3);
        let (translation, inverse) = (affine.translation, affine.matrix3.inverse());
        Ok(Self { time, affine, translation, rotation, stretch, inverse, rests: false, shifts: false })
    }

    fn mix(&self, to: &Self, s: f64) -> DAffine3 {
        if s <= 0.0 || self.rests {
            return self.affine;
        }
        if s >= 1.0 {
            return to.affine;
        }
        let translation = self.translation.lerp(to.translation, s);
        if self.shifts {
            return DAffine3 { matrix3: self.affine.matrix3, translation };
        }
        let stretch = self.stretch * (1.0 - s) + to.stretch * s;
        let rotation = slerp(self.rotation, to.rotation, s);
        DAffine3 { matrix3: DMat3::from_quat(rotation) * stretch, translation }
    }
}

/// Refuses a transform that isn't finite or that flattens space.
///
/// Singular means that |det M| ≤ 2⁻⁴⁰ |a||b||c| over M's columns: below that the f32 geometry has no volume left.
///
/// # Errors
/// `NotFinite`, `Singular`.
pub fn check_affine(name: &'static str, affine: &DAffine3) -> Result<(), ParamError> {
    if let Some(&value) = affine.to_cols_array().iter().find(|v| !v.is_finite()) {
        return Err(ParamError::NotFinite { name, value });
    }
    let m = affine.matrix3;
    let scale = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let determinant = m.determinant();
    // Written so that NaN, from products that overflow, is refused too.
    if determinant.abs() > scale * 2f64.powi(-40) {
        Ok(())
    } else {
        Err(ParamError::Singular { name, determinant })
    }
}

/// M = R·S with R a proper rotation and S symmetric: definite, negative if M reflects.
///
/// Newton's iteration R ← (R + R⁻ᵀ)/2 converges quadratically from any invertible matrix.
///
/// # Source
/// Higham 1986, Computing the Polar Decomposition, DOI 10.1137/0907079.
fn polar(m: DMat3) -> (DQuat, DMat3) {
    let mut r = m;
    // From condition 2⁴⁰, forty halvings and six quadratic steps end at the rounding level.
    for _ in 0..64 {
        let next = (r + r.inverse().transpose()) * 0.5;
        let change = (next - r).to_cols_array().iter().fold(0.0f64, |a, x| a.max(x.abs()));
        r = next;
        if change <= 4.0 * f64::EPSILON {
            break;
        }
    }
    let r = if r.determinant() < 0.0 { -r } else { r };
    let s = r.transpose() * m;
    (DQuat::from_mat3(&r).normalize(), (s + s.transpose()) * 0.5)
}

/// The angle of the rotation from `a` to `b`, the short way: in [0, π].
fn turn_between(a: DQuat, b: DQuat) -> f64 {
    2.0 * half_turn(a, if a.dot(b) < 0.0 { -b } else { b })
}

/// The angle between two unit quaternions, exact to rounding at 0 and at π/2 alike.
fn half_turn(a: DQuat, b: DQuat) -> f64 {
    2.0 * libm::atan2((b - a).length(), (a + b).length())
}

/// Turns from `a` to `b` the short way at constant speed.
fn slerp(a: DQuat, b: DQuat, s: f64) -> DQuat {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let angle = half_turn(a, b);
    if angle == 0.0 {
        return a;
    }
    let mixed = a * libm::sin((1.0 - s) * angle) + b * libm::sin(s * angle);
    mixed.normalize()
}
