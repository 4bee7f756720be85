//! Where a command's words go: standard output, or standard error when standard output carries JSON.

use std::io::{IsTerminal, Write, stderr, stdout};
use std::path::Path;

/// A stream for people, and whether it may have colour.
pub(super) struct Words {
    stream: Box<dyn Write>,
    colour: bool,
}

impl Words {
    /// Standard output; standard error when `json` is `-`. Colour on a terminal only, and not where `NO_COLOR` is set.
    pub(super) fn beside(json: Option<&Path>) -> Self {
        let (stream, terminal): (Box<dyn Write>, bool) = if json.is_some_and(is_stdout) {
            (Box::new(stderr()), stderr().is_terminal())
        } else {
            (Box::new(stdout()), stdout().is_terminal())
        };
        Self { stream, colour: terminal && std::env::var_os("NO_COLOR").is_none() }
    }

    /// The text in a colour of the terminal (31 red, 32 green, 33 yellow), where there is colour.
    pub(super) fn painted(&self, text: &str, colour: u8) -> String {
        if self.colour { format!("\x1b[{colour}m{text}\x1b[0m") } else { String::from(text) }
    }
}

impl Write for Words {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}

/// Whether the path means standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}
