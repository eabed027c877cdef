use dalembert_cli::suite::{Case, Report, Run, Setting};
use dalembert_cli::{Catalogue, Streams};

use super::*;

const CASES: [Case; 4] = [
    Case {
        id: "A01",
        title: "holds",
        right: "1 < 2",
        bound: "2",
        run: Run::Steps(|_: Setting, report: &mut Report| report.error("one", 1.0, 2.0)),
        ..Case::QUICK
    },
    Case {
        id: "A02",
        title: "does not",
        right: "3",
        bound: "exact",
        run: Run::Once(|report| {
            report.equal("count", 4, 3);
            report.curve(
                "growth",
                ["n", "error"],
                vec![[1.0, 1.0], [2.0, 4.0], [4.0, 16.0]],
            );
        }),
        ..Case::QUICK
    },
    Case {
        id: "B01",
        title: "not yet",
        right: "at <rest>",
        bound: "exact",
        pending: Some("nothing to rest on"),
        ..Case::QUICK
    },
    Case {
        id: "B02",
        title: "long",
        right: "0",
        bound: "0",
        run: Run::Once(|report| report.equal("count", 0, 0)),
        ..Case::NIGHTLY
    },
];

fn stability(words: &str) -> Done {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut std::io::empty(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let catalogue = Catalogue::of(systems::entries().to_vec()).with_suite(CASES.to_vec());
    let args = ["dalembert", "stability"]
        .into_iter()
        .chain(words.split_whitespace());
    let exit = catalogue.run_with(args, &mut streams);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Done {
        exit,
        output: text(output),
        errors: text(errors),
    }
}

#[test]
fn quick_cases_are_run_and_those_that_fail_are_said_again() {
    let done = stability("");
    assert_eq!(done.exit, Exit::Other);
    assert!(
        done.output.contains("A01   pass     holds"),
        "{}",
        done.output
    );
    assert!(done.output.contains("one: 1.00e0 of 2.00e0"));
    assert!(done.output.contains("pending  nothing to rest on"));
    assert!(done.output.contains("3 cases: 1 pass, 1 fail, 1 pending"));
    assert!(done.output.ends_with("failed: A02 count: 4 instead of 3\n"));
}

#[test]
fn cases_are_chosen_by_number_section_and_length() {
    let done = stability("--case A01 --section B");
    assert_eq!(done.exit, Exit::Reached);
    assert!(
        done.output.contains("2 cases: 1 pass, 0 fail, 1 pending"),
        "{}",
        done.output
    );
    assert!(
        stability("--section B --nightly")
            .output
            .contains("2 cases: 1 pass")
    );
    // A case that is named is run, however long it takes.
    assert!(stability("--case B02").output.contains("1 case: 1 pass"));
}

#[test]
fn names_that_do_not_exist_are_refused_with_those_that_do() {
    let done = stability("--case A03");
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.contains("unknown case `A03`"),
        "{}",
        done.errors
    );
    assert!(stability("--section Z").errors.contains("accepted: A, B"));
    assert!(
        stability("--html report.svg")
            .errors
            .contains("ends in .html")
    );
}

#[test]
fn json_has_every_measurement() {
    let document = stability("--json -").json();
    assert_eq!(document["passed"], false);
    let cases = document["cases"].as_array().unwrap();
    assert_eq!(cases[0]["verdict"], "pass");
    let settings = cases[0]["settings"].as_array().unwrap();
    assert_eq!(settings[0]["checks"][0]["share_of_bound"], 0.5);
    assert_eq!(settings[1]["dense"], true);
    assert_eq!(settings[2]["max_step"], 0.25);
    assert_eq!(cases[1]["settings"][0]["curves"][0]["points"][2][1], 16.0);
    assert_eq!(cases[2]["measured"], "nothing to rest on");
}

#[test]
fn the_page_has_a_row_per_case_and_the_curves() {
    let path =
        std::env::temp_dir().join(format!("dalembert_stability_{}.html", std::process::id()));
    let done = stability(&format!("--html {}", path.display()));
    assert_eq!(done.exit, Exit::Other);
    let page = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(page.contains("<b>A01</b>") && page.contains("at &lt;rest&gt;"));
    assert!(page.contains("growth (exponent 2.00)") && page.contains("<svg"));
}

#[test]
fn a_command_line_without_cases_says_so() {
    let done = run("stability");
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.contains("this command line has no cases"),
        "{}",
        done.errors
    );
}
