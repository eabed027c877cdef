//! The `dalembert` command over the shipped models.

use std::process::ExitCode;

fn main() -> ExitCode {
    dalembert_command::catalogue().run()
}
