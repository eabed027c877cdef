//! The file to which rows are appended during a run, and from which an interrupted run continues.
//!
//! | beside `FILE` | |
//! |---|---|
//! | `FILE.meta.json` | metadata of the ensemble of the rows |
//! | `FILE.sums` | a line for every row: its checksum, the [`fingerprint`] of the row with its line end |
//! | `FILE.counts` | with a density: the counts of the first members, their number, and a checksum |
//!
//! After an interruption, complete rows whose counts were saved are kept. A row that was changed since it was written is
//! an error. Checksums are written before their rows, so that every complete row has one.
//!
//! A `FILE` with rows keeps them until the new rows are complete: these are written to `FILE.new`, with the same files
//! beside it, and renamed at the end. `FILE` is locked during the run.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::mem;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use dalembert_driver::ensemble::density::Counts;
use dalembert_driver::ensemble::row::{Columns, Field, Row};
use serde_json::{Map, Value};

use super::beside::{self, beside, replace};
use super::difference;
use super::fingerprint::{fingerprint, hash};
use super::line;
use crate::error::CliError;
use crate::sink::{self, Created};

/// Shortest time between two saves of counts.
const SAVE: Duration = Duration::from_secs(1);

/// Least ratio of the time between two saves of counts to the duration of a save.
const SAVING: u32 = 20;

/// Length of a line of `FILE.sums`, in bytes.
const SUM: usize = 17;

/// Receives rows, each with its line of CSV.
pub type Receiver<'a> = &'a mut dyn FnMut(&[u8], &Row) -> Result<(), CliError>;

/// The open and locked file.
pub struct Journal {
    flag: &'static str,
    /// The file that the flag names.
    target: PathBuf,
    /// The file of the rows: the target, or the new file beside it that replaces the target at the end.
    path: PathBuf,
    file: File,
    /// The path of the file of the rows until it is begun, if it is new.
    created: Created,
    /// False for a device or a pipe, which keeps no rows and has no files beside it.
    is_kept: bool,
    /// The locked target, while the rows are in the new file.
    claimed: Option<File>,
    /// True if this run began the file of the rows.
    is_begun: bool,
    /// The file of checksums; `None` before the rows are begun or resumed.
    sums: Option<File>,
    saved: Instant,
    /// Time between two saves of counts.
    patience: Duration,
}

impl Journal {
    /// Opens a file. Its content is kept until [`finish`](Self::finish).
    ///
    /// # Errors
    /// A file that cannot be written, or that another run is writing.
    pub fn open(flag: &'static str, path: &Path) -> Result<Self, CliError> {
        let (file, created) = sink::claim(flag, path, OpenOptions::new().read(true))?;
        let metadata = file
            .metadata()
            .map_err(|source| failed(flag, path, source))?;
        Ok(Self {
            flag,
            target: path.to_owned(),
            path: path.to_owned(),
            file,
            created,
            is_kept: metadata.is_file(),
            claimed: None,
            is_begun: false,
            sums: None,
            saved: Instant::now(),
            patience: SAVE,
        })
    }

    /// Continues in the new file beside the target.
    fn switch(&mut self) -> Result<(), CliError> {
        self.path = beside(&self.target, beside::NEW);
        let (file, created) = sink::claim(self.flag, &self.path, OpenOptions::new().read(true))?;
        self.claimed = Some(mem::replace(&mut self.file, file));
        self.created.keep();
        self.created = created;
        Ok(())
    }

