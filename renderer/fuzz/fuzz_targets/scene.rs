//! Scene files: whatever they say, the reader answers with a scene or with one line.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use renderer::io::read_scene;
use renderer::scene::Scene;

/// A file of this process, which the reader opens.
static PATH: LazyLock<std::path::PathBuf> =
    LazyLock::new(|| std::env::temp_dir().join(format!("lightproof-fuzz-{}.xml", std::process::id())));

fuzz_target!(|data: &[u8]| {
    std::fs::write(&*PATH, data).expect("the folder for temporary files can be written");
    match read_scene(&PATH, &[]) {
        Ok((description, _)) => {
            if let Err(error) = Scene::new(&description) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
});
