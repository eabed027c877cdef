//! The file that rows are appended to while members are run, and from which a run that was cut off goes on.
//!
//! Beside `FILE` stand `FILE.meta.json`, which says of what ensemble the rows are, and, while a density is counted,
//! `FILE.counts`: the counts of the first so many members. What is kept after a cut are the rows that are complete, of
//! which counts are known.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::{Map, Value};

use super::density::Counts;
use super::row::{Columns, Field, Row};
use crate::error::CliError;

/// Least time between two writings of counts.
const SAVE: Duration = Duration::from_secs(1);

/// Writing counts takes one part in so many of the time at most.
const SAVING: u32 = 20;

/// The file, open.
pub struct Journal {
    flag: &'static str,
    path: PathBuf,
    file: File,
    saved: Instant,
    /// Time between two writings of counts.
    patience: Duration,
}

/// The path with something appended to its name.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

impl Journal {
    /// Begins a file.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(
        flag: &'static str,
        path: &Path,
        columns: &Columns,
        metadata: &Map<String, Value>,
    ) -> Result<Self, CliError> {
        let created = || {
            let file = File::create(path)?;
            let mut text = serde_json::to_string_pretty(metadata)?;
            text.push('\n');
            replace(&beside(path, ".meta.json"), text.as_bytes())?;
            remove(&beside(path, ".counts"))?;
            let mut journal = Self::over(flag, path, file);
            journal.file.write_all(&columns.header())?;
            Ok(journal)
        };
        created().map_err(|source| failed(flag, path, source))
    }

    /// Opens a file that was begun, shows `see` the rows that are kept, and says how many they are. `None` where there is
    /// nothing to keep; rows that were shown then do not count.
    ///
    /// # Errors
    /// It cannot be read or written, or is of another ensemble.
    pub fn resume(
        flag: &'static str,
        path: &Path,
        columns: &Columns,
        metadata: &Map<String, Value>,
        (first_member, counts): (u64, Option<&mut Counts>),
        see: &mut dyn FnMut(&Row),
    ) -> Result<Option<(Self, u64)>, CliError> {
        // A file that is empty was begun just now: what stands beside it may be of another ensemble.
        if fs::metadata(path).map_or(0, |file| file.len()) == 0 {
            return Ok(None);
        }
        let whole = |source| failed(flag, path, source);
        compare(path, metadata)?;
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .open(path)
            .map_err(whole)?;
        let counted = match counts {
            None => u64::MAX,
            Some(counts) => load(&beside(path, ".counts"), counts).map_err(whole)?,
        };
        let mut scan = Scan::of(&mut file, columns, first_member);
        let complete = scan.run(counted, see).map_err(whole)?;
        // Counts cannot be taken back: where rows were lost that they know of, both begin anew.
        let is_short = counted != u64::MAX && complete.rows < counted;
        if complete.length == 0 || is_short {
            return Ok(None);
        }
        file.set_len(complete.length).map_err(whole)?;
        file.seek(SeekFrom::End(0)).map_err(whole)?;
        Ok(Some((Self::over(flag, path, file), complete.rows)))
    }

    fn over(flag: &'static str, path: &Path, file: File) -> Self {
        Self {
            flag,
            path: path.to_owned(),
            file,
            saved: Instant::now(),
            patience: SAVE,
        }
    }

    /// Appends lines, after which `members` are in the file and counted in `counts`.
    ///
    /// # Errors
    /// Whatever the file says.
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
        self.file.write_all(lines)?;
        match counts {
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

    /// Ends the file, which then is complete.
    ///
    /// # Errors
    /// Whatever the file says.
    pub fn finish(self, members: u64, counts: Option<&Counts>) -> Result<(), CliError> {
        let finished = match counts {
            Some(counts) => save(&beside(&self.path, ".counts"), members, counts),
            None => Ok(()),
        };
        finished.map_err(|source| failed(self.flag, &self.path, source))
    }
}

fn failed(flag: &'static str, path: &Path, source: io::Error) -> CliError {
    CliError::File {
        flag,
        path: path.to_owned(),
        source,
    }
}

/// Shows all rows of a complete file.
///
/// # Errors
/// Whatever the file says.
#[cfg(feature = "parquet")]
pub fn read_rows(
    path: &Path,
    columns: &Columns,
    first_member: u64,
    see: &mut dyn FnMut(&Row),
) -> io::Result<()> {
    let mut file = File::open(path)?;
    Scan::of(&mut file, columns, first_member)
        .run(u64::MAX, see)
        .map(drop)
}

