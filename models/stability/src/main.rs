//! The `dalembert` command with the hard cases as the subcommand `stability`.

use std::process::ExitCode;

fn main() -> ExitCode {
    dalembert_stability::catalogue().run()
}
