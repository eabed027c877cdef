//! `new`: writes a commented declaration as a starting point, into a file or into a crate.

use std::fs::OpenOptions;
use std::io::{self, Write};

use dalembert_codegen::spec::is_rust_keyword;

use crate::Streams;
use crate::args::NewArgs;
use crate::command::build::{Package, library};
use crate::error::CliError;
use crate::exit::Exit;
use crate::model_file::EXTENSION;

/// The declaration, with `NAME` and `FILE` as placeholders for the names of the model and of the file.
const TEMPLATE: &str = include_str!("new.dal");

/// Carries out `new`.
///
/// # Errors
/// An invalid name, a file that exists, a folder that cannot be written.
pub fn run(args: &NewArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    let stem = args.name.file_stem().and_then(|name| name.to_str());
    let (Some(stem), true) = (stem, is_ending_right(args)) else {
        return Err(refused(args));
    };
    let Some(name) = model_name(stem) else {
        return Err(refused(args));
    };
    let text = TEMPLATE.replace("NAME", &name).replace("FILE", stem);
    if args.with_crate {
        let package = Package {
            name: stem,
            models: &[name],
            text: &text,
            library: library(args.library.as_deref())?,
        };
        package.write("NAME", &args.name.with_extension(""), streams.output)?;
        return Ok(Exit::Reached);
    }
    let path = args.name.with_extension(EXTENSION);
    let failed = |source| CliError::File {
        flag: "NAME",
        path: path.clone(),
        source,
    };
    let mut options = OpenOptions::new();
    let file = options.write(true).create_new(true).open(&path);
    let mut file = file.map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => {
            let expected = "another name: files are not overwritten";
            CliError::value("NAME", path.display().to_string(), expected)
        }
        _ => failed(source),
    })?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    let shown = path.display();
    writeln!(
        streams.output,
        "wrote {shown}; `dalembert watch {shown} --plot {stem}.svg` draws it again whenever it is saved"
    )?;
    Ok(Exit::Reached)
}

fn is_ending_right(args: &NewArgs) -> bool {
    args.name
        .extension()
        .is_none_or(|ending| ending == EXTENSION)
}

fn refused(args: &NewArgs) -> CliError {
    let given = args.name.display().to_string();
    let expected = "small letters, digits and `_`, a letter first, such as `inclined_skate`; no keyword of Rust";
    CliError::value("NAME", given, expected)
}

/// The name of the model in a file: `InclinedSkate` for `inclined_skate`.
fn model_name(stem: &str) -> Option<String> {
    let is_name = stem.starts_with(|c: char| c.is_ascii_lowercase())
        && stem
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && !is_rust_keyword(stem);
    is_name.then(|| {
        let words = stem.split('_').map(|word| {
            let mut letters = word.chars();
            let first = letters.next().map(|letter| letter.to_ascii_uppercase());
            first.into_iter().chain(letters).collect::<String>()
        });
        words.collect()
    })
}
