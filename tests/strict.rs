//! With the feature `strict` every build of a program computes the same bits: unoptimised, optimised, and for a machine
//! with fused multiply-add.

use std::path::{Path, PathBuf};
use std::process::Command;

use dalembert_tests::golden;

/// A build of the program in `tests/strict`.
struct Build {
    name: &'static str,
    /// Level of optimisation. The macro, which is never optimised, is compiled once for all levels.
    level: &'static str,
    /// Target folder, one for each machine, so that a change of the machine does not rebuild the C code.
    target: &'static str,
    /// Flags of the Rust compiler for the machine. The C compiler gets `cpu`.
    flags: &'static str,
    cpu: &'static str,
}

const UNOPTIMISED: Build = Build {
    name: "unoptimised",
    level: "0",
    target: "outside",
    flags: "",
    cpu: "x86-64",
};
const OPTIMISED: Build = Build {
    name: "optimised",
    level: "3",
    target: "outside",
    flags: "",
    cpu: "x86-64",
};
const NATIVE: Build = Build {
    name: "native",
    level: "3",
    target: "native",
    flags: "-C target-cpu=native",
    cpu: "native",
};

impl Build {
    /// Output of the program.
    fn output(&self) -> String {
        let binary = self.binary();
        let output = Command::new(binary).output().expect("the program starts");
        assert!(output.status.success(), "{}: the program fails", self.name);
        String::from_utf8(output.stdout).expect("a text")
    }

    fn binary(&self) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("strict");
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join(self.target);
        let status = Command::new(env!("CARGO"))
            .args([
                "build",
                "--quiet",
                "--locked",
                "--release",
                "--manifest-path",
            ])
            .arg(folder.join("Cargo.toml"))
            .arg("--target-dir")
            .arg(&target)
            .env_remove("CARGO_TARGET_DIR")
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", self.level)
            .env("RUSTFLAGS", self.flags)
            .env("TARGET_CPU", self.cpu)
            .status()
            .expect("cargo");
        assert!(
            status.success(),
            "{}: the program does not build",
            self.name
        );
        target.join("release").join("strict")
    }
}

#[test]
#[ignore = "builds a crate of its own: `.ci/run` runs it"]
fn a_strict_run_has_the_stored_bits_unoptimised_and_optimised() {
    let optimised = OPTIMISED.output();
    assert_eq!(optimised, OPTIMISED.output(), "two runs differ");
    assert_eq!(optimised, UNOPTIMISED.output(), "two builds differ");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/strict.txt");
    golden::compare_file(&path, &optimised);
}

#[test]
#[ignore = "nightly: one more build, for this very machine"]
fn a_strict_run_has_the_stored_bits_where_multiplication_may_be_fused() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/strict.txt");
    let stored = std::fs::read_to_string(path).expect("a stored text");
    assert_eq!(NATIVE.output(), stored);
}
