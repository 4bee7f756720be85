//! Images in EXR files: decoded, or refused in one line.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use renderer::io::exr::decode;

fuzz_target!(|data: &[u8]| {
    if let Err(error) = decode(Path::new("fuzzed"), data) {
        assert!(!error.to_string().contains('\n'), "{error}");
    }
});
