//! What the rays of a packet find in leaves of triangles.

use super::block::{BlockRef, Candidates, Probes};
use super::node::{Boxes, SLACK, WIDTH, lanes_of};
use super::packet::{EIGHTS, Packet, RAYS, reaching};
use super::walk::{Closest, Found, Mode, Search, Tree};
use crate::math::eight::Vec3x8;
use crate::shapes::triangle::hit_eight;

/// What the rays of a packet find in leaves of triangles.
///
/// A triangle hit for certain waits until all leaves are visited and eight can be tested at once; meanwhile the ray is as long as it may be
/// at most then.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    /// Whether the rays have been prepared, which is done at the first leaf.
    is_prepared: bool,
    probes: [Probes; EIGHTS],
    /// Whether all rays begin at one point.
    is_one_origin: bool,
    candidates: [Candidates; RAYS],
    /// The rays for which a triangle waits, as bits.
    waiting: u32,
    items: [usize; RAYS],
    corners: [[Vec3x8; 3]; EIGHTS],
}

impl Leaves {
    /// Begins anew with another packet, in place.
    #[inline]
    pub(super) fn restart(&mut self) {
        self.is_prepared = false;
        self.waiting = 0;
    }

    #[inline]
    fn prepare(&mut self, packet: &Packet) {
        self.is_prepared = true;
        self.is_one_origin = packet.has_one_origin();
        for (probes, rays) in self.probes.iter_mut().zip(packet.eights()) {
            *probes = Probes::new(rays, packet.longest);
        }
    }

    /// Tries a leaf's triangles against those rays that meet its box, given as bits; returns those that may have hit one.
    #[inline]
    pub(super) fn visit<M: Mode>(
        &mut self,
        packet: &Packet,
        tree: &Tree<impl Boxes>,
        block: BlockRef,
        meeting: u32,
        searches: &mut [Search; RAYS],
    ) -> u32 {
        if !self.is_prepared {
            self.prepare(packet);
        }
        let mut found = 0;
        // All candidates first: what the branches below depend on is known when they come.
        let relative = block.relative(&self.probes[0].get(0));
        for ray in lanes_of::<RAYS>(meeting) {
            let (probe, reach) = (self.probes[ray / 8].get(ray % 8), searches[ray].reach());
            let candidates = if self.is_one_origin {
                relative.candidates(&probe, reach)
            } else {
                block.relative(&probe).candidates(&probe, reach)
            };
            found |= u32::from(candidates.lanes != 0) << ray;
            self.candidates[ray] = candidates;
        }
        for ray in lanes_of::<RAYS>(found) {
            let candidates = self.candidates[ray];
            if M::ANY {
                searches[ray].settle::<M>(tree, block, candidates);
            } else {
                self.take(tree, block, ray, &candidates, &mut searches[ray]);
            }
        }
        found
    }

    /// Tests the triangles that a ray may hit, or leaves them for later.
    #[inline]
    fn take(
        &mut self,
        tree: &Tree<impl Boxes>,
        block: BlockRef,
        ray: usize,
        candidates: &Candidates,
        search: &mut Search,
    ) {
        for lane in lanes_of::<WIDTH>(candidates.lanes) {
            let (item, triangle) = (block.first() + lane, block.triangle(lane));
            if candidates.certain >> lane & 1 == 0 {
                search.test::<Closest>(tree, item, &triangle);
                continue;
            }
            let corners = &mut self.corners[ray / 8];
            if self.waiting >> ray & 1 == 1 {
                search.test::<Closest>(
                    tree,
                    self.items[ray],
                    &corners.each_ref().map(|corner| corner.get(ray % 8)),
                );
            }
            self.waiting |= 1 << ray;
            self.items[ray] = item;
            for (corner, of_triangle) in corners.iter_mut().zip(triangle) {
                corner.set(ray % 8, of_triangle);
            }
            search.shorten(candidates.far.as_array()[lane] * SLACK);
        }
    }

    /// Tests the triangles that wait.
    #[inline]
    pub(super) fn finish(&self, packet: &Packet, tree: &Tree<impl Boxes>, searches: &mut [Search; RAYS]) {
        let (searches, _) = searches.as_chunks_mut::<8>();
        for (i, (searches, rays)) in searches.iter_mut().zip(packet.eights()).enumerate() {
            let lanes = self.waiting >> (8 * i) & 0xff;
            if lanes == 0 {
                continue;
            }
            let corners = self.corners[i].map(Vec3x8::widened);
            let hits = hit_eight(&reaching(rays, searches), packet.longest, corners);
            for lane in lanes_of::<8>(lanes & hits.lanes) {
                let item = self.items[8 * i + lane];
                searches[lane].accept::<Closest>(tree.group, Found::Item(item, hits.get(lane)));
            }
        }
    }
}