    /// Begins the file. If the target holds anything, the rows go to the new file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn begin(
        &mut self,
        columns: &Columns,
        metadata: &Map<String, Value>,
    ) -> Result<(), CliError> {
        let whole = |source| failed(self.flag, &self.target, source);
        if self.claimed.is_none() && self.file.metadata().map_err(whole)?.len() > 0 {
            self.switch()?;
        }
        self.is_begun = true;
        self.created.keep();
        self.try_begin(columns, metadata)
            .map_err(|source| failed(self.flag, &self.path, source))
    }

    fn try_begin(&mut self, columns: &Columns, metadata: &Map<String, Value>) -> io::Result<()> {
        if self.is_kept {
            self.file.set_len(0)?;
            self.file.rewind()?;
            let mut text = serde_json::to_string_pretty(metadata)?;
            text.push('\n');
            replace(&beside(&self.path, ".meta.json"), text.as_bytes())?;
            beside::remove(&beside(&self.path, ".counts"))?;
            self.sums = Some(File::create(beside(&self.path, ".sums"))?);
        }
        self.file.write_all(&columns.header())
    }

    /// Continues the new file if it belongs to this ensemble, else the target: passes the kept rows to `see`, and
    /// returns their number. `None` if no row can be kept; the caller must then discard rows that `see` has received.
    ///
    /// # Errors
    /// A file that cannot be read or written, that belongs to another ensemble, or that was altered.
    pub fn resume(
        &mut self,
        columns: &Columns,
        metadata: &Map<String, Value>,
        (first_member, counts): (u64, Option<&mut Counts>),
        see: &mut dyn FnMut(&Row),
    ) -> Result<Option<u64>, CliError> {
        if is_interrupted(&beside(&self.target, beside::NEW), metadata) {
            self.switch()?;
        }
        let (flag, path) = (self.flag, self.path.clone());
        let whole = |source| failed(flag, &path, source);
        // An empty file is a new one; the files next to it may belong to another ensemble.
        if self.file.metadata().map_err(whole)?.len() == 0 {
            return Ok(None);
        }
        compare(&path, metadata)?;
        let counted = match counts {
            None => u64::MAX,
            Some(counts) => load("--resume", &beside(&path, ".counts"), counts)?,
        };
        let mut sums = open_sums("--resume", &beside(&path, ".sums"))?;
        self.file.rewind().map_err(whole)?;
        let mut scan = Scan::of(&mut self.file, columns, first_member);
        scan.sums = Some(BufReader::new(&mut sums));
        let complete = match scan.run(counted, &mut |_, row| see(row)).map_err(whole)? {
            Found::Complete(complete) => complete,
            Found::Altered { line } => return Err(altered("--resume", &path, line)),
        };
        // Counts cannot be subtracted: if rows of counted members were lost, rows and counts start anew.
        let is_short = counted != u64::MAX && complete.rows < counted;
        if complete.length == 0 || is_short {
            return Ok(None);
        }
        cut(&mut self.file, complete.length).map_err(whole)?;
        cut(&mut sums, complete.rows * SUM as u64).map_err(whole)?;
        self.sums = Some(sums);
        Ok(Some(complete.rows))
    }

    /// Appends lines; `members` is the number of members in the file and in `counts` afterwards.
    ///
    /// # Errors
    /// An I/O error of the file.
    pub fn append(
        &mut self,
        lines: &[u8],
        members: u64,
        counts: Option<&Counts>,
    ) -> Result<(), CliError> {
        let written = self.try_append(lines, members, counts);
        written.map_err(|source| failed(self.flag, &self.path, source))
    }

    fn try_append(
        &mut self,
        lines: &[u8],
        members: u64,
        counts: Option<&Counts>,
    ) -> io::Result<()> {
        if let Some(sums) = &mut self.sums {
            let rows = lines.split_inclusive(|&byte| byte == b'\n');
            let text: String = rows.map(|row| fingerprint(row) + "\n").collect();
            sums.write_all(text.as_bytes())?;
        }
        self.file.write_all(lines)?;
        match counts.filter(|_| self.is_kept) {
            Some(counts) if self.saved.elapsed() >= self.patience => {
                let begun = Instant::now();
                save(&beside(&self.path, ".counts"), members, counts)?;
                self.saved = Instant::now();
                self.patience = SAVE.max(SAVING * begun.elapsed());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Completes the file. A new file replaces the target.
    ///
    /// # Errors
    /// An I/O error of the file.
    pub fn finish(self, members: u64, counts: Option<&Counts>) -> Result<(), CliError> {
        let (flag, path) = (self.flag, self.path.clone());
        let finished = self.try_finish(members, counts);
        finished.map_err(|source| failed(flag, &path, source))
    }

    fn try_finish(self, members: u64, counts: Option<&Counts>) -> io::Result<()> {
        if let Some(counts) = counts.filter(|_| self.is_kept) {
            save(&beside(&self.path, ".counts"), members, counts)?;
        }
        if self.claimed.is_none() {
            return Ok(());
        }
        // Some systems do not rename open files.
        drop((self.file, self.sums, self.claimed));
        beside::publish(&self.path, &self.target)
    }

    /// Removes the file of rows if this run began it. Rows of an earlier run stay.
    pub fn abandon(self) {
        if self.is_begun && self.is_kept {
            drop((self.file, self.sums));
            // The error that ended the run is reported, not that of a file which stays behind.
            let _ = beside::discard(&self.path);
        }
    }
}

/// True if a file holds rows of this ensemble.
fn is_interrupted(path: &Path, metadata: &Map<String, Value>) -> bool {
    let has_rows = fs::metadata(path).is_ok_and(|file| file.len() > 0);
    let before = has_rows
        .then(|| metadata_of("--resume", path).ok())
        .flatten();
    before.is_some_and(|before| difference::explain(&before, metadata).is_none())
}

fn failed(flag: &'static str, path: &Path, source: io::Error) -> CliError {
    CliError::File {
        flag,
        path: path.to_owned(),
        source,
    }
}

/// Passes all rows of a complete file to a function.
///
/// # Errors
/// An I/O error of the file.
#[cfg(feature = "parquet")]
pub fn read_rows(
    path: &Path,
    columns: &Columns,
    first_member: u64,
    see: &mut dyn FnMut(&Row),
) -> io::Result<()> {
    let mut file = File::open(path)?;
    Scan::of(&mut file, columns, first_member)
        .run(u64::MAX, &mut |_, row| see(row))
        .map(drop)
}

/// The metadata that were written beside a file: they identify its ensemble.
///
/// # Errors
/// A file without metadata, or metadata that cannot be read.
pub fn metadata_of(flag: &'static str, path: &Path) -> Result<Map<String, Value>, CliError> {
    let place = beside(path, ".meta.json");
    let text = fs::read(&place).map_err(|source| failed(flag, &place, source))?;
    serde_json::from_slice(&text).map_err(|error| CliError::Input {
        place: format!("{flag} {}", place.display()),
        reason: error.to_string(),
    })
}

/// Refuses to continue the file of another ensemble.
fn compare(path: &Path, metadata: &Map<String, Value>) -> Result<(), CliError> {
    let before = metadata_of("--resume", path)?;
    match difference::explain(&before, metadata) {
        None => Ok(()),
        Some(difference) => Err(CliError::Input {
            place: format!("--resume {}", beside(path, ".meta.json").display()),
            reason: format!(
                "the file is of another ensemble: {difference}, or leave out --resume to start again"
            ),
        }),
    }
}

/// Opens the checksums of a file that was begun.
fn open_sums(flag: &'static str, path: &Path) -> Result<File, CliError> {
    let opened = OpenOptions::new().read(true).write(true).open(path);
    opened.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => CliError::Input {
            place: format!("{flag} {}", path.display()),
            reason: format!(
                "the file of checksums is missing, and rows without checksums are not taken over; {}",
                again(flag)
            ),
        },
        _ => failed(flag, path, error),
    })
}

