//! The files that a scene is made of, and the hash of all that was read.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Reads files relative to a scene's folder.
#[derive(Debug)]
pub(super) struct Files {
    folder: PathBuf,
    hash: u64,
}

/// FNV-1a, 64 bits.
///
/// # Source
/// Fowler, Noll, Vo; RFC 9923.
const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

impl Files {
    /// The files beside `scene`.
    pub(super) fn beside(scene: &Path) -> Self {
        Self { folder: scene.parent().map(Path::to_path_buf).unwrap_or_default(), hash: OFFSET_BASIS }
    }

    /// The path that `name` means: relative names start in the scene's folder.
    pub(super) fn resolve(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The content of `path`, which counts for the hash.
    pub(super) fn read(&mut self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = fs::read(path)?;
        self.add(&bytes);
        Ok(bytes)
    }

    /// Lets `bytes` count for the hash, with their number so that two texts are not mistaken for one.
    pub(super) fn add(&mut self, bytes: &[u8]) {
        let length = (bytes.len() as u64).to_le_bytes();
        for byte in length.iter().chain(bytes) {
            self.hash = (self.hash ^ u64::from(*byte)).wrapping_mul(PRIME);
        }
    }

    /// The hash of everything read so far, in order.
    pub(super) fn hash(&self) -> u64 {
        self.hash
    }
}
