//! `build`: a crate that compiles the models of a file.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::args::BuildArgs;
use crate::error::CliError;
use crate::exit::Exit;
use crate::model_file::EXTENSION;
use crate::{Streams, model_file};

/// Carries out `build`.
///
/// # Errors
/// A file that cannot be read or has mistakes, a folder that is not empty or cannot be written.
pub fn run(args: &BuildArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    let given = args.file.display().to_string();
    if let (false, Some((file, _))) = (args.file.exists(), given.rsplit_once(':'))
        && Path::new(file).is_file()
    {
        let expected = format!("a whole file: `{file}`");
        return Err(CliError::value("FILE", given, expected));
    }
    let text = model_file::text(&given, streams.input)?;
    let models = dalembert_jit::load(&given, &text).map_err(CliError::Declaration)?;
    let models: Vec<String> = models.into_iter().map(|model| model.name).collect();
    let folder = match &args.to {
        Some(folder) => folder.clone(),
        None => args.file.with_extension(""),
    };
    let name = folder.file_name().and_then(|name| name.to_str());
    let Some(name) = name.filter(|name| is_package_name(name)) else {
        let expected = "a folder named with letters, digits, `_` and `-`, a letter first; give one with --to FOLDER";
        return Err(CliError::value(
            "--to",
            folder.display().to_string(),
            expected,
        ));
    };
    let package = Package {
        name,
        models: &models,
        text: &text,
        library: library(args.library.as_deref())?,
    };
    package.write("--to", &folder, streams.output)?;
    Ok(Exit::Reached)
}

fn is_package_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// True for a name that a crate with this command line cannot have.
fn is_reserved(name: &str) -> bool {
    let name = name.replace('-', "_");
    name.starts_with("dalembert")
        || ["alloc", "core", "proc_macro", "std", "test"].contains(&name.as_str())
}

/// The folder of the library: the given one, else the one from which this command was built.
///
/// # Errors
/// A folder without the library.
pub(crate) fn library(given: Option<&Path>) -> Result<PathBuf, CliError> {
    let built_from = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let folder = given.unwrap_or(Path::new(built_from));
    let found = folder.canonicalize().ok();
    let is_library = |folder: &PathBuf| folder.join("runtime/Cargo.toml").is_file();
    found.filter(is_library).ok_or_else(|| {
        let expected = "the folder of dalembert, with `runtime` and `models` in it; give it with --library FOLDER";
        CliError::value("--library", folder.display().to_string(), expected)
    })
}

/// A crate with the command line over the models of one file.
pub(crate) struct Package<'a> {
    pub name: &'a str,
    /// The names of the types.
    pub models: &'a [String],
    pub text: &'a str,
    pub library: PathBuf,
}

impl Package<'_> {
    /// Writes the crate into a folder that is new or empty.
    pub(crate) fn write(
        &self,
        flag: &'static str,
        folder: &Path,
        output: &mut dyn Write,
    ) -> Result<(), CliError> {
        let failed = |path: &Path, source| CliError::File {
            flag,
            path: path.to_owned(),
            source,
        };
        if is_reserved(self.name) {
            let expected = "another name: a crate on which this one depends, or one of the standard library, has it";
            return Err(CliError::value(flag, self.name, expected));
        }
        let source = folder.join("src");
        let is_empty =
            |folder: &Path| fs::read_dir(folder).map(|mut entries| entries.next().is_none());
        fs::create_dir_all(folder)
            .and_then(|()| match is_empty(folder)? {
                true => fs::create_dir(&source),
                false => Err(io::Error::from(io::ErrorKind::DirectoryNotEmpty)),
            })
            .map_err(|error| failed(folder, error))?;
        for (path, text) in [
            (folder.join("Cargo.toml"), self.manifest()),
            (source.join("main.rs"), self.main()),
            (source.join(self.file()), self.text.to_owned()),
        ] {
            fs::write(&path, text).map_err(|error| failed(&path, error))?;
        }
        let manifest = folder.join("Cargo.toml");
        writeln!(
            output,
            "wrote {}; `cargo run --release --manifest-path {} -- list` builds it",
            folder.display(),
            manifest.display()
        )?;
        Ok(())
    }

    fn file(&self) -> String {
        format!("{}.{EXTENSION}", self.name.replace('-', "_"))
    }

    fn manifest(&self) -> String {
        let name = self.name;
        let [runtime, cli] = ["runtime", "models/cli"]
            .map(|part| format!("{:?}", self.library.join(part).display().to_string()));
        format!(
            "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
             [features]\n# Inlines the functions of the models into the code that runs them. The build takes minutes.\n\
             inlined = [\"dalembert-cli/inlined\"]\n\n\
             [dependencies]\ndalembert = {{ path = {runtime} }}\ndalembert-cli = {{ path = {cli} }}\n\n\
             [workspace]\n"
        )
    }

    fn main(&self) -> String {
        let (file, models) = (self.file(), self.models.join(", "));
        format!(
            "use std::process::ExitCode;\n\ndalembert::model_file!(\"src/{file}\");\n\n\
             fn main() -> ExitCode {{\n    dalembert_cli::run(dalembert_cli::models![{models}])\n}}\n"
        )
    }
}
