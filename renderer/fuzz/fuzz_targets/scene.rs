//! Scene files: whatever they say, the reader answers with a scene or with one line.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use renderer::io::read_scene;
use renderer::scene::Scene;

/// Files that scenes may name, small ones of every kind.
const FILES: [(&str, &[u8]); 4] = [
    ("m.obj", include_bytes!("../corpus/obj/normals.obj")),
    ("m.ply", include_bytes!("../corpus/ply/ascii.ply")),
    ("m.serialized", include_bytes!("../corpus/serialized/stored.serialized")),
    ("t.png", include_bytes!("../t.png")),
];

/// A scene of this process, which the reader opens, with the files beside it.
static PATH: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("lightproof-fuzz-scene-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder for temporary files can be written");
    for (name, bytes) in FILES {
        std::fs::write(folder.join(name), bytes).expect("the folder for temporary files can be written");
    }
    folder.join("scene.xml")
});

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
