//! What members are given: ends that depend on their parameters, and what would be ignored.

use super::*;

/// A ball that the model follows for a time that depends on a parameter.
const TIMED: &str = "
    Timed {
        coordinates { x; }
        parameters { l > 0 = 1; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0; }
        initial { x = l; dot(x) = l; until = 2*l; }
    }";

#[test]
fn a_member_ends_where_the_model_says_with_its_parameters() {
    for integrator in INTEGRATORS {
        let line = format!("ensemble - --vary l=1..3:3 --integrator {integrator} --csv -");
        let done = run_on(TIMED, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(numbers_of(&done.output, "t"), [2.0, 4.0, 6.0]);
        let line = format!("{line} --until 1");
        let done = run_on(TIMED, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(numbers_of(&done.output, "t"), [1.0; 3]);
    }
    // A density counts states at the same times for all.
    let line = "ensemble - --vary l=1..3:3 --density x,x_dot:4 --csv -";
    let done = run_on(TIMED, &line.split(' ').collect::<Vec<_>>());
    assert_eq!(
        column(&done.output, "outcome"),
        ["done", "refused", "refused"]
    );
    assert!(done.output.contains("ends at t = 4"), "{}", done.output);
}

#[test]
fn what_a_table_says_is_not_ignored() {
    let driven = "
        Driven {
            coordinates { x; }
            parameters { w = 1; }
            lagrangian = dot(x)^2/2;
            forces { push: cos(w*t)*d(x); }
            initial { until = 1; }
        }";
    let refused = |model: &str, table: &str, expected: &str| {
        let folder = Folder::new("ignored");
        let path = folder.path("table.csv");
        fs::write(&path, table).unwrap();
        let done = run_on(model, &["ensemble", "-", "--from", &path, "--csv", "-"]);
        assert!(done.errors.contains(expected), "{table}: {}", done.errors);
    };
    refused(driven, "t,x\n0,1\n0.5,1\n", "as the motion depends on time");
    refused(driven, "in.x,w\n1,2\n", "expected `in.w`");
    refused(driven, "in.x,x\n1,2\n", "expected `in.x`");
    refused(
        TWO_MODES,
        "x,y\n1,2\n",
        "`y` in mode `a`, in which the motion starts",
    );
    let vary = ["ensemble", "-", "--vary", "y_dot=0..1:2", "--csv", "-"];
    let done = run_on(TWO_MODES, &vary);
    assert!(
        done.errors.contains("`y_dot` in mode `a`"),
        "{}",
        done.errors
    );
    let done = run_on(TWO_MODES, &["simulate", "-", "--initial", "y=3"]);
    assert!(done.errors.contains("`y` in mode `a`"), "{}", done.errors);
    let done = run_on(
        TWO_MODES,
        &[
            "simulate",
            "-",
            "--mode",
            "b",
            "--initial",
            "y=3",
            "--until",
            "1",
        ],
    );
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
}

/// A model whose first mode has one coordinate and whose second one has two.
const TWO_MODES: &str = "
    Two {
        modes {
            a {
                coordinates { x; }
                lagrangian = dot(x)^2/2;
                initial { x = 0; dot(x) = 1; until = 3; }
            }
            b {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
            }
        }
        transitions { go: a -> b when x >= 1 => reset { y = 5; dot(y) = 2; }; }
    }";

/// Outputs with the names of other columns, and a coordinate with that of the column of surfaces.
const SAME_NAMES: &str = "
    Same {
        coordinates { event; }
        parameters { k > 0 = 1; }
        lagrangian = dot(event)^2/2 - k*event^2/2;
        initial { event = 1; until = 2; }
        outputs { k: 2 + event; }
    }";

#[test]
fn members_from_a_table_of_a_run_have_its_states_and_no_outputs() {
    let folder = Folder::new("same_names");
    let path = folder.path("run.csv");
    let run = ["simulate", "-", "--samples", "3", "--csv", &path];
    let done = run_on(SAME_NAMES, &run);
    assert!(done.errors.is_empty(), "{}", done.errors);
    let table = fs::read_to_string(&path).unwrap();
    assert!(
        table.starts_with("t,event,event_dot,energy,out.k,run.event\n"),
        "{table}"
    );
    let done = run_on(
        SAME_NAMES,
        &["ensemble", "-", "--from", &path, "--csv", "-"],
    );
    assert!(done.errors.is_empty(), "{}", done.errors);
    let header = done.output.lines().next().unwrap();
    assert!(
        header.contains("in.event,in.event_dot") && !header.contains("in.k"),
        "{header}"
    );
    assert_eq!(
        numbers_of(&done.output, "in.event"),
        numbers_of(&table, "event")
    );
    let refused = run_on(SAME_NAMES, &["simulate", "-", "--output", "k = 7"]);
    assert!(
        refused.errors.contains("`k = 7` is not accepted"),
        "{}",
        refused.errors
    );
}