/// Remedy for a file that cannot be taken over.
fn again(flag: &str) -> &'static str {
    match flag {
        "--resume" => "leave out --resume to start again",
        _ => "run the shard again",
    }
}

/// The error for a line that was altered since it was written.
fn altered(flag: &'static str, path: &Path, line: u64) -> CliError {
    let (what, defect, help) = match line {
        1 => ("header", "it differs from the header of these runs", ""),
        _ => (
            "row",
            "its checksum differs",
            "cut the file before this line to continue from there, or ",
        ),
    };
    CliError::Input {
        place: format!("{flag} {}, line {line}", path.display()),
        reason: format!(
            "the {what} was altered after it was written: {defect}; {help}{}",
            again(flag)
        ),
    }
}

/// Passes the rows of a shard's file, with their lines, to `see`, adds its counts, and returns the number of rows.
///
/// # Errors
/// A file that cannot be read, or that was altered; counts that are not those of the rows.
pub fn read_shard(
    flag: &'static str,
    path: &Path,
    (columns, first_member): (&Columns, u64),
    counts: Option<&mut Counts>,
    see: Receiver<'_>,
) -> Result<u64, CliError> {
    let whole = |source| failed(flag, path, source);
    let mut file = File::open(path).map_err(whole)?;
    let mut sums = open_sums(flag, &beside(path, ".sums"))?;
    let mut scan = Scan::of(&mut file, columns, first_member);
    scan.sums = Some(BufReader::new(&mut sums));
    let mut failure = None;
    let found = scan.run(u64::MAX, &mut |line, row| {
        if failure.is_none() {
            failure = see(line, row).err();
        }
    });
    let rows = match found.map_err(whole)? {
        Found::Complete(complete) => complete.rows,
        Found::Altered { line } => return Err(altered(flag, path, line)),
    };
    if let Some(failure) = failure {
        return Err(failure);
    }
    if let Some(counts) = counts {
        let mut these = counts.clone();
        let counted = load(flag, &beside(path, ".counts"), &mut these)?;
        if counted != rows {
            return Err(CliError::Input {
                place: format!("{flag} {}", path.display()),
                reason: format!(
                    "the file holds {rows} rows and counts of {counted}; {}",
                    again(flag)
                ),
            });
        }
        counts.merge(&these);
    }
    Ok(rows)
}

