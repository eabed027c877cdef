//! Temporary folders of tests.

use std::fs;
use std::path::PathBuf;

/// A folder of one test, removed at the end of the test. No two tests may use the same name.
pub struct Folder(pub PathBuf);

impl Folder {
    /// A new folder.
    pub fn new(name: &str) -> Self {
        let folder = Self::not_made(name);
        fs::create_dir_all(&folder.0).unwrap();
        folder
    }

    /// A folder that a command has to make.
    pub fn not_made(name: &str) -> Self {
        let name = format!("dalembert-{name}-{}", std::process::id());
        Self(std::env::temp_dir().join(name))
    }

    /// The path of a file.
    pub fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    /// Writes a file with this text, and returns its path.
    pub fn file(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        fs::write(&path, text).unwrap();
        path
    }

    /// The text of a file.
    pub fn read(&self, name: &str) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A test that fails before it has written has nothing to remove. A folder that stays does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}
