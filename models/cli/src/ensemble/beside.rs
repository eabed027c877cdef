//! The file of rows and the files beside it, replaced and removed together.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Ending of the file that replaces another one when it is complete.
pub const NEW: &str = ".new";

/// Endings of the files beside a file of rows.
const ENDINGS: [&str; 3] = [".meta.json", ".sums", ".counts"];

/// The path with an ending appended to its name.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// Writes a file atomically.
///
/// # Errors
/// An I/O error of the file system.
pub fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let new = beside(path, NEW);
    fs::write(&new, content)?;
    fs::rename(&new, path)
}

/// Removes a file, if it exists.
///
/// # Errors
/// An I/O error of the file system.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Removes rows and the files beside them.
///
/// # Errors
/// An I/O error of the file system.
pub fn discard(path: &Path) -> io::Result<()> {
    remove(path)?;
    let mut endings = ENDINGS.iter();
    endings.try_for_each(|ending| remove(&beside(path, ending)))
}

/// Replaces the rows `target`, and the files beside them, by new ones. A link to the old rows stays a link.
///
/// # Errors
/// An I/O error of the file system.
pub fn publish(new: &Path, target: &Path) -> io::Result<()> {
    let renamed = fs::rename(new, fs::canonicalize(target)?);
    // The target of a link may lie on another device.
    renamed.or_else(|_| fs::copy(new, target).and_then(|_| fs::remove_file(new)))?;
    for ending in ENDINGS {
        let place = beside(target, ending);
        match fs::rename(beside(new, ending), &place) {
            Err(error) if error.kind() == ErrorKind::NotFound => remove(&place)?,
            moved => moved?,
        }
    }
    Ok(())
}
