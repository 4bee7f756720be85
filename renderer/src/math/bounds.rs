//! Axis-aligned boxes in f64.

use glam::{DAffine3, DVec3, Vec3};

/// The smallest and largest coordinates of a set of points; `EMPTY` holds none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// No point at all: the neutral element of `union`.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The box of a set of points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown by `margin` on every side.
    pub fn grown(&self, margin: DVec3) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// The middle, and half of the size.
    pub fn middle_and_half(&self) -> [DVec3; 2] {
        [0.5 * (self.min + self.max), 0.5 * (self.max - self.min)]
    }

    /// Half the surface area.
    pub fn half_area(&self) -> f64 {
        let size = self.max - self.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        let (a, b) = (self.min, self.max);
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
            DVec3::new(pick(1, a.x, b.x), pick(2, a.y, b.y), pick(4, a.z, b.z))
        })
    }

    /// The box of this box's image under an affine map.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        Self::of(self.corners().map(|c| map.transform_point3(c)))
    }

    /// Whether `point` lies in the closed box.
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The coordinates rounded outwards to f32: `[min, max]`.
    pub fn to_f32_outward(&self) -> [Vec3; 2] {
        // `as_vec3` rounds to nearest: where that is inwards, one step outwards makes up for it.
        let [min, max] = [self.min, self.max].map(|side| side.as_vec3());
        [
            Vec3::select(min.as_dvec3().cmpgt(self.min), min.map(f32::next_down), min),
            Vec3::select(max.as_dvec3().cmplt(self.max), max.map(f32::next_up), max),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_its_points_and_nothing_when_empty() {
        let b = Bounds::of([DVec3::ZERO, DVec3::new(1.0, -2.0, 3.0)]);
        assert_eq!((b.min, b.max), (DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 0.0, 3.0)));
        assert!(b.contains(DVec3::new(0.5, -1.0, 3.0)));
        assert!(!Bounds::EMPTY.contains(DVec3::ZERO));
        assert_eq!(Bounds::EMPTY.union(&b), b);
        for b in [b, Bounds { min: b.min - 0.1, max: b.max + 0.1 }] {
            let [low, high] = b.to_f32_outward();
            assert!(low.as_dvec3().cmple(b.min).all() && high.as_dvec3().cmpge(b.max).all());
            let [low, high] = [low.map(f32::next_up), high.map(f32::next_down)].map(|side| side.as_dvec3());
            assert!(low.cmpgt(b.min).all() && high.cmplt(b.max).all(), "no farther than needed");
        }
    }
}
