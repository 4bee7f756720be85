//! The first idea: a random choice has a name, and asks for its numbers by that name.

/// What is decided by chance along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Decision {
    /// Where in the pixel's filter.
    Pixel,
    /// Where on the lens.
    Lens,
    /// When in the shutter.
    Time,
    /// Which light.
    LightChoice,
    /// Where on that light.
    LightPoint,
    /// Which lobe of the material: reflection or refraction, for example.
    Lobe,
    /// Which direction in that lobe.
    Direction,
    /// Whether the path goes on.
    Roulette,
}

impl Decision {
    /// Every decision, in the order of their dimensions in a joint sequence.
    pub const ALL: [Self; 8] = [
        Self::Pixel,
        Self::Lens,
        Self::Time,
        Self::LightChoice,
        Self::LightPoint,
        Self::Lobe,
        Self::Direction,
        Self::Roulette,
    ];

    /// How many numbers the decision takes: 1 or 2.
    pub const fn dimensions(self) -> usize {
        match self {
            Self::Pixel | Self::Lens | Self::LightPoint | Self::Direction => 2,
            Self::Time | Self::LightChoice | Self::Lobe | Self::Roulette => 1,
        }
    }
}

/// Which decisions are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DecisionSet(u8);

impl DecisionSet {
    /// No decision.
    pub const EMPTY: Self = Self(0);
    /// Every decision.
    pub const FULL: Self = Self(u8::MAX);

    /// This set and `decision`.
    #[must_use]
    pub const fn with(self, decision: Decision) -> Self {
        Self(self.0 | 1 << decision as u8)
    }

    /// Whether `decision` is in the set.
    pub const fn contains(self, decision: Decision) -> bool {
        self.0 & 1 << decision as u8 != 0
    }

    /// The decisions in the set, in the order of [`Decision::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Decision> {
        Decision::ALL.into_iter().filter(move |&d| self.contains(d))
    }
}

/// A place along a path: numbers at two different vertices share nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Vertex {
    /// Surface hits before this one: 0 at the camera and at the first hit.
    pub bounce: u16,
    /// Which of several samples taken at this vertex.
    pub split: u16,
    /// Which branch of a path that forks: 0 on a path without a fork.
    pub branch: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in() {
        let set = DecisionSet::EMPTY.with(Decision::Time).with(Decision::Pixel);
        assert_eq!(set.iter().collect::<Vec<_>>(), [Decision::Pixel, Decision::Time]);
        assert!(!set.contains(Decision::Lens));
        assert_eq!(DecisionSet::FULL.iter().count(), Decision::ALL.len());
    }
}
