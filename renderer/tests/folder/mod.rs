//! Scene files for tests to read.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use renderer::Error;
use renderer::io::read_scene;
use renderer::scene::SceneDescription;

/// A folder of its own with files in it, which goes away at the end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(files: &[(&str, &str)]) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("lightproof-scenes-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        for (name, text) in files {
            fs::write(path.join(name), text).unwrap();
        }
        Self(path)
    }

    pub(crate) fn read(&self, overrides: &[(&str, &str)]) -> Result<(SceneDescription, Vec<String>), Error> {
        let own = |&(name, value): &(&str, &str)| (name.to_string(), value.to_string());
        let overrides: Vec<_> = overrides.iter().map(own).collect();
        read_scene(&self.0.join("s.xml"), &overrides)
    }

    /// The refusal's message without the folder's path.
    pub(crate) fn refused(&self) -> String {
        let error = self.read(&[]).expect_err("a scene that is refused");
        error.to_string().replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
