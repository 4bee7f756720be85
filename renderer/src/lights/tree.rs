//! A tree over lights, by which one is chosen about in proportion to what it can send to a point.

use glam::Vec3;

/// What is known of a light, or of all lights below a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Middle and radius of a ball that holds the lights.
    pub(super) middle: Vec3,
    pub(super) radius: f32,
    /// Unit vector, and the cosine of the angle around it that holds all normals; −1 for any direction.
    pub(super) axis: Vec3,
    pub(super) cos: f32,
    /// Radiant intensity along the normal, L·A, averaged over channels.
    pub(super) intensity: f32,
}

/// Least cosine that a light counts with: lights that seem to face away keep a chance, whatever rounding does.
const LEAST_COS: f32 = 1e-3;

/// What a light counts with at most: two of them add up to a number. (And at least with the smallest normal one, so that no
/// light's chance underflows to 0.)
const LARGEST: f32 = f32::MAX / 4.0;

impl Extent {
    /// A bound on the cosine at the lights over the squared distance, times their intensity.
    ///
    /// With the angle t between axis and direction, o of the normals around the axis, and b that the ball fills, no
    /// normal is closer to the direction than t − o − b.
    #[inline]
    fn importance(&self, from: Vec3) -> f32 {
        let to = from - self.middle;
        let (d2, r2) = (to.length_squared(), self.radius * self.radius);
        let least = (self.intensity / d2.max(r2).max(f32::MIN_POSITIVE)).clamp(f32::MIN_POSITIVE, LARGEST);
        if self.cos <= -1.0 || d2 <= r2 {
            return least;
        }
        let cos_t = self.axis.dot(to) / d2.sqrt();
        let (cos_o, cos_b) = (self.cos, (1.0 - r2 / d2).sqrt());
        let sine = |cos: f32| (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_o, sin_b) = (sine(cos_o), sine(cos_b));
        // The angle o + b; beyond a half turn, or beyond t, some normal may point here.
        let (cos_ob, sin_ob) = (cos_o * cos_b - sin_o * sin_b, sin_o * cos_b + cos_o * sin_b);
        if sin_ob < 0.0 || cos_t >= cos_ob {
            return least;
        }
        least * (cos_t * cos_ob + sine(cos_t) * sin_ob).max(LEAST_COS)
    }

    /// What holds both.
    fn union(&self, other: &Self) -> Self {
        let (large, small) = if self.radius >= other.radius { (self, other) } else { (other, self) };
        let apart = small.middle - large.middle;
        let distance = apart.length();
        let holds = distance + small.radius <= large.radius;
        let radius = if holds { large.radius } else { 0.5 * (distance + large.radius + small.radius) };
        let shift = if holds { 0.0 } else { (radius - large.radius) / distance };
        let (axis, cos) = cones([(self.axis, self.cos), (other.axis, other.cos)]);
        Self {
            middle: large.middle + apart * shift,
            // Sums round; no light may stick out.
            radius: radius * (1.0 + 4.0 * f32::EPSILON),
            axis,
            cos,
            intensity: self.intensity + other.intensity,
        }
    }
}

/// A cone around both: their mean axis, and the wider of the angles from it to the farther rims.
fn cones([(a, cos_a), (b, cos_b)]: [(Vec3, f32); 2]) -> (Vec3, f32) {
    let any = (Vec3::Z, -1.0);
    let Some(axis) = (a + b).try_normalize() else { return any };
    let angle =
        |v: Vec3, cos: f32| libm::acosf(axis.dot(v).clamp(-1.0, 1.0)) + libm::acosf(cos.clamp(-1.0, 1.0));
    let widest = angle(a, cos_a).max(angle(b, cos_b)) + 1e-3;
    if cos_a <= -1.0 || cos_b <= -1.0 || widest >= std::f32::consts::PI {
        any
    } else {
        (axis, libm::cosf(widest))
    }
}

#[derive(Debug, Clone, Copy)]
struct Node {
    extent: Extent,
    /// Of an inner node the second child's index, the first being the next node; of a leaf the light, and `LEAF`.
    next: u32,
}

const LEAF: u32 = 1 << 31;

/// The tree.
#[derive(Debug, Clone, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// For each light that is in the tree, whether its way goes to the second child, from the root on, lowest bit first.
    ways: Vec<u64>,
}

