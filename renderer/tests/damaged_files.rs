//! Damaged files: whatever is cut, flipped, removed or repeated, the readers answer with a scene or one line.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use renderer::io::read_scene;
use renderer::scene::Scene;

/// Scenes of the references, whose copies are damaged.
const SCENES: [&str; 7] = ["cornell", "glass", "mesh", "moving", "soft-shadow", "textured", "thin-lens"];

fn references() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/scenes")
}

/// What happens to a file before it is read.
#[derive(Debug, Clone)]
enum Damage {
    Cut(f64),
    Byte(f64, u8),
    Remove(f64, usize),
    Twice(f64, usize),
}

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let at = || 0.0..1.0_f64;
    let one = prop_oneof![
        at().prop_map(Damage::Cut),
        (at(), any::<u8>()).prop_map(|(a, b)| Damage::Byte(a, b)),
        (at(), prop::sample::select(&b"0-9.e$<>\"'/n"[..])).prop_map(|(a, b)| Damage::Byte(a, b)),
        (at(), 1..40_usize).prop_map(|(a, n)| Damage::Remove(a, n)),
        (at(), 1..40_usize).prop_map(|(a, n)| Damage::Twice(a, n)),
    ];
    prop::collection::vec(one, 1..4)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place inside the bytes")]
fn damaged(mut bytes: Vec<u8>, list: &[Damage]) -> Vec<u8> {
    for damage in list {
        let place = |at: f64| ((bytes.len() as f64 * at) as usize).min(bytes.len().saturating_sub(1));
        if bytes.is_empty() {
            break;
        }
        match *damage {
            Damage::Cut(at) => bytes.truncate(place(at)),
            Damage::Byte(at, byte) => {
                let place = place(at);
                bytes[place] = byte;
            }
            Damage::Remove(at, n) => {
                let (from, to) = (place(at), (place(at) + n).min(bytes.len()));
                bytes.drain(from..to);
            }
            Damage::Twice(at, n) => {
                let (from, to) = (place(at), (place(at) + n).min(bytes.len()));
                let again = bytes[from..to].to_vec();
                bytes.splice(from..from, again);
            }
        }
    }
    bytes
}

/// A copy of the files that the reference scenes name, which goes away at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        let path = std::env::temp_dir().join(format!("lightproof-damaged-{}", std::process::id()));
        for part in ["meshes", "textures"] {
            fs::create_dir_all(path.join(part)).unwrap();
            for entry in fs::read_dir(references().join(part)).unwrap().map(Result::unwrap) {
                fs::copy(entry.path(), path.join(part).join(entry.file_name())).unwrap();
            }
        }
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_scenes_never_panic_and_are_refused_in_one_line(which in prop::sample::select(&SCENES[..]), list in damage()) {
        thread_local!(static FOLDER: Folder = Folder::new());
        FOLDER.with(|folder| {
            let text = fs::read(references().join(which).with_extension("xml")).unwrap();
            let scene = folder.0.join("s.xml");
            fs::write(&scene, damaged(text, &list)).unwrap();
            match read_scene(&scene, &[]) {
                Ok((scene, _)) => drop(Scene::new(&scene)),
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        });
    }

    #[test]
    fn damaged_meshes_never_panic_and_are_refused_in_one_line(ply in any::<bool>(), list in damage()) {
        use renderer::io::mesh::{MeshFormat, parse};
        let (name, format) = if ply { ("gem.ply", MeshFormat::Ply) } else { ("cornell_short.obj", MeshFormat::Obj) };
        let bytes = fs::read(references().join("meshes").join(name)).unwrap();
        if let Err(error) = parse(Path::new(name), &damaged(bytes, &list), format) {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}

/// What the fuzzers start from, and the inputs that they found: `line-break.xml` made a message of two lines.
#[test]
fn the_fuzzers_inputs_are_read_or_refused_in_one_line() {
    use renderer::io::mesh::{MeshFormat, parse};
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let mut count = 0;
    for kind in ["scene", "ply", "obj", "serialized", "exr"] {
        for entry in fs::read_dir(corpus.join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let bytes = fs::read(&path).unwrap();
            let refused = match kind {
                "scene" => read_scene(&path, &[]).err(),
                "ply" => parse(&path, &bytes, MeshFormat::Ply).err(),
                "obj" => parse(&path, &bytes, MeshFormat::Obj).err(),
                "serialized" => parse(&path, &bytes, MeshFormat::Serialized { shape: 1 }).err(),
                _ => renderer::io::exr::decode(&path, &bytes).err(),
            };
            let message = refused.map(|error| error.to_string()).unwrap_or_default();
            assert!(!message.contains('\n'), "{message}");
            count += 1;
        }
    }
    assert!(count >= 17, "{count} inputs");
}
