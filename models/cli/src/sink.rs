//! Outputs of commands: files, or the standard output in their place.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Streams;
use crate::error::CliError;

/// True if the path is `-`, which stands for the standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// The path of a file that this run created. The file is removed unless it is kept: a command that is refused leaves no
/// empty file behind.
pub struct Created(Option<PathBuf>);

impl Created {
    /// Keeps the file, which receives an output now.
    pub fn keep(&mut self) {
        self.0 = None;
    }
}

impl Drop for Created {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // The error that ended the command is reported, not that of a file which stays behind.
            let _ = fs::remove_file(path);
        }
    }
}

/// Opens and locks a file with `options`, and keeps its content. Other runs are refused until the file is closed.
///
/// # Errors
/// The file cannot be written, or another run is writing it.
pub fn claim(
    flag: &'static str,
    path: &Path,
    options: &mut OpenOptions,
) -> Result<(File, Created), CliError> {
    let is_new = fs::symlink_metadata(path).is_err();
    let file = claim_file(flag, path, options)?;
    Ok((file, Created(is_new.then(|| path.to_owned()))))
}

fn claim_file(
    flag: &'static str,
    path: &Path,
    options: &mut OpenOptions,
) -> Result<File, CliError> {
    let failed = |source| CliError::File {
        flag,
        path: path.to_owned(),
        source,
    };
    let file = options
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
        .map_err(failed)?;
    // Devices and pipes may have several writers.
    if !file.metadata().map_err(failed)?.is_file() {
        return Ok(file);
    }
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(CliError::Busy {
            flag,
            path: path.to_owned(),
        }),
        // Some file systems do not support locks.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(failed(error)),
    }
}

/// A file whose old content is kept until the first write or flush.
struct Replaced {
    file: File,
    created: Created,
    is_emptied: bool,
}

impl Replaced {
    /// The file, without its old content.
    fn emptied(&mut self) -> io::Result<&mut File> {
        if !self.is_emptied {
            self.created.keep();
            // Devices and pipes have no length.
            if self.file.metadata()?.is_file() {
                self.file.set_len(0)?;
            }
            self.is_emptied = true;
        }
        Ok(&mut self.file)
    }
}

impl Write for Replaced {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.emptied()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.emptied()?.flush()
    }
}

/// Destination of an output.
pub enum Sink {
    /// To the standard output.
    Stdout,
    /// To a file.
    File {
        /// The flag that named it.
        flag: &'static str,
        /// Its path.
        path: PathBuf,
        /// The open file.
        file: File,
        /// Its path again, if it is new.
        created: Created,
    },
}

impl Sink {
    /// Opens the file before any computation, so that a path that cannot be written is reported at once. The file keeps
    /// its content until the output is written: a command that is refused later loses nothing.
    ///
    /// # Errors
    /// The file cannot be written, or another run is writing it.
    pub fn open(flag: &'static str, path: &Path) -> Result<Self, CliError> {
        if is_stdout(path) {
            return Ok(Self::Stdout);
        }
        let (file, created) = claim(flag, path, &mut OpenOptions::new())?;
        Ok(Self::File {
            flag,
            path: path.to_owned(),
            file,
            created,
        })
    }

    /// Opens the file of a flag, if the flag was given.
    ///
    /// # Errors
    /// The errors of [`Sink::open`].
    pub fn open_given(flag: &'static str, path: Option<&Path>) -> Result<Option<Self>, CliError> {
        path.map(|path| Self::open(flag, path)).transpose()
    }

    /// Opens a file in a folder if it is wanted. Creates the folder if it does not exist.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub fn open_within(folder: &Path, name: &str, wanted: bool) -> Result<Option<Self>, CliError> {
        let flag = "OUT";
        fs::create_dir_all(folder).map_err(|source| CliError::File {
            flag,
            path: folder.to_owned(),
            source,
        })?;
        let path = wanted.then(|| folder.join(name));
        Self::open_given(flag, path.as_deref())
    }

    /// Its path.
    pub fn path(&self) -> PathBuf {
        match self {
            Self::Stdout => PathBuf::from("-"),
            Self::File { path, .. } => path.clone(),
        }
    }

    /// The stream of this destination; `output` is the standard output.
    pub fn stream<'a>(self, output: &'a mut dyn Write) -> Stream<'a> {
        match self {
            Self::Stdout => Stream {
                output: Box::new(output),
                file: None,
            },
            Self::File {
                flag,
                path,
                file,
                created,
            } => Stream {
                output: Box::new(Replaced {
                    file,
                    created,
                    is_emptied: false,
                }),
                file: Some((flag, path)),
            },
        }
    }

    /// Writes the output that `content` produces.
    ///
    /// # Errors
    /// An I/O error of the file or stream.
    pub fn write(
        self,
        streams: &mut Streams<'_>,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), CliError> {
        let mut buffer = BufWriter::new(self.stream(&mut *streams.output));
        let written = content(&mut buffer).and_then(|()| buffer.flush());
        written.map_err(|source| buffer.get_ref().failed(source))
    }
}

/// Writes the document of `--json`, if it was requested. Returns true if it went to the standard output, where it
/// replaces the text.
///
/// # Errors
/// An I/O error of the file or stream.
pub fn write_document(
    sink: Option<Sink>,
    streams: &mut Streams<'_>,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<bool, CliError> {
    let Some(sink) = sink else {
        return Ok(false);
    };
    let takes_the_place = matches!(sink, Sink::Stdout);
    sink.write(streams, content)?;
    Ok(takes_the_place)
}

/// A file or the standard output, open for writing.
pub struct Stream<'a> {
    output: Box<dyn Write + 'a>,
    /// The flag that named the file, and its path.
    file: Option<(&'static str, PathBuf)>,
}

impl Stream<'_> {
    /// The error for a failed write.
    pub fn failed(&self, source: io::Error) -> CliError {
        match &self.file {
            None => CliError::Stream(source),
            Some((flag, path)) => CliError::File {
                flag,
                path: path.clone(),
                source,
            },
        }
    }
}

impl Write for Stream<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.output.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
