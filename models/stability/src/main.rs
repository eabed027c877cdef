//! The `dalembert` command with the hard cases behind `stability`.

use std::process::ExitCode;

fn main() -> ExitCode {
    dalembert_stability::catalogue().run()
}
