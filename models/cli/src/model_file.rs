//! Models in files: a model argument may name a file and a model in it.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::args::Selection;
use crate::entry::Entry;
use crate::error::CliError;
use crate::feedback;
use crate::names;
use crate::state_input::find_model;

/// The file name extension of files with models.
pub(crate) const EXTENSION: &str = "dal";

/// The argument that stands for the standard input.
const INPUT: &str = "-";

/// The longest accepted text, in bytes.
const LONGEST: u64 = 1 << 20;

/// The file of an argument; `None` for the standard input and for a model name.
pub(crate) fn path(given: &str) -> Option<&Path> {
    let (file, _) = split(given)?;
    (file != INPUT).then_some(Path::new(file))
}

/// The models that replace those of the command line. With feedback, this is the selected model alone, with its inputs
/// replaced by the feedback laws. Otherwise these are the models of the file that the model argument names. If the
/// argument names a file, it is replaced by the name of the selected model. `None` if the argument names no file and
/// there is no feedback.
///
/// # Errors
/// The errors of [`read`] and of [`feedback::close`].
pub(crate) fn selected(
    selection: Selection<'_>,
    models: &[Entry],
    input: &mut dyn Read,
) -> Result<Option<Vec<Entry>>, CliError> {
    let Selection {
        model,
        feedback,
        skips_claims,
    } = selection;
    // Claims are examined once, on the model that runs.
    let read = read(model, skips_claims || !feedback.is_empty(), input)?;
    let of_file = read.map(|(models, name)| {
        *model = name;
        models
    });
    if feedback.is_empty() {
        return Ok(of_file);
    }
    let entry = find_model(of_file.as_deref().unwrap_or(models), model)?;
    feedback::close(entry, feedback, skips_claims).map(|closed| Some(vec![closed]))
}

/// The models in the file that an argument names, and the name of the selected one: `disk.dal`, or `systems.dal:disk`
/// for a file with several models. `None` if the argument names no file.
///
/// # Errors
/// A file that cannot be read, all mistakes in the declarations, an unknown or missing name.
fn read(
    given: &str,
    skips_claims: bool,
    input: &mut dyn Read,
) -> Result<Option<(Vec<Entry>, String)>, CliError> {
    let Some((file, name)) = split(given) else {
        return Ok(None);
    };
    let text = text(file, input)?;
    let shown = if file == INPUT {
        "standard input"
    } else {
        file
    };
    let entries = entries(shown, &text, skips_claims)?;
    let all = entries.iter().map(Entry::name);
    let chosen = match (name, entries.as_slice()) {
        (Some(name), _) => names::find(file, "model", name, all)?,
        (None, [_]) => 0,
        (None, _) => {
            // An argument that begins with a hyphen stands behind `--`.
            let before = if file == INPUT { "-- " } else { "" };
            let several: Vec<String> = all.map(|name| format!("{before}{file}:{name}")).collect();
            let expected = format!("one of its models: {}", several.join(", "));
            return Err(CliError::value("MODEL", file, expected));
        }
    };
    let entry = &entries[chosen];
    entry.check_size()?;
    let name = entry.name().to_owned();
    Ok(Some((entries, name)))
}

/// The models of a text. `shown` is its name in messages.
///
/// # Errors
/// Every mistake in the text.
pub(crate) fn entries(shown: &str, text: &str, skips_claims: bool) -> Result<Vec<Entry>, CliError> {
    let load = match skips_claims {
        true => dalembert_jit::load_without_claims,
        false => dalembert_jit::load,
    };
    let models = load(shown, text).map_err(CliError::Declaration)?;
    Ok(models.iter().map(Entry::loaded).collect())
}

/// The file that an argument names, and the name of the model in it, if given.
fn split(given: &str) -> Option<(&str, Option<&str>)> {
    let is_file = |name: &str| {
        let path = Path::new(name);
        name == INPUT
            // A pipe is a file, too.
            || (path.exists() && !path.is_dir())
            || path.extension().is_some_and(|ending| ending == EXTENSION)
    };
    if is_file(given) {
        return Some((given, None));
    }
    if let Some((file, name)) = given.rsplit_once(':')
        && is_file(file)
    {
        return Some((file, Some(name)));
    }
    // No model has a name with a slash.
    given.contains('/').then_some((given, None))
}

/// The text of a file, or of the standard input.
///
/// # Errors
/// A file that cannot be read or is too long.
pub(crate) fn text(file: &str, input: &mut dyn Read) -> Result<String, CliError> {
    let failed = |source| CliError::File {
        flag: "MODEL",
        path: PathBuf::from(file),
        source,
    };
    let mut bytes = Vec::new();
    let read = match file {
        INPUT => input.take(LONGEST + 1).read_to_end(&mut bytes),
        _ => File::open(file).and_then(|opened| opened.take(LONGEST + 1).read_to_end(&mut bytes)),
    };
    read.map_err(failed)?;
    // NOTE: before the bytes are read as characters, one of which may be cut.
    if bytes.len() as u64 > LONGEST {
        return Err(CliError::value(
            "MODEL",
            file,
            format!("a text of at most {LONGEST} bytes"),
        ));
    }
    String::from_utf8(bytes).map_err(|error| failed(io::Error::other(error)))
}
