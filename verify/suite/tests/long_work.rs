//! Renders that are cut off, or divided: they end with the bits of one that was not.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../references/scenes/soft-shadow.xml");

const GLASS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../references/scenes/glass.xml");

/// An empty folder of that name.
fn empty(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("long-work").join(name);
    let _ = std::fs::remove_dir_all(&folder); // it need not be there
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    folder
}

fn lightproof(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightproof"));
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn path_in(folder: &Path, name: &str) -> String {
    folder.join(name).into_os_string().into_string().expect("the path is text")
}

fn succeed(arguments: &[&str]) {
    let output = lightproof(arguments).output().expect("the program starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Status 2 and a message with `part`.
fn refused(arguments: &[&str], part: &str) {
    let output = lightproof(arguments).output().expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && message.contains(part), "{arguments:?}: {message}");
}

fn bytes(path: &str) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Kills the program without warning as soon as its checkpoint is there and a moment has passed.
fn kill_after_checkpoint(mut child: Child, checkpoint: &Path, moment: Duration) {
    while !checkpoint.exists() {
        let ended = child.try_wait().expect("the program can be asked");
        assert!(ended.is_none(), "the render ended before there was a checkpoint to resume from");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(moment);
    child.kill().expect("the program can be killed"); // SIGKILL
    child.wait().expect("the program was started here");
}

#[test]
fn a_killed_render_goes_on_to_the_same_bits() {
    killed_and_resumed("killed", &[SCENE, "--spp", "600"]);
}

#[test]
fn so_does_one_with_samples_by_error() {
    killed_and_resumed("killed-allocated", &[SCENE, "--spp", "600", "--sampler", "sobol", "--allocate"]);
    let folder = empty("other-samples");
    let cut = path_in(&folder, "cut.exr");
    let work = [
        "render",
        SCENE,
        "--sampler",
        "sobol",
        "--spp",
        "600",
        "-D",
        "res=100",
        "-o",
        &cut,
        "--checkpoint",
        "0",
    ];
    let child = lightproof(&work).spawn().expect("the program starts");
    kill_after_checkpoint(child, &folder.join("cut.exr.checkpoint"), Duration::ZERO);
    refused(&[&work[..], &["--resume", "--allocate"]].concat(), "it holds other samples");
}

#[test]
fn so_does_one_whose_neighbours_share_paths() {
    killed_and_resumed(
        "killed-reuse",
        &[SCENE, "--spp", "600", "--sampler", "sobol", "--allocate", "--reuse"],
    );
}

#[test]
fn so_does_one_with_paths_from_lights() {
    let work = ["--spp", "200", "--sampler", "sobol", "--allocate", "--light-paths"];
    killed_and_resumed("killed-light-paths", &[&[GLASS][..], &work].concat());
}

fn killed_and_resumed(name: &str, work: &[&str]) {
    let folder = empty(name);
    let (whole, cut) = (path_in(&folder, "whole.exr"), path_in(&folder, "cut.exr"));
    let work = [work, &["-D", "res=100", "--checkpoint", "0", "--resume"]].concat();
    let arguments = |output: &'static str| [&["render", "-o"][..], &[output], &work].concat();
    succeed(&arguments(whole.clone().leak()));

    let checkpoint = folder.join("cut.exr.checkpoint");
    let resume = arguments(cut.clone().leak());
    for moment in [0, 30, 60].map(Duration::from_millis) {
        let child = lightproof(&resume).spawn().expect("the program starts");
        kill_after_checkpoint(child, &checkpoint, moment);
        assert!(!Path::new(&cut).exists(), "the render was killed before its end");
    }
    succeed(&resume);
    assert!(bytes(&whole) == bytes(&cut), "the same file");
    assert!(!checkpoint.exists(), "a finished render leaves no checkpoint");
}

#[test]
fn ranges_of_samples_merge_to_the_same_bits() {
    let folder = empty("merged");
    let file = |name| path_in(&folder, name);
    for sampler in ["sobol", "stratified"] {
        let work = ["render", SCENE, "--spp", "44", "-D", "res=20", "--sampler", sampler];
        succeed(&[&work[..], &["-o", &file("whole.exr")]].concat());
        for (name, range) in [("a.part", "0..3"), ("b.part", "3..8"), ("c.part", "8..11")] {
            succeed(&[&work[..], &["--samples", range, "-o", &file(name)]].concat());
        }
        succeed(&["merge", &file("c.part"), &file("a.part"), &file("b.part"), "-o", &file("merged.exr")]);
        assert!(bytes(&file("whole.exr")) == bytes(&file("merged.exr")), "{sampler}");
    }
    refused(
        &["merge", &file("a.part"), &file("c.part"), "-o", &file("x.exr")],
        "first sample of the next part is 8",
    );
    let other = ["render", SCENE, "--spp", "44", "-D", "res=20", "--sampler", "stratified", "--seed", "1"];
    succeed(&[&other[..], &["--samples", "3..8", "-o", &file("other.part")]].concat());
    refused(
        &["merge", &file("a.part"), &file("other.part"), "-o", &file("x.exr")],
        "seed is 1, and 0 is accepted",
    );
}

#[test]
fn work_that_does_not_fit_is_refused() {
    let folder = empty("refused");
    let output = path_in(&folder, "x.exr");
    let part = path_in(&folder, "x.part");
    refused(&["render", SCENE, "--spp", "16", "--samples", "0..5", "-o", &part], "a range in 0..4");
    refused(&["render", SCENE, "--samples", "0..1", "-o", &output], "with --samples, .part");
    refused(&["render", SCENE, "--samples", "5..5", "-o", &part], "A below B");
    refused(
        &["render", SCENE, "-D", "res=16000", "--replicates", "4000", "--spp", "4000", "-o", &output],
        "GiB",
    );
    std::fs::write(folder.join("x.exr.checkpoint"), "lightproof part 3\nscene_hash 0\n\n")
        .expect("it can be written");
    refused(&["render", SCENE, "-D", "res=8", "--resume", "-o", &output], "checksum");
}
