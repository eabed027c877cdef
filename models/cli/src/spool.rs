//! Buffer for the rows of a JSON array, because a document states the end of a run before its events. The last rows are
//! in memory. Earlier rows are in a temporary file if there are many.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use serde_json::Value;

/// Size of the buffer in memory, in bytes.
const ROOM: usize = 1 << 20;

/// Largest number of names that are tried for a temporary file.
const NAMES: u32 = 1000;

/// The buffered rows as text.
pub struct Spool {
    /// The end of the text, which is in memory.
    text: Vec<u8>,
    /// The text before it, in a file.
    file: Option<Temporary>,
    room: usize,
}

impl Spool {
    /// An empty buffer.
    pub fn new() -> Self {
        Self::with_room(ROOM)
    }

    fn with_room(room: usize) -> Self {
        Self {
            text: Vec::new(),
            file: None,
            room,
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// The temporary file cannot be written.
    pub fn push(&mut self, row: &Value) -> io::Result<()> {
        let is_first = self.text.is_empty() && self.file.is_none();
        write!(self.text, "{}\n{row}", if is_first { "" } else { "," })?;
        if self.text.len() > self.room {
            let file = match &mut self.file {
                Some(file) => file,
                none => none.insert(Temporary::create()?),
            };
            file.file.write_all(&self.text)?;
            self.text.clear();
        }
        Ok(())
    }

    /// Writes the array.
    ///
    /// # Errors
    /// An I/O error of the stream or the temporary file.
    pub fn write(&self, output: &mut dyn Write) -> io::Result<()> {
        write!(output, "[")?;
        if let Some(Temporary { file, .. }) = &self.file {
            let mut file = file;
            file.rewind()?;
            io::copy(&mut file.take(u64::MAX), output)?;
        }
        output.write_all(&self.text)?;
        let is_empty = self.text.is_empty() && self.file.is_none();
        write!(output, "{}]", if is_empty { "" } else { "\n" })
    }
}

/// A temporary file. Its name is removed at once, or in `drop` on systems that do not remove the name of an open file.
struct Temporary {
    file: File,
    path: Option<PathBuf>,
}

impl Temporary {
    fn create() -> io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let mut taken = io::Error::from(io::ErrorKind::AlreadyExists);
        for _ in 0..NAMES {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let name = format!("dalembert-{}-{count}.part", std::process::id());
            let path = std::env::temp_dir().join(name);
            let mut options = OpenOptions::new();
            match options.read(true).write(true).create_new(true).open(&path) {
                Ok(file) => {
                    let path = fs::remove_file(&path).is_err().then_some(path);
                    return Ok(Self { file, path });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => taken = error,
                Err(error) => return Err(error),
            }
        }
        Err(taken)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            // A file that cannot be removed does no harm.
            let _ = fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(rows: u64, room: usize) -> String {
        let mut spool = Spool::with_room(room);
        for row in 0..rows {
            spool.push(&Value::from(row)).expect("a temporary file");
        }
        let mut text = Vec::new();
        spool.write(&mut text).expect("memory takes everything");
        String::from_utf8(text).expect("text")
    }

    #[test]
    fn rows_in_memory_and_in_a_file_are_the_same_text() {
        assert_eq!(written(0, 10), "[]");
        assert_eq!(written(2, 10), "[\n0,\n1\n]");
        for rows in [1, 3, 4, 5, 1000] {
            assert_eq!(written(rows, 7), written(rows, usize::MAX), "{rows}");
            assert_eq!(written(rows, 0), written(rows, usize::MAX), "{rows}");
        }
    }
}
