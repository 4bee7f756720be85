//! The program as its users meet it: what it prints, writes and returns.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderer::io::{Image, exr};
use verify::claim::Seed;

/// An empty folder of that name.
fn empty(folder: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("the folder for tests can be emptied");
    }
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    folder
}

/// Runs the program in the folder of that name.
fn lightproof(folder: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    let output = Command::new(env!("CARGO_BIN_EXE_lightproof"))
        .args(arguments)
        .current_dir(&folder)
        .env_remove("VERIFY_SEED")
        .env_remove("VERIFY_LEVEL")
        .output()
        .expect("the program starts");
    (output, folder)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Asserts status 2 and a single message that has all the parts.
fn assert_refused(output: &Output, parts: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: ") && message.trim_end().lines().count() == 1, "{message}");
    parts.iter().for_each(|part| assert!(message.contains(part), "{part} is missing in: {message}"));
}

#[test]
fn every_command_has_help_with_examples() {
    let commands = ["verify", "render", "effects", "compare", "analytic", "samples", "page"];
    for command in [&[][..]].into_iter().chain(commands.iter().map(std::slice::from_ref)) {
        let (output, _) = lightproof("help", &[command, &["--help"]].concat());
        assert!(output.status.success());
        assert!(text(&output.stdout).contains("Example"), "{command:?}");
    }
}

#[test]
fn claims_are_listed_and_chosen_by_patterns_that_cross_slashes() {
    let (all, _) = lightproof("list", &["verify", "--list"]);
    let (some, _) =
        lightproof("list", &["verify", "--list", "--only", "warp*inverse", "--only", "warp/disk/pdf"]);
    let names = |output: &Output| -> Vec<String> {
        text(&output.stdout)
            .lines()
            .filter_map(|line| Some(line.split_whitespace().next()?.to_owned()))
            .collect()
    };
    let expected: Vec<String> = names(&all)
        .into_iter()
        .filter(|name| name.starts_with("warp") && name.ends_with("inverse") || name == "warp/disk/pdf")
        .collect();
    assert_eq!(names(&some), expected);
    assert!(expected.len() > 2);
}

#[test]
fn a_claim_of_a_higher_level_is_refused_with_its_level() {
    let (output, _) = lightproof("above", &["verify", "--only", "image/mesh/mitsuba"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("its claims run from --level standard on"));
    let (output, _) =
        lightproof("above", &["verify", "--list", "--level", "standard", "--only", "image/mesh/mitsuba"]);
    assert!(output.status.success());
}

#[test]
fn an_unknown_claim_is_refused_with_the_nearest_names() {
    let (output, _) = lightproof("unknown", &["verify", "--only", "warp/dsk/pfd"]);
    assert_refused(&output, &["warp/dsk/pfd", "warp/disk/pdf"]);
}

#[test]
fn json_stands_alone_on_standard_output_and_the_page_is_made_again_from_it() {
    let (output, folder) =
        lightproof("json", &["--only", "warp/tent/*", "--json", "-", "--report", "out", "--seed", "3"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("3 claims"));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
    for member in ["schema", "lightproof", "seed", "level", "seconds", "machine", "claims"] {
        assert!(report.get(member).is_some(), "{member}");
    }
    assert_eq!(
        (&report["schema"], &report["seed"], &report["level"]),
        (&1.into(), &3.into(), &"quick".into())
    );
    let members = [
        "id",
        "says",
        "method",
        "n",
        "statistic",
        "dof",
        "p_value",
        "estimate",
        "interval",
        "bound",
        "verdict",
        "resolves",
        "controls",
        "seconds",
        "command",
    ];
    let claims = report["claims"].as_array().expect("a list");
    assert_eq!(claims.len(), 3);
    for claim in claims {
        members.iter().for_each(|member| assert!(claim.get(member).is_some(), "{member}"));
        let controls = claim["controls"].as_array().expect("a list");
        assert!(!controls.is_empty() && controls.iter().all(|control| control["rejected"] == true));
    }
    let (again, _) = lightproof("json", &["page", "out/report.json", "-o", "again.html"]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    let pages =
        ["out/index.html", "again.html"].map(|name| std::fs::read(folder.join(name)).expect("a page"));
    assert!(pages[0] == pages[1], "the page differs when it is made again");
    // The name of SVG's vocabulary is an address that nobody opens.
    let page = text(&pages[0]).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(
        ["http:", "https:", "@import", "<script", "<link"].iter().all(|word| !page.contains(word)),
        "the page needs no network"
    );
}

#[test]
fn what_is_found_does_not_depend_on_threads() {
    let found = |threads: &str| {
        let arguments = ["--only", "warp/t*/*", "--json", "-", "--threads", threads];
        let (output, _) = lightproof(&format!("threads{threads}"), &arguments);
        let mut report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
        for claim in report["claims"].as_array_mut().expect("a list") {
            claim["seconds"] = 0.into();
        }
        report["claims"].clone()
    };
    assert_eq!(found("1"), found("3"));
}

#[test]
fn files_that_are_no_reports_are_refused() {
    let folder = empty("reports");
    let (output, _) = lightproof("reports", &["page", "missing.json"]);
    assert_refused(&output, &["missing.json"]);
    std::fs::write(folder.join("bad.json"), "{\"schema\": 1,\n oops}").expect("writes");
    assert_refused(&lightproof("reports", &["page", "bad.json"]).0, &["bad.json", "line 2"]);
    std::fs::write(folder.join("later.json"), "{\"schema\": 2}").expect("writes");
    assert_refused(&lightproof("reports", &["page", "later.json"]).0, &["schema is 2", "1 is accepted"]);
    std::fs::write(folder.join("file"), "").expect("writes");
    let into_file = ["--only", "warp/tent/pdf", "--report", "file/below"];
    assert_refused(&lightproof("reports", &into_file).0, &["file/below"]);
}

/// Images a side in the test of seeds.
const SEEDS: u64 = 8;

/// A number in [0, 1) of its own for each name, seed and place.
#[expect(clippy::cast_possible_truncation, reason = "a number in [0, 1) in single precision")]
fn number(name: &str, seed: u64, place: usize) -> f32 {
    let mut u = [0.0];
    verify::points::fill(Seed::derive(0, name, seed), place as u64, &mut u);
    u[0] as f32
}

/// Writes images with independent errors about a mean, uniform with a standard deviation of 10 %.
fn write_seeds(folder: &Path, name: &str, mean: f32) {
    for seed in 0..SEEDS {
        let noise = |i| mean * (1.0 + 0.2 * 3.0f32.sqrt() * (number(name, seed, i) - 0.5));
        let rgb = (0..64 * 48).map(|i| [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)]).collect();
        exr::write(&folder.join(format!("{name}{seed}.exr")), &Image::new(64, 48, rgb)).expect("writes");
    }
}

#[test]
fn images_from_seeds_are_told_apart_when_they_differ() {
    let folder = empty("compare");
    [("a", 1.0), ("b", 1.000_001), ("c", 1.02)]
        .iter()
        .for_each(|(name, mean)| write_seeds(&folder, name, *mean));
    let compare = |b: char, options: &[&str]| {
        let names: Vec<String> = (0..SEEDS).map(|i| format!("a{i}.exr")).collect();
        let others: Vec<String> = (0..SEEDS).map(|i| format!("{b}{i}.exr")).collect();
        let mut arguments = vec!["compare"];
        arguments.extend(options);
        arguments.extend(names.iter().map(String::as_str));
        arguments.push("--");
        arguments.extend(others.iter().map(String::as_str));
        lightproof("compare", &arguments).0
    };
    // 9,216 values of standard deviation 10 % a file: the mean of 8 files is known to 0.04 %, the difference of two to 0.05 %; the bound is 1 %.
    let same = compare('b', &["--json", "-", "--heatmap", "map.png", "--max-bias", "1"]);
    let result: serde_json::Value = serde_json::from_slice(&same.stdout).expect("JSON alone");
    assert_eq!((same.status.code(), &result["verdict"]), (Some(0), &"holds".into()), "{result}");
    assert_eq!((&result["schema"], &result["error_known"]), (&1.into(), &true.into()));
    assert!(std::fs::read(folder.join("map.png")).expect("a picture").starts_with(b"\x89PNG"));
    let different = compare('c', &["--max-bias", "1"]);
    assert_eq!(different.status.code(), Some(1), "{}", text(&different.stdout));
    let (one, _) = lightproof("compare", &["compare", "a0.exr", "b0.exr"]);
    assert!(one.status.code() == Some(1) && text(&one.stdout).contains("errors are unknown"));
}

#[test]
fn sums_of_other_programs_may_be_rounded_in_f32() {
    let folder = empty("rounded");
    let sky = |name: &str, radiance: f32| {
        for seed in 0..SEEDS {
            let value = |i| if i < 64 * 16 { radiance } else { 0.95 + 0.1 * number(name, seed, i) };
            let rgb = (0..64 * 48).map(|i| [value(i); 3]).collect();
            exr::write(&folder.join(format!("{name}{seed}.exr")), &Image::new(64, 48, rgb)).expect("writes");
        }
    };
    // 4,096 equal samples: Mitsuba's sums are off by up to 4e-5; 4e-4 is no rounding
    for (radiance, status, verdict) in [(1.000_04, 0, "holds"), (1.000_4, 1, "fails")] {
        sky("a", 1.0);
        sky("b", radiance);
        let names = |side: &str| (0..SEEDS).map(|i| format!("{side}{i}.exr")).collect::<Vec<_>>();
        let words = [
            vec!["compare".into(), "--max-bias".into(), "1".into()],
            names("a"),
            vec!["--".into()],
            names("b"),
        ]
        .concat();
        let arguments: Vec<&str> = words.iter().map(String::as_str).collect();
        let output = lightproof("rounded", &arguments).0;
        assert_eq!(output.status.code(), Some(status), "{}", text(&output.stdout));
        assert!(text(&output.stdout).starts_with(verdict), "{}", text(&output.stdout));
    }
}

#[test]
fn images_that_cannot_be_compared_are_refused() {
    let folder = empty("refused");
    write_seeds(&folder, "a", 1.0);
    exr::write(&folder.join("small.exr"), &Image::new(1, 1, vec![[1.0; 3]])).expect("writes");
    assert_refused(&lightproof("refused", &["compare", "a0.exr"]).0, &["two images"]);
    assert_refused(&lightproof("refused", &["compare", "a0.exr", "none.exr"]).0, &["none.exr"]);
    assert_refused(&lightproof("refused", &["compare", "a0.exr", "small.exr"]).0, &["64×48", "1×1"]);
    assert_refused(
        &lightproof("refused", &["compare", "a0.exr", "a1.exr", "--max-bias=-1"]).0,
        &["bound", "-1"],
    );
    let sidecar = |sums: serde_json::Value| {
        let text = serde_json::json!({"tile": 16, "tile_sums": [sums]}).to_string();
        std::fs::write(folder.join("a1.json"), text).expect("writes");
        lightproof("refused", &["compare", "a0.exr", "a1.exr"]).0
    };
    // 64×48 pixels are 3 rows of 4 tiles of 3 channels.
    let too_few = sidecar(serde_json::json!([[[1.0, 2.0, 3.0]]]));
    assert_refused(&too_few, &["a1.json", "3 values", "36 are accepted"]);
    let of_another = sidecar(serde_json::json!(vec![[[1.0; 3]; 4]; 3]));
    assert_refused(&of_another, &["a1.json", "tile 0, channel 0"]);
}

/// The reference scene of that name.
fn reference(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/scenes");
    folder.join(name).with_extension("xml").display().to_string()
}

#[test]
fn effects_are_listed_with_their_shares() {
    let arguments = ["effects", &reference("thin-lens"), "-D", "res=16", "--samples", "64", "--json", "-"];
    let (output, _) = lightproof("effects", &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let data: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("JSON alone on standard output");
    let effects = data["effects"].as_array().expect("a list");
    let lens = effects.iter().find(|row| row["effect"] == "lens").expect("a scene with a lens");
    let [low, high] = [0, 1].map(|i| lens["variance"]["interval"][i].as_f64().expect("a limit"));
    // At 16 × 16 pixels the blur of the lens is most of what varies in a pixel, and cannot be more than all.
    assert!(low < high && high > 0.1 && low < 1.0, "{lens}");
    assert!(text(&output.stderr).contains("lens"), "the table is for people");
}

#[test]
fn neighbours_share_paths_of_one_moment_only() {
    let scene = reference("cornell");
    let render = |name: &str, more: &[&str]| {
        let work = [&["render", &scene, "--spp", "16", "-D", "res=16", "-o", name][..], more].concat();
        lightproof("reuse", &work)
    };
    let (_, folder) = render("own.exr", &[]);
    render("shared.exr", &["--reuse"]);
    let image = |name: &str| exr::read(&folder.join(name)).expect("it was written");
    let shared_by = |name: &str| image(name).metadata.provenance.map(|provenance| provenance.shared_by);
    assert_eq!(["own.exr", "shared.exr"].map(shared_by), [Some(1), Some(8)]);
    assert_ne!(image("own.exr").rgb, image("shared.exr").rgb);
    let moving = ["render", &reference("moving"), "--reuse"];
    assert_refused(&lightproof("reuse", &moving).0, &["--reuse", "without shutter"]);
}

#[test]
fn paths_from_lights_are_refused_where_they_find_nothing() {
    let render = |more: &[&str]| lightproof("light-paths", &[&["render"], more].concat()).0;
    // Diffuse surfaces alone; and a range of the samples.
    assert_refused(&render(&[&reference("cornell"), "--light-paths"]), &["--light-paths", "isn't diffuse"]);
    let glass = [&reference("glass"), "--light-paths"];
    assert_eq!(render(&[&glass[..], &["--samples", "0..4"]].concat()).status.code(), Some(2));
    let sampler = ["--sampler", "halton"];
    assert_refused(&render(&[&glass[..], &sampler].concat()), &["paths from lights", "sobol"]);
}

#[test]
fn an_effect_left_out_is_not_drawn() {
    let scene = reference("thin-lens");
    let common = ["render", &scene, "-D", "res=16", "--spp", "4", "-o"];
    let render = |file: &str, more: &[&str]| {
        let (output, folder) = lightproof("without", &[&common[..], &[file], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        exr::read(&folder.join(file)).expect("an image").rgb
    };
    let pinhole = render("a.exr", &["--without", "lens"]);
    assert_ne!(pinhole, render("b.exr", &[]));
    // A scene without a wide filter is the same without it.
    assert_eq!(pinhole, render("c.exr", &["--without", "lens", "--without", "filter"]));
    let (refused, _) = lightproof("without", &["render", &scene, "--without", "lenses"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("area-light"), "the accepted names are listed");
}
