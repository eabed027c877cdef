//! Errata whose values cannot be computed.

use dalembert_cli::Catalogue;
use dalembert_cli::errata::{Check, Erratum};

use super::*;

const ERRATA: &[Erratum] = &[Erratum {
    place: "[A] (1)",
    printed: "x = 0",
    right: "x = 1",
    check: Some(Check {
        quantity: "x",
        command: "eval nothing",
        input: "[]",
        how: "x",
        values: |_| Some([0.0, 1.0]),
    }),
}];

#[test]
fn a_command_that_fails_is_reported() {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut std::io::empty(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let catalogue = Catalogue::of(systems::entries().to_vec()).with_errata(ERRATA);
    let exit = catalogue.run_with(["dalembert", "errata"], &mut streams);
    let output = String::from_utf8(output).unwrap();
    assert_eq!(exit, Exit::Other, "{output}");
    let told = "value     x: the command fails";
    assert!(output.contains(told), "{output}");
    assert!(output.contains("unknown model `nothing`"), "{output}");
}
