//! Meshes in serialized files: read and placed, or refused in one line.
#![no_main]

use std::path::Path;
use std::sync::Arc;

use libfuzzer_sys::fuzz_target;
use renderer::io::mesh::{MeshFormat, parse};
use renderer::shapes::{Shape, ShapeSettings};

fuzz_target!(|data: &[u8]| {
    for shape in 0..2 {
        match parse(Path::new("fuzzed"), data, MeshFormat::Serialized { shape }) {
            Ok(mesh) => drop(Shape::new(&ShapeSettings::Mesh(Arc::new(mesh)), &Default::default(), false)),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
});
