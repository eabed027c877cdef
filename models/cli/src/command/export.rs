//! `export`: the functions of a model as a C header.

use dalembert_codegen::export;

use crate::Streams;
use crate::args::ExportArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::state_input::find_model;
use crate::{names, sink};

/// Carries out `export`.
///
/// # Errors
/// An unknown model or scene, a file that cannot be written.
pub fn run(
    models: &[Entry],
    args: &ExportArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let entry = find_model(models, &args.model)?;
    let scenes = entry.description().scenes.iter().copied();
    let scene = names::find("--scene", "scene", &args.scene, scenes)?;
    let part = (scene > 0).then_some(args.scene.as_str());
    let parts = export::export(&entry.description().source, part)
        .map_err(|error| CliError::Derive(error.to_string()))?;
    let text = export::header(&parts.unwrap_or_default());
    if sink::is_stdout(&args.c) {
        streams.output.write_all(text.as_bytes())?;
        return Ok(Exit::Reached);
    }
    std::fs::write(&args.c, text).map_err(|source| CliError::File {
        flag: "--c",
        path: args.c.clone(),
        source,
    })?;
    Ok(Exit::Reached)
}
