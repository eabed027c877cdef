//! The `dalembert` command over the shipped models.

use std::process::ExitCode;

fn main() -> ExitCode {
    dalembert_cli::run(dalembert_models::all())
}