/// Shortens a file, and moves to its end.
fn cut(file: &mut File, length: u64) -> io::Result<()> {
    file.set_len(length)?;
    file.seek(SeekFrom::End(0)).map(drop)
}

/// The complete rows at the beginning of a file.
struct Scan<'a> {
    reader: BufReader<&'a mut File>,
    /// The checksums of the rows; without them, rows are not checked.
    sums: Option<BufReader<&'a mut File>>,
    columns: &'a Columns,
    first_member: u64,
}

/// Result of a scan.
enum Found {
    /// All complete rows are unaltered.
    Complete(Complete),
    /// A line was altered; lines are counted from 1.
    Altered { line: u64 },
}

/// Length of the complete beginning of a file, in rows and bytes.
struct Complete {
    rows: u64,
    length: u64,
}

impl<'a> Scan<'a> {
    fn of(file: &'a mut File, columns: &'a Columns, first_member: u64) -> Self {
        Self {
            reader: BufReader::new(file),
            sums: None,
            columns,
            first_member,
        }
    }

    /// Reads at most `most` rows. Stops before a last row that is incomplete or has no checksum.
    fn run(&mut self, most: u64, see: &mut dyn FnMut(&[u8], &Row)) -> io::Result<Found> {
        let mut complete = Complete { rows: 0, length: 0 };
        let mut line = Vec::new();
        if !self.next_line(&mut line)? {
            return Ok(Found::Complete(complete));
        }
        if line != self.columns.header() {
            return Ok(Found::Altered { line: 1 });
        }
        complete.length = line.len() as u64;
        while complete.rows < most && self.next_line(&mut line)? {
            let Some(is_same) = self.compare(&line)? else {
                break;
            };
            let member = Field::Integer(self.first_member + complete.rows);
            let row = line::parse(self.columns, &line).filter(|_| is_same);
            match row.filter(|row| row.first() == Some(&member)) {
                Some(row) => see(&line, &row),
                None => {
                    let line = complete.rows + 2;
                    return Ok(Found::Altered { line });
                }
            }
            complete.rows += 1;
            complete.length += line.len() as u64;
        }
        Ok(Found::Complete(complete))
    }

