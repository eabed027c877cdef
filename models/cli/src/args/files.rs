//! The files that a command reads and those that it writes: no output may replace an input.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Command, SimulateArgs};
use crate::error::CliError;
use crate::model_file;
use crate::sink::is_stdout;

/// The model argument, the other files that are read, and the outputs.
type Files<'a> = (Option<&'a str>, Vec<&'a Path>, Vec<Output<'a>>);

/// An output: its flag and its path.
type Output<'a> = (&'static str, Option<&'a Path>);

impl Command {
    /// Refuses an output that is a file which the command reads.
    ///
    /// # Errors
    /// The flag of the output, with its path.
    pub fn check_files(&self) -> Result<(), CliError> {
        let (model, inputs, outputs) = self.files();
        let model = model.and_then(model_file::path);
        let inputs: Vec<PathBuf> = model.into_iter().chain(inputs).map(real).collect();
        for (flag, path) in outputs {
            if let Some(path) = path
                && !is_stdout(path)
                && inputs.contains(&real(path))
            {
                let expected = "a file that the command does not read";
                return Err(CliError::value(flag, path.display().to_string(), expected));
            }
        }
        Ok(())
    }

    /// The model argument, the other files that are read, and the outputs.
    fn files(&self) -> Files<'_> {
        match self {
            Self::Derive(args) => (
                Some(&args.model),
                vec![],
                vec![("--json", args.json.as_deref())],
            ),
            Self::Check(args) => (
                Some(&args.model),
                vec![],
                vec![
                    ("--json", args.json.as_deref()),
                    ("--certificate", args.certificate.as_deref()),
                ],
            ),
            Self::Export(args) => (Some(&args.model), vec![], vec![("--c", Some(&args.c))]),
            Self::Simulate(args) => files_of_run(args),
            Self::Watch(args) => files_of_run(&args.simulate),
            Self::Ensemble(args) => (
                Some(&args.run.model.model),
                args.from.iter().map(PathBuf::as_path).collect(),
                vec![
                    ("--csv", args.rows.csv.as_deref()),
                    ("--parquet", args.rows.parquet.as_deref()),
                    ("--json", args.json.as_deref()),
                    ("--cells", args.cells.as_deref()),
                    ("--plot", args.plot.as_deref()),
                ],
            ),
            Self::Map(args) => (
                Some(&args.run.model.model),
                vec![],
                vec![
                    ("--csv", args.rows.csv.as_deref()),
                    ("--parquet", args.rows.parquet.as_deref()),
                    ("--json", args.json.as_deref()),
                    ("--plot", args.plot.as_deref()),
                ],
            ),
            Self::Accuracy(args) => (
                Some(&args.run.model.model),
                vec![],
                vec![
                    ("--csv", args.csv.as_deref()),
                    ("--json", args.json.as_deref()),
                    ("--plot", args.plot.as_deref()),
                ],
            ),
            Self::Orbit(args) => (
                Some(&args.model.model),
                vec![],
                vec![
                    ("--json", args.json.as_deref()),
                    ("--csv", args.branch.csv.as_deref()),
                    ("--plot", args.branch.plot.as_deref()),
                ],
            ),
            Self::Connect(args) => (
                Some(&args.model.model),
                vec![],
                vec![
                    ("--csv", args.csv.as_deref()),
                    ("--json", args.json.as_deref()),
                    ("--plot", args.plot.as_deref()),
                ],
            ),
            Self::Linearise(args) => (
                Some(&args.model.model),
                vec![],
                vec![("--json", args.json.as_deref())],
            ),
            Self::Control(args) => (
                Some(&args.model.model),
                vec![],
                vec![
                    ("--csv", args.csv.as_deref()),
                    ("--json", args.json.as_deref()),
                    ("--inputs", args.inputs.as_deref()),
                    ("--plot", args.plot.as_deref()),
                ],
            ),
            _ => (None, vec![], vec![]),
        }
    }
}

fn files_of_run(args: &SimulateArgs) -> Files<'_> {
    (
        Some(&args.run.model.model),
        args.inputs.iter().map(PathBuf::as_path).collect(),
        vec![
            ("--csv", args.csv.as_deref()),
            ("--json", args.json.as_deref()),
            ("--plot", args.plot.as_deref()),
            ("--html", args.html.as_deref()),
        ],
    )
}

/// The path of an existing file without links; other paths as they are.
fn real(path: impl AsRef<Path>) -> PathBuf {
    let path = path.as_ref();
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}
