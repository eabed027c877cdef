//! The pages of the book, as `docs/SUMMARY.md` lists them.

use std::path::{Component, Path, PathBuf};

/// The folder of the book.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// Paths of all pages below `docs/`.
pub fn all() -> Vec<String> {
    let summary = text("SUMMARY.md");
    let links = summary.split("](").skip(1);
    links
        .filter_map(|link| Some(link.split_once(')')?.0.to_owned()))
        .collect()
}

/// The text of a page.
pub fn text(page: &str) -> String {
    let path = folder().join(page);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The pictures that the commands of a page draw, each with the number of its line. Pictures in a folder `images` are
/// not drawn by a command.
pub fn pictures(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate();
    lines.filter_map(|(index, line)| {
        let (_, rest) = line.strip_prefix("![")?.split_once("](")?;
        let path = rest.split_once(')')?.0;
        (!path.contains("images/")).then_some((index + 1, path))
    })
}

/// The path of a file that a page names.
pub fn target(page: &str, path: &str) -> PathBuf {
    let mut place = folder();
    let named = Path::new(page).parent().map(|parent| parent.join(path));
    for part in named.iter().flat_map(|path| path.components()) {
        match part {
            Component::ParentDir => drop(place.pop()),
            part => place.push(part),
        }
    }
    place
}