impl Tree {
    /// The tree over lights with their indices; fewer than 2³¹.
    pub(super) fn new(mut lights: Vec<(u32, Extent)>, count: usize) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * lights.len()), ways: vec![0; count] };
        if !lights.is_empty() {
            tree.build(&mut lights, 0, 0);
        }
        tree
    }

    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Halves the lights along the longest side of their middles' box: at most 31 levels.
    fn build(&mut self, lights: &mut [(u32, Extent)], way: u64, level: u32) -> Extent {
        let index = self.nodes.len();
        if let [(light, extent)] = *lights {
            self.nodes.push(Node { extent, next: LEAF | light });
            self.ways[light as usize] = way;
            return extent;
        }
        let least = lights.iter().fold(Vec3::INFINITY, |p, (_, e)| p.min(e.middle));
        let most = lights.iter().fold(Vec3::NEG_INFINITY, |p, (_, e)| p.max(e.middle));
        let axis = (most - least).max_position();
        lights.sort_by(|(_, a), (_, b)| a.middle[axis].total_cmp(&b.middle[axis]));
        self.nodes.push(Node { extent: lights[0].1, next: 0 });
        let (first, second) = lights.split_at_mut(lights.len() / 2);
        let a = self.build(first, way, level + 1);
        self.nodes[index].next = u32::try_from(self.nodes.len()).expect("fewer than 2³¹ lights");
        let b = self.build(second, way | 1 << level, level + 1);
        let extent = a.union(&b);
        self.nodes[index].extent = extent;
        extent
    }

    /// The probability of an inner node's first child, as seen from `from`.
    #[inline]
    fn first_share(&self, node: usize, from: Vec3) -> f32 {
        let [a, b] =
            [node + 1, self.nodes[node].next as usize].map(|i| self.nodes[i].extent.importance(from));
        // Overflow and underflow leave no ratio; any will do.
        let share = a / (a + b);
        if share.is_finite() { share } else { 0.5 }
    }

    /// The light for `u` in [0, 1) and its probability.
    pub(super) fn choose(&self, mut u: f32, from: Vec3) -> (u32, f32) {
        let (mut node, mut pmf) = (0, 1.0);
        while self.nodes[node].next & LEAF == 0 {
            let share = self.first_share(node, from);
            if u < share {
                (node, u, pmf) = (node + 1, u / share, pmf * share);
            } else {
                (node, u, pmf) =
                    (self.nodes[node].next as usize, (u - share) / (1.0 - share), pmf * (1.0 - share));
            }
        }
        (self.nodes[node].next & !LEAF, pmf)
    }

    /// The probability of a light.
    pub(super) fn pmf(&self, light: u32, from: Vec3) -> f32 {
        let (mut node, mut pmf, mut way) = (0, 1.0, self.ways[light as usize]);
        while self.nodes[node].next & LEAF == 0 {
            let share = self.first_share(node, from);
            (node, pmf) = match way & 1 {
                0 => (node + 1, pmf * share),
                _ => (self.nodes[node].next as usize, pmf * (1.0 - share)),
            };
            way >>= 1;
        }
        pmf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn light(p: [f32; 3], radius: f32, axis: [f32; 3], flat: bool, intensity: f32) -> Extent {
        let axis = Vec3::from(axis).try_normalize().unwrap_or(Vec3::Z);
        Extent { middle: p.into(), radius, axis, cos: if flat { 1.0 } else { -1.0 }, intensity }
    }

    fn lights() -> impl Strategy<Value = Vec<Extent>> {
        let place = prop::array::uniform3(-3.0..3.0_f32);
        let axis = prop::array::uniform3(-1.0..1.0_f32);
        let one = (place, 0.01..0.5_f32, axis, any::<bool>(), 0.1..100.0_f32);
        prop::collection::vec(one.prop_map(|(p, r, n, flat, i)| light(p, r, n, flat, i)), 1..40)
    }

    fn tree(lights: &[Extent]) -> Tree {
        Tree::new((0..).zip(lights.iter().copied()).collect(), lights.len())
    }

    #[test]
    fn lights_too_bright_or_too_dim_for_single_precision_keep_their_chance() {
        for intensity in [f32::INFINITY, f32::MAX, 1e-45] {
            for apart in [1e-20, 1.0, 1e6] {
                let at = |x| light([x, 0.0, 0.0], 0.0, [0.0; 3], false, intensity);
                let tree = tree(&[at(-apart), at(apart)]);
                assert_eq!([0, 1].map(|light| tree.pmf(light, Vec3::ZERO)), [0.5; 2], "{intensity} {apart}");
            }
        }
    }

    #[test]
    fn importance_is_the_cosine_at_the_rim_of_the_ball() {
        let ball = light([0.0; 3], 0.3, [0.0, 0.0, 1.0], true, 2.0);
        let from = 1.5 * Vec3::new(1.0_f32.sin(), 0.0, 1.0_f32.cos());
        // One radian off the axis less asin(0.3/1.5), over the distance squared; a few roundings of cosines near ½.
        let exact = 2.0 / 2.25 * (1.0 - 0.2_f32.asin()).cos();
        assert!((ball.importance(from) - exact).abs() < 8.0 * f32::EPSILON, "{exact}");
    }

    #[test]
    fn within_the_ball_a_flat_light_may_face_any_way() {
        let ball = light([0.0; 3], 0.5, [0.0, 0.0, 1.0], true, 2.0);
        // Behind the normal: outside nothing comes but what LEAST_COS leaves, inside everything.
        assert_eq!(ball.importance(Vec3::new(0.0, 0.0, -0.4)), 2.0 / 0.25);
        assert_eq!(ball.importance(Vec3::new(0.0, 0.0, -4.0)), 2.0 / 16.0 * LEAST_COS);
    }

    proptest! {
        #[test]
        fn probabilities_are_those_of_the_choice(
            lights in lights(), from in prop::array::uniform3(-4.0..4.0_f32), u in 0.0..1.0_f32,
        ) {
            let (tree, from) = (tree(&lights), Vec3::from(from));
            let pmfs: Vec<f32> = (0..).zip(&lights).map(|(i, _)| tree.pmf(i, from)).collect();
            // At each of six levels a sum of two rounded products.
            prop_assert!((pmfs.iter().sum::<f32>() - 1.0).abs() < 16.0 * f32::EPSILON);
            prop_assert!(pmfs.iter().all(|&p| p > 0.0));
            let (chosen, pmf) = tree.choose(u, from);
            prop_assert_eq!(pmf, pmfs[chosen as usize]);
        }

        #[test]
        fn a_light_is_chosen_as_often_as_it_should_be(lights in lights(), from in prop::array::uniform3(-4.0..4.0_f32)) {
            const STEPS: u16 = 4096;
            let (tree, from) = (tree(&lights), Vec3::from(from));
            let mut counts = vec![0_u16; lights.len()];
            for i in 0..STEPS {
                counts[tree.choose((f32::from(i) + 0.5) / f32::from(STEPS), from).0 as usize] += 1;
            }
            for (i, &count) in (0..).zip(&counts) {
                // A light's numbers are one interval, whose ends each cut one step.
                let expected = f32::from(STEPS) * tree.pmf(i, from);
                prop_assert!((f32::from(count) - expected).abs() < 1.01, "{i}: {count} of {expected}");
            }
        }

        #[test]
        fn a_cone_around_two_has_their_rims_and_little_more(
            axes in prop::array::uniform2(prop::array::uniform3(-1.0..1.0_f32)), angles in prop::array::uniform2(0.0..1.5_f32),
            turn in 0.0..6.3_f32,
        ) {
            let axes = axes.map(|axis| Vec3::from(axis).try_normalize().unwrap_or(Vec3::Z));
            let [a, b] = [0, 1].map(|k| (axes[k], angles[k].cos()));
            let (axis, cos) = cones([a, b]);
            for (k, v) in axes.into_iter().enumerate() {
                let (x, y) = v.any_orthonormal_pair();
                let rim = angles[k].cos() * v + angles[k].sin() * (turn.cos() * x + turn.sin() * y);
                // The cone is 1e-3 wider than it need be; arc cosines near 1 are off by √ε = 3e-4.
                prop_assert!(axis.dot(rim) >= cos, "{} < {cos}", axis.dot(rim));
            }
            // Their mean axis is half the angle between them from both, to f32's rounding over the length of their sum.
            let needed = 0.5 * axes[0].angle_between(axes[1]) + angles[0].max(angles[1]);
            prop_assume!((axes[0] + axes[1]).length() > 1e-2);
            prop_assert!(cos.acos() <= needed + 1e-3 + 6e-4, "{} > {needed}", cos.acos());
        }

        #[test]
        fn no_normal_of_a_node_is_outside_its_bound(lights in lights(), from in prop::array::uniform3(-4.0..4.0_f32)) {
            let from = Vec3::from(from);
            let whole = lights.iter().skip(1).fold(lights[0], |a, b| a.union(b));
            for light in &lights {
                let out = (light.middle - whole.middle).length() + light.radius - whole.radius;
                prop_assert!(out <= 1e-5, "{out}"); // roundings of lengths up to 10
                let to = from - light.middle;
                let d2 = (from - whole.middle).length_squared();
                if light.cos == 1.0 && d2 > whole.radius * whole.radius {
                    // The bound on the cosine holds for the middles of the lights.
                    let bound = whole.importance(from) * d2 / whole.intensity;
                    prop_assert!(light.axis.dot(to.normalize()) <= bound + 1e-3 + LEAST_COS);
                }
            }
        }
    }
}
