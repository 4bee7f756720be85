//! `lightproof samples` as its users meet it: points of other programs, right, wrong and broken.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use verify::points::fill;

/// Enough that a right disk is settled at the default bound of 2 %: χ² with 199 degrees of freedom takes 5.3e5.
const POINTS: u64 = 700_000;

/// A folder of its own for a test, with a file in it.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("samples-{name}"));
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("the file can be written");
    path
}

fn samples(path: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightproof"))
        .arg("samples")
        .arg(path.file_name().expect("a file"))
        .args(arguments)
        .current_dir(path.parent().expect("a folder"))
        .output()
        .expect("the program starts")
}

/// An .npy file of version 1 with single-precision points of two coordinates.
fn npy(rows: u64, points: impl Iterator<Item = [f64; 2]>) -> Vec<u8> {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, 2), }}");
    while (10 + header.len() + 1) % 64 > 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).expect("a short header").to_le_bytes());
    bytes.extend(header.bytes());
    #[expect(clippy::cast_possible_truncation, reason = "single precision is what most programs write")]
    points.flatten().for_each(|x| bytes.extend((x as f32).to_le_bytes()));
    bytes
}

/// Points of a disk of radius 2 whose radius is 2·ξ^exponent.
fn disk(exponent: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..POINTS).map(move |i| {
        let mut u = [0.0; 2];
        fill(7, i, &mut u);
        let (r, phi) = (2.0 * u[0].powf(exponent), std::f64::consts::TAU * u[1]);
        [r * phi.cos(), r * phi.sin()]
    })
}

#[test]
fn a_right_disk_holds() {
    let output =
        samples(&file("right.npy", &npy(POINTS, disk(0.5))), &["--domain", "disk:r=2", "--json", "-"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
    assert_eq!((&json["verdict"], &json["n"]), (&"holds".into(), &POINTS.into()));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("holds"));
}

#[test]
fn a_radius_of_another_exponent_fails_and_leaves_a_picture_and_a_command() {
    let path = file("wrong.npy", &npy(POINTS, disk(0.51)));
    let output = samples(&path, &["--domain", "disk:r=2"]);
    let words = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.starts_with("fails") && words.contains("residual"), "{words}");
    assert!(
        words.contains("repeat with: lightproof samples wrong.npy --domain disk:r=2 --bound 2"),
        "{words}"
    );
    let picture = path.with_file_name("target").join("lightproof/wrong.svg");
    let drawn = std::fs::read_to_string(picture).expect("a picture");
    assert!(drawn.starts_with("<svg") && drawn.contains("observed") && drawn.contains("repeat with"));
}

#[test]
fn atoms_and_tables_of_densities_are_taken() {
    // A quarter of the points at the centre.
    let points = disk(0.5).enumerate().map(|(i, p)| if i % 4 == 0 { [0.0; 2] } else { p });
    let path = file("atom.npy", &npy(POINTS, points));
    let with_atom = samples(&path, &["--domain", "disk:r=2", "--atom", "0/0=0.25", "--bound", "3"]);
    assert_eq!(with_atom.status.code(), Some(0), "{with_atom:?}");
    assert_eq!(samples(&path, &["--domain", "disk:r=2", "--bound", "3"]).status.code(), Some(1));
    let values = [0.25 / std::f64::consts::PI; 2];
    let table = path.with_file_name("table.npy");
    std::fs::write(&table, npy(3, [values; 3].into_iter())).expect("the file can be written");
    let right = file("table-points.npy", &npy(POINTS, disk(0.5)));
    let table = table.to_str().expect("a plain name");
    let with_table = samples(&right, &["--domain", "disk:r=2", "--pdf", table]);
    assert_eq!(with_table.status.code(), Some(0), "{with_table:?}");
}

#[test]
fn text_is_read_and_cubes_are_tested_by_their_projections() {
    let row = |i: u64| {
        let mut u = [0.0; 3];
        fill(3, i, &mut u);
        format!("{},{},{}\n", u[0], u[1], 0.5 * u[2] + if u[0] < 0.5 { 0.0 } else { 0.5 })
    };
    let text = String::from("a,b,c\n") + &(0..20_000).map(row).collect::<String>();
    let output = samples(&file("cube.csv", text.as_bytes()), &["--domain", "cube:d=3"]);
    let words = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("least likely: axes 0 and 2"), "{words}");
}

#[test]
fn bad_files_are_answered_with_status_2_and_the_row() {
    let two = |second: f64| npy(2, [[0.1, 0.2], [second, 0.3]].into_iter());
    let raw = [0u8; 20];
    let cases: [(&str, Vec<u8>, &[&str], &str); 9] = [
        ("nan.npy", two(f64::NAN), &[], "row 1 (the first is 0): NaN in column 0"),
        ("shape.npy", two(0.5), &["--domain", "sphere"], "its shape is (2, 2); (n, 3) is accepted"),
        (
            "short.npy",
            npy(3, [[0.1, 0.2], [0.3, 0.4]].into_iter()),
            &[],
            "row 2 (the first is 0): the file ends",
        ),
        ("cut.npy", two(0.5)[..2 * 64 + 11].to_vec(), &[], "row 1 (the first is 0): the file ends"),
        ("long.npy", npy(1, [[0.1, 0.2], [0.3, 0.4]].into_iter()), &[], "more bytes after"),
        ("empty.csv", Vec::new(), &[], "no points"),
        ("word.csv", b"0.1,0.2\n0.3,x\n".to_vec(), &[], "row 1 (the first is 0): line 2: \"x\" is no number"),
        (
            "raw.f32",
            raw.to_vec(),
            &["--dtype", "f32"],
            "row 2 (the first is 0): the file ends after 1 of 2 values",
        ),
        ("raw.bin", raw.to_vec(), &[], "--dtype f32 or f64"),
    ];
    for (name, bytes, arguments, part) in cases {
        let domain: &[&str] = if arguments.contains(&"--domain") { &[] } else { &["--domain", "square"] };
        let output = samples(&file(name, &bytes), &[domain, arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(
            message.starts_with(&format!("error: {name}: ")) && message.contains(part),
            "{name}: {message}"
        );
    }
}

#[test]
fn a_low_discrepancy_source_is_refused() {
    let path = file("sobol.npy", &npy(1, [[0.1, 0.2]].into_iter()));
    let output = samples(&path, &["--domain", "square", "--source", "low-discrepancy"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("assumes independent draws"));
}
