//! The scenes of `lightproof analytic`, rendered by this program and held against their exact images.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the program in a folder of that name, which is made anew.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("the folder for tests can be emptied");
    }
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    folder
}

fn lightproof(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightproof"));
    command.args(arguments).current_dir(folder).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_scene_is_its_exact_image_and_no_other() {
    let folder = folder("analytic");
    assert!(lightproof(&folder, &["analytic", "."]).status.success());
    let scenes = lightproof::analytic::all();
    assert!(std::fs::read_to_string(folder.join("README.md")).unwrap().contains("penumbra"));
    // Few samples: what the claims hold to 0.2 % is only to be recognised, at 10 %, for a disk of which one sample in twelve sees light.
    for scene in &scenes {
        let [xml, exact, ours] =
            ["xml", "exr", "ours.exr"].map(|extension| format!("{}.{extension}", scene.name));
        let rendered = lightproof(
            &folder,
            &["render", &xml, "--spp", "1024", "--replicates", "16", "--branch", "both", "-o", &ours],
        );
        assert!(rendered.status.success(), "{}", text(&rendered.stderr));
        assert!(!text(&rendered.stderr).contains("note:"), "{xml}: {}", text(&rendered.stderr));
        let same = lightproof(&folder, &["compare", &ours, &exact, "--max-bias", "10"]);
        assert_eq!(same.status.code(), Some(0), "{}: {}", scene.name, text(&same.stdout));
        assert!(text(&same.stdout).contains("B is exact"), "{}", text(&same.stdout));
    }
    let other =
        lightproof(&folder, &["compare", "penumbra.ours.exr", "lit-by-sphere.exr", "--max-bias", "3"]);
    assert_eq!(other.status.code(), Some(1));
}

#[test]
fn an_exact_image_with_errors_is_refused() {
    let folder = folder("analytic-refused");
    let mut image = lightproof::analytic::all()[0].image();
    image.stderr.as_mut().unwrap()[3][1] = 0.5;
    renderer::io::exr::write(&folder.join("a.exr"), &image).unwrap();
    let refused = lightproof(&folder, &["compare", "a.exr", "a.exr"]);
    assert_eq!(refused.status.code(), Some(2));
    let message = text(&refused.stderr);
    assert!(
        message.contains("\"exact\"") && message.contains("0.5") && message.contains("0 is accepted"),
        "{message}"
    );
}
