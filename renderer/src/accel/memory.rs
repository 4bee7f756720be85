//! Arrays that rays read here and there: on large pages where the system has them.
//!
//! Of a tree of 100 MB most steps would else miss the processor's list of pages, too; measured in benches/README.md.

use bytemuck::Pod;
use memmap2::MmapMut;
use rayon::prelude::*;

/// Bytes from which on an array gets memory of its own: a large page of x86-64.
const LARGE: usize = 1 << 21;

/// An array of plain numbers that doesn't change.
#[derive(Debug)]
pub(super) enum Array<T> {
    Small(Vec<T>),
    Large(MmapMut),
}

impl<T: Pod + Send + Sync> Array<T> {
    /// The array of `make(0)`, … `make(len − 1)`.
    pub(super) fn new(len: usize, make: impl Fn(usize) -> T + Sync) -> Self {
        let bytes = len * size_of::<T>();
        // Without memory of its own it is an array like others.
        let large = (bytes >= LARGE).then(|| MmapMut::map_anon(bytes).ok()).flatten();
        let Some(mut memory) = large else {
            return Self::Small((0..len).into_par_iter().map(&make).collect());
        };
        #[cfg(target_os = "linux")]
        // A system that knows no large pages refuses, and only speed is lost.
        let _ = memory.advise(memmap2::Advice::HugePage);
        let items: &mut [T] = bytemuck::cast_slice_mut(&mut memory);
        items.par_iter_mut().enumerate().for_each(|(index, item)| *item = make(index));
        Self::Large(memory)
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[T] {
        match self {
            Self::Small(list) => list,
            Self::Large(memory) => bytemuck::cast_slice(memory),
        }
    }
}