    /// Compares a row with the next checksum; `None` if there is no further checksum.
    fn compare(&mut self, line: &[u8]) -> io::Result<Option<bool>> {
        let Some(sums) = &mut self.sums else {
            return Ok(Some(true));
        };
        let mut sum = [0; SUM];
        match sums.read_exact(&mut sum) {
            Ok(()) => Ok(Some(sum == *(fingerprint(line) + "\n").as_bytes())),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Reads a line; true if it has a line end.
    fn next_line(&mut self, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        self.reader.read_until(b'\n', line)?;
        Ok(line.ends_with(b"\n"))
    }
}

fn save(path: &Path, members: u64, counts: &Counts) -> io::Result<()> {
    let mut content = members.to_le_bytes().to_vec();
    counts.write(&mut content)?;
    content.extend_from_slice(&hash(&content).to_le_bytes());
    replace(path, &content)
}

/// Loads counts, and returns the number of members that they count; 0 if the file does not exist.
fn load(flag: &'static str, path: &Path, counts: &mut Counts) -> Result<u64, CliError> {
    let content = match fs::read(path) {
        Ok(content) => content,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(0),
        Err(error) => return Err(failed(flag, path, error)),
    };
    members_of(&content, counts).ok_or_else(|| CliError::Input {
        place: format!("{flag} {}", path.display()),
        reason: format!(
            "the counts were altered after they were written: their checksum differs; remove the file to count from the \
             first member on, or {}",
            again(flag)
        ),
    })
}

/// Parses the output of [`save`]; `None` for anything else.
fn members_of(content: &[u8], counts: &mut Counts) -> Option<u64> {
    let (content, sum) = content.split_last_chunk()?;
    let (members, mut rest) = content.split_first_chunk()?;
    counts.read(&mut rest).ok()?;
    let is_whole = rest.is_empty() && hash(content) == u64::from_le_bytes(*sum);
    is_whole.then(|| u64::from_le_bytes(*members))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert_driver::ensemble::density::{Axis, Density, Shown};
    use dalembert_driver::ensemble::row::{Kind, csv_line};

    fn density() -> Density {
        let axis = Axis {
            name: "x".to_owned(),
            shown: Shown::Energy,
            is_circle: false,
            range: [0.0, 1.0],
            bins: 2,
        };
        Density {
            axes: [axis.clone(), axis],
            every: 1.0,
            discard: 0.0,
            samples: 4,
        }
    }

    /// The kept rows of a file of members 7, 8 and 9, with this number of counted members.
    fn kept(name: &str, counted: Option<u64>) -> Option<(u64, u64)> {
        let path = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
        let columns = line::unnamed(&[Kind::Integer, Kind::Number]);
        let metadata = Map::from_iter([("tol".to_owned(), Value::from(0.5))]);
        let open = || Journal::open("--csv", &path).expect("the folder can be written");
        let mut journal = open();
        let begun = journal.begin(&columns, &metadata);
        begun.expect("the file can be written");
        for member in 7..10 {
            let row = vec![Field::Integer(member), Field::Number(0.1)];
            let appended = journal.append(&csv_line(&row), member - 6, None);
            appended.expect("the file can be written");
        }
        let mut counts = Counts::new(&density());
        let finished = journal.finish(counted.unwrap_or(0), counted.map(|_| &counts));
        finished.expect("the file can be written");
        let counts = counted.map(|_| &mut counts);
        let mut seen = 0;
        let mut see = |_: &Row| seen += 1;
        let resumed = open().resume(&columns, &metadata, (7, counts), &mut see);
        let rows = resumed.expect("the file can be read");
        let lines = fs::read_to_string(&path).map_or(0, |text| text.lines().count() as u64 - 1);
        beside::discard(&path).expect("the files can be removed");
        rows.map(|rows| {
            assert_eq!(rows, seen);
            (rows, lines)
        })
    }

    #[test]
    fn rows_that_are_not_counted_are_made_again() {
        assert_eq!(kept("uncounted", None), Some((3, 3)));
        assert_eq!(kept("counted", Some(3)), Some((3, 3)));
        assert_eq!(kept("behind", Some(2)), Some((2, 2)));
        assert_eq!(kept("ahead", Some(4)), None);
    }
}
