//! `gallery`: draws figures of the models on one page, writes each picture as a file, and a manifest.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use crate::args::GalleryArgs;
use crate::entry::Entry;
use crate::error::{CliError, counted};
use crate::exit::Exit;
use crate::gallery::{self, Effort, Figure, Plate, Print};
use crate::progress::Steps;
use crate::sink::Sink;
use crate::{Catalogue, Streams, names};

/// Carries out `gallery`.
///
/// # Errors
/// Unknown names, a folder that cannot be written. Pictures that cannot be made are not an error but an [`Exit`].
pub fn run(
    catalogue: &Catalogue,
    args: &GalleryArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let figures = figures(catalogue, &args.models)?;
    let effort = match args.quick {
        true => Effort::Quick,
        false => Effort::Full,
    };
    let plates = chosen(Plate::all(&figures, effort, args.animations), &args.picture)?;
    let folder = match &args.out {
        Some(folder) if !args.list => folder,
        _ => {
            list(streams.output, &plates)?;
            return Ok(Exit::Reached);
        }
    };
    // Opened before any picture is drawn, so that a folder that cannot be written is reported at once.
    let page = Sink::open_within(folder, "index.html", args.picture.is_empty())?;
    let manifest = Sink::open_within(folder, "manifest.json", args.picture.is_empty())?;

    let prints = make_all(&plates, catalogue.models(), streams.terminal);
    for (plate, print) in plates.iter().zip(&prints) {
        match print {
            Ok(print) => save(folder, plate, print)?,
            Err(error) => writeln!(streams.errors, "error: {}: {error}", plate.name())?,
        }
    }
    if let Some(sink) = page {
        let text = gallery::page(catalogue.models(), &plates, &prints);
        sink.write(streams, |output| output.write_all(text.as_bytes()))?;
    }
    if let Some(sink) = manifest {
        sink.write(streams, |output| {
            gallery::write_manifest(output, &plates, &prints)
        })?;
    }
    write_totals(streams.output, folder, args, &prints)?;
    Ok(match prints.iter().all(Result::is_ok) {
        true => Exit::Reached,
        false => Exit::Other,
    })
}

/// The figures of the models with these names, or of all models without names. The standard figure of each model comes
/// last.
fn figures(catalogue: &Catalogue, wanted: &[String]) -> Result<Vec<Figure>, CliError> {
    let models = catalogue.models().iter();
    for name in wanted {
        names::find("MODEL", "model", name, models.clone().map(Entry::name))?;
    }
    let asked_for = |name: &str| wanted.is_empty() || wanted.iter().any(|it| it == name);
    let added = catalogue.figures().iter();
    let mut figures: Vec<Figure> = added.filter(|it| asked_for(it.model)).cloned().collect();
    let wanted = models.filter(|entry| asked_for(entry.name()));
    figures.extend(wanted.map(|entry| gallery::standard_figure(entry.description())));
    Ok(figures)
}

/// The pictures with these names, or all pictures without names.
fn chosen<'a>(plates: Vec<Plate<'a>>, wanted: &[String]) -> Result<Vec<Plate<'a>>, CliError> {
    let known: Vec<String> = plates.iter().map(Plate::name).collect();
    for name in wanted {
        let known = known.iter().map(String::as_str);
        names::find("--picture", "picture", name, known)?;
    }
    let asked_for = |plate: &Plate<'_>| wanted.is_empty() || wanted.contains(&plate.name());
    Ok(plates.into_iter().filter(asked_for).collect())
}

fn list(output: &mut dyn Write, plates: &[Plate<'_>]) -> std::io::Result<()> {
    let width = plates.iter().map(|plate| plate.name().len()).max();
    let width = width.unwrap_or(0);
    for plate in plates {
        let Figure { title, source, .. } = plate.figure;
        let source = source.map_or(String::new(), |source| format!(" ({source})"));
        writeln!(
            output,
            "{:width$}  {title}{source}: {}",
            plate.name(),
            plate.panel.title
        )?;
    }
    Ok(())
}

/// Makes untimed pictures on all processors, then timed pictures one by one.
fn make_all(
    plates: &[Plate<'_>],
    models: &[Entry],
    terminal: bool,
) -> Vec<Result<Print, CliError>> {
    let (timed, others): (Vec<usize>, Vec<usize>) =
        (0..plates.len()).partition(|&index| plates[index].is_timed());
    let mut prints: Vec<_> = plates.iter().map(|_| None).collect();
    let mut progress = Steps::new(plates.len(), terminal);
    let processors = thread::available_parallelism().map_or(1, usize::from);
    for (indices, threads) in [(others, processors), (timed, 1)] {
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::channel();
        thread::scope(|scope| {
            for _ in 0..threads {
                let (sender, next, indices) = (sender.clone(), &next, &indices);
                scope.spawn(move || {
                    while let Some(&index) = indices.get(next.fetch_add(1, Ordering::Relaxed)) {
                        // The receiver lives longer than all senders.
                        let _ = sender.send((index, plates[index].make(models)));
                    }
                });
            }
            drop(sender);
            for (index, print) in receiver {
                progress.begin(&plates[index].name());
                progress.aside(|| {});
                prints[index] = Some(print);
            }
        });
    }
    progress.finish();
    prints.into_iter().flatten().collect()
}

fn save(folder: &Path, plate: &Plate<'_>, print: &Print) -> Result<(), CliError> {
    let animation = print.animation.as_ref();
    let files = [(plate.file(), &print.svg)].into_iter();
    for (name, text) in files.chain(animation.map(|page| (plate.animation_file(), page))) {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|source| unwritten(path, source))?;
    }
    Ok(())
}

fn unwritten(path: PathBuf, source: std::io::Error) -> CliError {
    CliError::File {
        flag: "OUT",
        path,
        source,
    }
}

fn write_totals(
    output: &mut dyn Write,
    folder: &Path,
    args: &GalleryArgs,
    prints: &[Result<Print, CliError>],
) -> std::io::Result<()> {
    let failed = prints.iter().filter(|print| print.is_err()).count();
    let made = counted(prints.len() - failed, "picture");
    let failed = match failed {
        0 => String::new(),
        failed => format!(", {failed} could not be made"),
    };
    let place = match args.picture.is_empty() {
        true => folder.join("index.html"),
        false => folder.to_owned(),
    };
    writeln!(output, "{made}{failed}: {}", place.display())
}
