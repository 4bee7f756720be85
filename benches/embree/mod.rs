//! Ray queries by Embree 3, where it is installed, for comparison.

use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use renderer::ray::Ray;
use renderer::shapes::MeshData;

/// The program that asks Embree, with a mesh and sets of rays.
#[derive(Debug)]
pub struct Embree {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    /// What it has built, and in how many seconds.
    pub builds: Vec<(&'static str, f64)>,
}

impl Embree {
    /// Compiles the program into `folder`; `None`, with a message, where that isn't possible.
    pub fn compile(folder: &Path) -> Option<PathBuf> {
        let program = folder.join("embree");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("embree/embree.cpp");
        let mut compile = Command::new("g++");
        compile.args(["-O3", "-march=native", "-std=c++17", "-pthread"]).arg(&source).arg("-o").arg(&program);
        let compiled = compile.arg("-lembree3").stderr(Stdio::null()).status();
        if !compiled.is_ok_and(|status| status.success()) {
            println!(
                "no comparison with Embree: {} needs g++ and Embree 3 (libembree-dev)",
                source.display()
            );
            return None;
        }
        Some(program)
    }

    /// Starts the compiled program, with the mesh and the rays in a file beside it.
    ///
    /// # Panics
    /// If the file can't be written or the program ends early.
    pub fn start(program: &Path, mesh: &MeshData, sets: &[&[Ray]]) -> Self {
        let data = program.with_extension("bin");
        write_input(&data, mesh, sets).unwrap_or_else(|error| panic!("{}: {error}", data.display()));
        let child = Command::new(program).arg(&data).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let input = child.stdin.take().expect("it is piped");
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        let mut embree = Self { child, input, output, builds: Vec::new() };
        for name in ["robust", "default"] {
            let line = embree.line();
            embree.builds.push((name, line.parse().unwrap_or_else(|_| panic!("Embree's answer {line:?}"))));
        }
        embree
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap_or_else(|error| panic!("Embree's answer: {error}"));
        line.trim().into()
    }

    /// Seconds and hits of a query of all rays of a set: of processor time for one thread, of the clock for more.
    ///
    /// * `query`: as `embree.cpp` lists them.
    ///
    /// # Panics
    /// If the program ends early.
    pub fn ask(&mut self, query: &str, set: usize, threads: usize) -> (f64, usize) {
        writeln!(self.input, "{query} {set} {threads}")
            .unwrap_or_else(|error| panic!("asking Embree: {error}"));
        let line = self.line();
        let answer = line.split_once(' ').and_then(|(s, n)| Some((s.parse().ok()?, n.parse().ok()?)));
        answer.unwrap_or_else(|| panic!("Embree's answer {line:?}"))
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // It ends by itself at the end of its input; an error here means that it has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Writes what embree.cpp reads: counted lists of positions, triangles and sets of rays, all in native byte order.
fn write_input(path: &Path, mesh: &MeshData, sets: &[&[Ray]]) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    let count = |file: &mut BufWriter<_>, n: usize| file.write_all(&(n as u64).to_ne_bytes());
    count(&mut file, mesh.positions.len())?;
    for coordinate in mesh.positions.iter().flatten() {
        file.write_all(&coordinate.to_ne_bytes())?;
    }
    count(&mut file, mesh.triangles.len())?;
    for index in mesh.triangles.iter().flatten() {
        file.write_all(&index.to_ne_bytes())?;
    }
    count(&mut file, sets.len())?;
    for set in sets {
        count(&mut file, set.len())?;
        for ray in *set {
            let [o, d] = [ray.origin, ray.direction];
            for number in [o.x, o.y, o.z, ray.t_max, d.x, d.y, d.z, ray.time] {
                file.write_all(&number.to_ne_bytes())?;
            }
        }
    }
    file.flush()
}