/// Removes a journal that was not asked for, and what stands beside it.
///
/// # Errors
/// Whatever the system says.
pub fn discard(path: &Path) -> io::Result<()> {
    remove(path)?;
    remove(&beside(path, ".meta.json"))?;
    remove(&beside(path, ".counts"))
}

/// Refuses to go on with another ensemble. A key that is absent counts as `null`: the flag did not exist then.
fn compare(path: &Path, metadata: &Map<String, Value>) -> Result<(), CliError> {
    let place = beside(path, ".meta.json");
    let invalid = |reason: String| CliError::Input {
        place: format!("--resume {}", place.display()),
        reason,
    };
    let text = fs::read(&place).map_err(|source| failed("--resume", &place, source))?;
    let before: Map<String, Value> =
        serde_json::from_slice(&text).map_err(|error| invalid(error.to_string()))?;
    let differs = metadata
        .iter()
        .find(|(key, value)| before.get(*key).unwrap_or(&Value::Null) != *value);
    match differs {
        None => Ok(()),
        Some((key, value)) => {
            let was = before
                .get(key)
                .map_or_else(|| "absent".to_owned(), Value::to_string);
            Err(invalid(format!(
                "the file is of another ensemble: `{key}` was {was} and is {value}; give the same flags, or leave out --resume \
                 to begin anew"
            )))
        }
    }
}

/// The complete rows at the beginning of a file.
struct Scan<'a> {
    reader: BufReader<&'a mut File>,
    columns: &'a Columns,
    first_member: u64,
}

/// How much of a file is complete.
struct Complete {
    rows: u64,
    length: u64,
}

impl<'a> Scan<'a> {
    fn of(file: &'a mut File, columns: &'a Columns, first_member: u64) -> Self {
        Self {
            reader: BufReader::new(file),
            columns,
            first_member,
        }
    }

    /// Reads up to so many rows; a last one that was cut off is none.
    fn run(&mut self, most: u64, see: &mut dyn FnMut(&Row)) -> io::Result<Complete> {
        let mut complete = Complete { rows: 0, length: 0 };
        let mut line = Vec::new();
        if !self.next_line(&mut line)? || line != self.columns.header() {
            return Ok(complete);
        }
        complete.length = line.len() as u64;
        while complete.rows < most && self.next_line(&mut line)? {
            let Some(row) = self.columns.parse(&line) else {
                break;
            };
            if row.first() != Some(&Field::Integer(self.first_member + complete.rows)) {
                break;
            }
            see(&row);
            complete.rows += 1;
            complete.length += line.len() as u64;
        }
        Ok(complete)
    }

    /// Whether there is another line with an end.
    fn next_line(&mut self, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        self.reader.read_until(b'\n', line)?;
        Ok(line.ends_with(b"\n"))
    }
}

/// Writes a file whole or not at all.
fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let new = beside(path, ".new");
    fs::write(&new, content)?;
    fs::rename(&new, path)
}

fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn save(path: &Path, members: u64, counts: &Counts) -> io::Result<()> {
    let mut content = members.to_le_bytes().to_vec();
    counts.write(&mut content)?;
    replace(path, &content)
}

/// How many members the counts are of; 0 where there are none.
fn load(path: &Path, counts: &mut Counts) -> io::Result<u64> {
    let mut file = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(0),
        Err(error) => return Err(error),
    };
    let mut members = [0; 8];
    file.read_exact(&mut members)?;
    counts.read(&mut file)?;
    Ok(u64::from_le_bytes(members))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble::density::{Axis, Density, Shown};
    use crate::ensemble::row::{Kind, csv_line};

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

    /// The rows that are kept of a file of members 7, 8 and 9, of which so many are counted.
    fn kept(name: &str, counted: Option<u64>) -> Option<(u64, u64)> {
        let path = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
        let columns = Columns::unnamed(&[Kind::Integer, Kind::Number]);
        let metadata = Map::from_iter([("tol".to_owned(), Value::from(0.5))]);
        let journal = Journal::create("--csv", &path, &columns, &metadata);
        let mut journal = journal.expect("the folder can be written");
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
        let resumed = Journal::resume("--csv", &path, &columns, &metadata, (7, counts), &mut see);
        let resumed = resumed.expect("the file can be read");
        let rows = resumed.map(|(_, rows)| rows);
        let lines = fs::read_to_string(&path).map_or(0, |text| text.lines().count() as u64 - 1);
        discard(&path).expect("the files can be removed");
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
