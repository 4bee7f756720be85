//! A file of the renderer imports lower ranks or its own folder only.

use std::fs;
use std::path::{Path, PathBuf};

const RANKS: [&[&str]; 11] = [
    &["error", "math"],
    &["sampling"],
    &["ray", "texture"],
    &["interaction"],
    &["shapes", "materials", "camera", "film"],
    &["accel"],
    &["lights"],
    &["scene"],
    &["integrator"],
    &["render"],
    &["io"],
];

fn rank(module: &str) -> Option<usize> {
    RANKS.iter().position(|names| names.contains(&module))
}

fn files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// The modules of every `crate::` path in `text`, comments apart, `use crate::{…}` included.
fn imports(text: &str) -> Vec<String> {
    let code: String =
        text.lines().filter(|l| !l.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let name = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
        match rest.strip_prefix('{') {
            Some(list) => {
                found.extend(list.split('}').next().unwrap_or("").split(',').map(|s| name(s.trim())));
            }
            None => found.push(name(rest)),
        }
    }
    found
}

#[test]
fn no_file_imports_a_higher_rank_or_a_neighbour() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = Vec::new();
    files(&source, &mut all);
    let mut wrong = Vec::new();
    let mut checked = 0;
    for file in &all {
        let relative = file.strip_prefix(&source).unwrap();
        let module = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let own = rank(module).unwrap_or_else(|| panic!("{module} has no rank"));
        for import in imports(&fs::read_to_string(file).unwrap()) {
            // types re-exported at the root are the errors, rank 0
            let Some(other) =
                rank(&import).or(matches!(import.as_str(), "Error" | "ParamError").then_some(0))
            else {
                wrong.push(format!("{}: {import} has no rank", relative.display()));
                continue;
            };
            checked += 1;
            if other > own || (other == own && import != module && own != 0) {
                wrong.push(format!(
                    "{}: {module} (rank {own}) imports {import} (rank {other})",
                    relative.display()
                ));
            }
        }
    }
    assert!(checked > 0, "no import was found: the reader of imports is broken");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_reader_of_imports_sees_paths_lists_and_no_comments() {
    let text = "use crate::{scene::Scene, math};\n// crate::io\nlet x = crate::render::go();";
    assert_eq!(imports(text), ["scene", "math", "render"]);
}
