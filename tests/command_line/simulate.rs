use super::*;

/// Runs a command that writes JSON to its standard output.
fn document(line: &str) -> (Exit, Value) {
    let done = run(&format!("{line} --json -"));
    assert!(!done.output.is_empty(), "{}", done.errors);
    (done.exit, done.json())
}

fn times(rows: &Value) -> Vec<f64> {
    rows.as_array()
        .unwrap()
        .iter()
        .map(|row| row["t"].as_f64().unwrap())
        .collect()
}

#[test]
fn a_document_has_the_keys_of_the_interface() {
    let (exit, document) = document("simulate oscillator --set k=4 --samples 3");
    assert_eq!(exit, Exit::Reached);
    let keys: Vec<&String> = document.as_object().unwrap().keys().collect();
    let expected = [
        "model",
        "scene",
        "parameters",
        "form",
        "integrator",
        "tol",
        "outcome",
        "events",
        "contacts",
        "samples",
        "counters",
        "warnings",
    ];
    assert_eq!(keys, expected);
    assert_eq!(document["parameters"]["k"], 4.0);
    assert_eq!(document["outcome"]["kind"], "done");
    assert_eq!(document["outcome"]["t"], 20.0);
    let keys: Vec<&String> = document["samples"][0].as_object().unwrap().keys().collect();
    assert_eq!(keys, ["t", "q", "qdot", "p", "energy", "outputs"]);
    assert_eq!(document["samples"][0]["outputs"]["radius"], 1.0);
    assert_eq!(times(&document["samples"]), [0.0, 10.0, 20.0]);
}

#[test]
fn samples_lie_on_the_closed_solution() {
    for integrator in ["dop853", "dopri5", "taylor"] {
        let line = format!(
            "simulate oscillator --set k=4 --tol 1e-12 --integrator {integrator} --samples 101"
        );
        let (_, document) = document(&line);
        for sample in document["samples"].as_array().unwrap() {
            let (t, q) = (sample["t"].as_f64().unwrap(), numbers(&sample["q"]));
            assert!((q[0] - t.cos()).abs() < 1e-9, "{integrator} at {t}");
            assert!(
                (q[1] - 0.25 * (2.0 * t).sin()).abs() < 1e-9,
                "{integrator} at {t}"
            );
        }
    }
}

#[test]
fn integrators_of_fixed_step_take_one_and_tell_it() {
    for (integrator, bound) in [
        ("rk4", 1e-5),
        ("gauss4", 1e-6),
        ("gauss6", 1e-9),
        ("dla2", 1e-1),
        ("dla4", 1e-5),
    ] {
        let flags = format!("--integrator {integrator} --step 0.05");
        let (exit, document) = document(&format!(
            "simulate oscillator --set k=4 {flags} --samples 101"
        ));
        assert_eq!(
            (exit, &document["step"]),
            (Exit::Reached, &Value::from(0.05))
        );
        assert_eq!(document["counters"]["accepted"], 400);
        for sample in document["samples"].as_array().unwrap() {
            let (t, q) = (sample["t"].as_f64().unwrap(), numbers(&sample["q"]));
            assert!((q[0] - t.cos()).abs() < bound, "{integrator} at {t}");
        }
        let told = run(&format!("simulate oscillator --set k=4 {flags}")).output;
        assert!(
            told.contains(&format!("{integrator}, global form, step 0.05\n")),
            "{told}"
        );
        let told = run(&format!(
            "simulate oscillator --set k=4 --integrator {integrator} --tol 1e-4"
        ))
        .output;
        assert!(
            told.contains("(from tol 1e-4; set it with --step)"),
            "{told}"
        );
    }
}

/// A mass at rest until a force with impulse 1 acts on it for a short time.
fn pushed() -> Entry {
    let text = "Pushed {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        forces { push: exp(-((t - 5.3)/0.1)^2)/(0.1*sqrt(pi))*d(x); }
        initial { x = 0; dot(x) = 0; until = 10; }
    }";
    Entry::of_text("pushed", text)
}

/// Also where the tolerance would allow longer steps.
#[test]
fn no_step_is_longer_than_the_largest() {
    for integrator in ["dop853", "dopri5", "taylor"] {
        let line = format!("simulate pushed --max-step 0.05 --integrator {integrator}");
        let words: Vec<&str> = line.split_whitespace().collect();
        let told = run_over(&[pushed()], "", &words);
        assert!(
            told.output.contains("no step above 0.05\n"),
            "{}",
            told.output
        );
        let words = [&words[..], &["--json", "-"]].concat();
        let document = run_over(&[pushed()], "", &words).json();
        assert_eq!(document["outcome"]["kind"], "done");
        assert_eq!(document["max_step"], 0.05);
        let v = numbers(&document["outcome"]["qdot"])[0];
        assert!((v - 1.0).abs() < 1e-8, "{integrator}: {v}");
        // Most steps have the full length, since the tolerance does not limit them.
        let steps = document["counters"]["accepted"].as_u64().unwrap();
        assert!((200..300).contains(&steps), "{integrator}: {steps}");
    }
}

/// Members run alone with `dop853` and in SIMD lanes with `taylor`.
#[test]
fn members_keep_to_the_largest_step() {
    for integrator in ["dop853", "taylor"] {
        let line = format!(
            "ensemble pushed --vary x=0..1:12 --max-step 0.05 --integrator {integrator} --csv -"
        );
        let words: Vec<&str> = line.split_whitespace().collect();
        let done = run_over(&[pushed()], "", &words);
        let mut reader = csv::Reader::from_reader(done.output.as_bytes());
        let headers = reader.headers().unwrap().clone();
        let column = headers.iter().position(|name| name == "end.x_dot").unwrap();
        for record in reader.records().map(Result::unwrap) {
            let v: f64 = record[column].parse().unwrap();
            assert!((v - 1.0).abs() < 1e-8, "{integrator}: {v}");
        }
    }
}

/// Integrators of fixed step do not estimate errors. A warning reports a change of energy if the motion conserves it.
#[test]
fn a_step_that_is_too_long_is_told() {
    let line = "simulate oscillator --set k=40 --integrator rk4";
    let good = run(&format!("{line} --step 0.001 --json -"));
    assert!(good.errors.is_empty(), "{}", good.errors);
    assert_eq!(good.json()["warnings"], Value::Array(Vec::new()));
    let bad = run(&format!("{line} --step 0.3 --json -"));
    for part in [
        "warning: rk4 with step 0.3: the energy",
        "of its size",
        "--step",
        "--integrator dop853",
    ] {
        assert!(bad.errors.contains(part), "{}", bad.errors);
    }
    let warnings = bad.json()["warnings"].clone();
    assert_eq!(warnings.as_array().unwrap().len(), 1);
    let text = warnings[0].as_str().unwrap();
    assert_eq!(bad.errors, format!("warning: {text}\n"));
}

/// The tolerance is absolute for coordinates below 1. A micrometre is no small unit of length to a user.
#[test]
fn coordinates_that_the_tolerance_exceeds_are_told() {
    let wall = "
        Wall {
            coordinates { x; }
            parameters { s > 0 = 1; }
            lagrangian = (dot(x)^2 - x^2)/2;
            impacts { w: x <= 0.9*s; }
            initial { dot(x) = s; until = 5; }
        }";
    for (size, is_told) in [
        ("1", false),
        ("1e-3", false),
        ("1e-6", true),
        ("1e-15", true),
    ] {
        let set = format!("s={size}");
        let done = run_on(wall, &["simulate", "-", "--set", &set]);
        let told = done.errors.contains("warning: no coordinate exceeds 9.0e");
        assert_eq!(told, is_told, "{size}: {}", done.errors);
    }
    let fine = run_on(
        wall,
        &["simulate", "-", "--set", "s=1e-6", "--tol", "1e-15"],
    );
    assert!(fine.errors.is_empty(), "{}", fine.errors);
    // Every step ends at the floor, and the hops are as high as 1/2.
    let hops = "
        Hops {
            coordinates { x; }
            lagrangian = dot(x)^2/2 - x;
            impacts { floor: x >= 0 => newton(0.99); }
            initial { dot(x) = 1; until = 100; }
        }";
    let hops = run_on(hops, &["simulate", "-"]);
    assert!(hops.errors.is_empty(), "{}", hops.errors);
}

/// Work of forces and losses in impacts are no errors of the energy.
#[test]
fn work_and_impacts_are_no_errors_of_the_energy() {
    for integrator in ["rk4", "gauss4", "dla4"] {
        for line in [
            "bouncing_ball --until 30 --step 0.05",
            "bouncing_ball --until 4 --law newton:0.5 --step 0.05",
            "pushed --step 0.01",
        ] {
            let line = format!("simulate {line} --integrator {integrator} --json -");
            let models = [systems::entries(), &[pushed()]].concat();
            let words: Vec<&str> = line.split_whitespace().collect();
            let done = run_over(&models, "", &words);
            assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
            assert!(done.errors.is_empty(), "{line}: {}", done.errors);
        }
    }
}

/// A tight tolerance would ask for too many steps of a method of low order. Their number is limited.
#[test]
fn steps_that_are_chosen_have_a_number() {
    let done = run("simulate oscillator --set k=4 --integrator dla2 --tol 1e-15 --json -");
    assert_eq!(done.exit, Exit::Reached);
    let document = done.json();
    let steps = document["counters"]["accepted"].as_u64().unwrap();
    assert!(steps <= 1 << 22, "{steps}");
    for part in ["warning: dla2 with step", "--tol 1e-15", "--step"] {
        assert!(done.errors.contains(part), "{}", done.errors);
    }
}

#[test]
fn impacts_are_located_and_samples_never_cross_them() {
    let (exit, document) = document("simulate bouncing_ball --until 10 --samples 1001");
    assert_eq!(exit, Exit::Reached);
    let root = 2f64.sqrt();
    let expected: Vec<f64> = (0..4)
        .map(|k| root * f64::from(2 * k + 1))
        .filter(|&t| t <= 10.0)
        .collect();
    let events = document["events"].as_array().unwrap();
    assert_eq!(events.len(), expected.len());
    for (event, t) in events.iter().zip(expected) {
        assert!((event["t"].as_f64().unwrap() - t).abs() < 1e-9);
        assert_eq!(event["surface"], "floor");
        assert!(numbers(&event["qdot_minus"])[0] < 0.0 && numbers(&event["qdot_plus"])[0] > 0.0);
        assert!((event["energy"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    }
    for sample in document["samples"].as_array().unwrap() {
        let hop = (sample["t"].as_f64().unwrap() + root).rem_euclid(2.0 * root) - root;
        assert!((numbers(&sample["q"])[0] - (1.0 - 0.5 * hop * hop)).abs() < 1e-8);
    }
}

#[test]
fn a_number_of_impacts_is_an_end_that_can_be_reached() {
    let (exit, document) = document("simulate bouncing_ball --impacts 3 --samples 11");
    assert_eq!(exit, Exit::Reached);
    assert_eq!(document["events"].as_array().unwrap().len(), 3);
    let (times, end) = (
        times(&document["samples"]),
        document["outcome"]["t"].as_f64().unwrap(),
    );
    assert_eq!(times.len(), 11);
    assert_eq!(times[10], end);
    assert!((end - 5.0 * 2f64.sqrt()).abs() < 1e-9);
    let last = &document["samples"][10];
    assert!(
        numbers(&last["qdot"])[0] > 0.0,
        "a sample at an impact shows the state after it"
    );
}

#[test]
fn too_few_impacts_before_the_end_still_reach_the_end_time() {
    let (exit, document) = document("simulate bouncing_ball --impacts 30 --until 5 --samples 2");
    assert_eq!(exit, Exit::Reached);
    assert_eq!(document["outcome"]["kind"], "done");
    assert_eq!(document["events"].as_array().unwrap().len(), 2);
}

#[test]
fn laws_by_name_and_by_surface() {
    for law in [
        "newton:0.5",
        "floor=restitution:0.5",
        "elastic --law floor=newton:0.5",
    ] {
        let (_, document) = document(&format!("simulate bouncing_ball --until 2 --law {law}"));
        let event = &document["events"][0];
        let ratio = numbers(&event["qdot_plus"])[0] / numbers(&event["qdot_minus"])[0];
        assert!((ratio + 0.5).abs() < 1e-12, "{law}");
    }
}

#[test]
fn other_outcomes_exit_with_one_and_still_write() {
    let (exit, document) = document("simulate bead --until 20");
    assert_eq!(exit, Exit::Other);
    assert_eq!(document["outcome"]["kind"], "left_chart");
    assert_eq!(document["outcome"]["coordinate"], "y");
    assert!((document["outcome"]["t"].as_f64().unwrap() - 4.0).abs() < 1e-9);
    let samples = times(&document["samples"]);
    assert!(samples.len() > 100);
    // The last one is the state at the end.
    assert_eq!(samples.last(), document["outcome"]["t"].as_f64().as_ref());
    assert!(samples.is_sorted_by(|one, next| one < next), "{samples:?}");
}

#[test]
fn a_state_below_the_floor_starts_inside() {
    let (exit, document) = document("simulate bouncing_ball --q -1 --qdot 0 --until 1");
    assert_eq!(exit, Exit::Other);
    assert_eq!(document["outcome"]["kind"], "starts_inside");
    assert_eq!(document["outcome"]["surface"], "floor");
    assert_eq!(times(&document["samples"]), [0.0]);
}

#[test]
fn initial_values_by_name_with_dependent_velocities_completed() {
    let (_, document) = document("simulate bead --initial x=0.125,x_dot=-0.5,y=pi/8 --samples 1");
    assert_eq!(
        numbers(&document["samples"][0]["q"]),
        [0.125, std::f64::consts::PI / 8.0]
    );
    assert_eq!(numbers(&document["samples"][0]["qdot"]), [-0.5, -0.5]);
    let (_, document) =
        super::simulate::document("simulate oscillator --set k=1 --initial x_dot.2=3 --samples 1");
    assert_eq!(numbers(&document["samples"][0]["qdot"]), [0.0, 3.0]);
}

#[test]
fn momenta_instead_of_velocities() {
    let (_, document) =
        document("simulate bouncing_ball --set m=4 --q 1 --p -2 --until 1 --samples 1");
    assert_eq!(numbers(&document["samples"][0]["qdot"]), [-0.5]);
}

#[test]
fn off_constraint_policies() {
    let start = "simulate bead --q 0,0 --qdot 0.5,0.25 --until 0.5 --samples 1";
    let refused = run(start);
    assert_eq!(refused.exit, Exit::Refused);
    for part in [
        "`wire`",
        "-2.5e-1",
        "--off-constraint project",
        "--off-constraint keep",
    ] {
        assert!(
            refused.errors.contains(part),
            "{part} in {}",
            refused.errors
        );
    }
    let velocities = |policy: &str| {
        let (_, document) = document(&format!("{start} --off-constraint {policy}"));
        numbers(&document["samples"][0]["qdot"])
    };
    assert_eq!(velocities("project"), [0.375, 0.375]);
    assert_eq!(velocities("keep"), [0.5, 0.25]);
}

/// The residuals of the blade and of the circle stay; the bead moves to larger circles.
#[test]
fn residuals_that_are_kept_persist() {
    /// The residual at positions and velocities.
    type Residual = fn(&[f64], &[f64]) -> f64;
    let sleigh = "M {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2 + dot(theta)*(dot(y)*cos(theta) - dot(x)*sin(theta))/4;
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
    }";
    let bead = "M {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { circle: x^2 + y^2 = 1; }
        initial { x = 1; }
    }";
    let slip = |q: &[f64], v: &[f64]| v[1] * q[2].cos() - v[0] * q[2].sin();
    let rise = |q: &[f64], v: &[f64]| q[0] * v[0] + q[1] * v[1];
    let cases: [(_, _, Residual); 2] = [
        (sleigh, "x_dot=1,y_dot=0.4,theta_dot=0.3", slip),
        (bead, "x_dot=0.1,y_dot=0.5", rise),
    ];
    for (text, start, residual) in cases {
        let line = format!(
            "simulate - --initial {start} --until 1 --max-step 0.1 --off-constraint keep --json -"
        );
        let done = run_on(text, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        let document = done.json();
        let samples = document["samples"].as_array().unwrap();
        let [first, last] = [&samples[0], &samples[samples.len() - 1]]
            .map(|sample| residual(&numbers(&sample["q"]), &numbers(&sample["qdot"])));
        assert!(
            first.abs() > 0.09 && (last - first).abs() < 1e-8,
            "{first}, {last}"
        );
    }
}

#[test]
fn contradicting_velocities_are_settled_by_the_policy() {
    let start = "simulate bead --initial x_dot=1,y_dot=0 --until 0.1 --samples 1";
    assert_eq!(run(start).exit, Exit::Refused);
    let (_, document) = document(&format!("{start} --off-constraint project"));
    assert_eq!(numbers(&document["samples"][0]["qdot"]), [0.5, 0.5]);
}

#[test]
fn a_table_has_samples_and_impacts_in_order_of_time() {
    let done = run("simulate bouncing_ball --until 5 --samples 6 --csv -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let mut reader = csv::Reader::from_reader(done.output.as_bytes());
    assert_eq!(
        reader.headers().unwrap(),
        vec!["t", "x", "x_dot", "energy", "event"]
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let times: Vec<f64> = rows.iter().map(|row| row[0].parse().unwrap()).collect();
    assert!(times.is_sorted());
    assert_eq!(rows.len(), 8);
    let events: Vec<&str> = rows
        .iter()
        .map(|row| &row[4])
        .filter(|event| !event.is_empty())
        .collect();
    assert_eq!(events, ["floor", "floor"]);
}

/// Rows are written before the run ends.
#[test]
fn a_table_is_written_while_the_run_goes_on() {
    struct Full {
        room: usize,
    }
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.room = self
                .room
                .checked_sub(bytes.len())
                .ok_or(std::io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    // The run would take hours, but ends when its first rows find no room.
    let line = "dalembert simulate bouncing_ball --until 1e12 --samples 0 --csv -";
    let mut errors = Vec::new();
    let mut streams = Streams {
        input: &mut "".as_bytes(),
        output: &mut Full { room: 100_000 },
        errors: &mut errors,
        terminal: false,
    };
    let exit = run_with(line.split_whitespace(), systems::entries(), &mut streams);
    assert_eq!(exit, Exit::Refused);
    let errors = String::from_utf8(errors).unwrap();
    assert!(errors.contains("standard streams"), "{errors}");
}

/// The document has more rows than are kept in memory.
#[test]
fn a_long_document_is_whole() {
    let (exit, document) =
        document("simulate bouncing_ball --until 30000 --samples 20001 --law elastic");
    assert_eq!(exit, Exit::Reached);
    let (events, samples) = (times(&document["events"]), times(&document["samples"]));
    assert_eq!(events.len(), (30000.0 / 8f64.sqrt()).round() as usize);
    assert_eq!(samples.len(), 20001);
    assert!(events.is_sorted() && samples.is_sorted());
    assert_eq!(samples[20000], 30000.0);
}

#[test]
fn a_table_of_outputs_names_members_of_families() {
    let done = run("simulate oscillator --set k=1 --samples 2 --csv -");
    assert_eq!(
        done.output.lines().next(),
        Some("t,x.1,x.2,x_dot.1,x_dot.2,energy,radius,event")
    );
    assert_eq!(done.output.lines().count(), 3);
}

#[test]
fn without_a_document_on_it_the_standard_output_has_a_summary() {
    let done = run("simulate bouncing_ball --until 5");
    assert_eq!(done.exit, Exit::Reached);
    for part in [
        "bouncing_ball",
        "done at t = 5",
        "2 (floor 2)",
        "taylor",
        "accepted",
    ] {
        assert!(done.output.contains(part), "{part} in {}", done.output);
    }
}

#[test]
fn a_list_of_values_sets_each_of_them() {
    let one = run("simulate bouncing_ball --until 1 --set m=2,g=3 --json -");
    let both = run("simulate bouncing_ball --until 1 --set m=2 --set g=3 --json -");
    assert_eq!(one.exit, Exit::Reached, "{}", one.errors);
    assert_eq!(one.output, both.output);
}

#[test]
fn the_summary_of_a_run_that_ends_early_has_a_reason_and_a_remedy() {
    for (line, lines) in [
        (
            "simulate bead --until 20",
            [
                "  outcome     left_chart at t = ",
                "  reason      coordinate `y` reached the end of its interval",
                "  try         a larger interval, or other coordinates",
            ],
        ),
        (
            "simulate bouncing_ball --q -1 --qdot 0 --until 1",
            [
                "  outcome     starts_inside at t = 0",
                "  reason      the gap of `floor` is -1e0 at the start or after a reset",
                "  try         a start, or a reset, with positive gap",
            ],
        ),
        (
            "simulate bouncing_ball --until 50 --steps 3",
            [
                "  outcome     step_budget at t = ",
                "  reason      the allowed number of steps was used up",
                "  try         a larger --steps",
            ],
        ),
    ] {
        let done = run(line);
        assert_eq!(done.exit, Exit::Other, "{line}");
        let mut output = done.output.lines();
        for expected in lines {
            let found = output.any(|line| line.starts_with(expected));
            assert!(found, "{expected}: {}", done.output);
        }
    }
    let done = run("simulate bouncing_ball --until 5");
    assert!(!done.output.contains("  reason "), "{}", done.output);
}

#[test]
fn the_same_run_is_the_same_to_the_byte() {
    let line = "simulate bouncing_ball --until 20 --law newton:0.9 --json -";
    assert_eq!(run(line).output, run(line).output);
}

#[test]
fn pictures_are_svg_of_the_view_or_of_the_histories() {
    let directory = std::env::temp_dir();
    for (model, text) in [
        ("oscillator --set k=4", "x[2]"),
        ("bouncing_ball --until 10", "impact: floor (4)"),
    ] {
        let path = directory.join(format!(
            "dalembert-cli-{}-{}.svg",
            &model[..4],
            std::process::id()
        ));
        let done = run(&format!("simulate {model} --plot {}", path.display()));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        let svg = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(svg.contains(text), "{text}");
    }
}

/// Names of the language stand for the names of columns, and give the same files.
#[test]
fn quantities_have_their_names_in_the_language() {
    let oscillator = "simulate oscillator --until 1 --set k=2 --samples 3 --csv -";
    for [column, language] in [
        [
            format!("{oscillator} --initial x.2=0.5,x_dot.1=0.25"),
            format!("{oscillator} --initial x[2]=0.5,dot(x[1])=0.25"),
        ],
        [
            "ensemble bouncing_ball --vary x_dot=0..1:3 --until 2 --csv - --density x_dot=-9..9,energy:3".to_owned(),
            "ensemble bouncing_ball --vary dot(x)=0..1:3 --until 2 --csv - --density dot(x)=-9..9,energy:3".to_owned(),
        ],
        [
            "map bouncing_ball --vary x_dot=0..1:3 --until 1 --csv -".to_owned(),
            "map bouncing_ball --vary dot(x)=0..1:3 --until 1 --csv -".to_owned(),
        ],
    ] {
        let [column, language] = [column, language].map(|line| run(&line));
        assert_eq!(column.exit, Exit::Reached, "{}", column.errors);
        assert_eq!(language.output, column.output, "{}", language.errors);
    }
    let unknown = run("simulate bouncing_ball --until 1 --initial dot(y)=1");
    assert!(unknown.errors.contains("`dot(y)`"), "{}", unknown.errors);
}

/// The surfaces are met at one time, and both orders of their resets lead to one state.
#[test]
fn resets_whose_order_does_not_matter_are_carried_out() {
    let planar = |impacts: &str, start: &str| {
        format!(
            "P {{ coordinates {{ x; y; n; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(n)^2)/2; \
             impacts {{ {impacts} }} initial {{ {start} until = 2; }} }}"
        )
    };
    let periodic = planar(
        "r: x <= 1 => reset { x = x - 2; }; b: y >= -1 => reset { y = y + 2; };",
        "x = 0.5; y = -0.5; dot(x) = 1; dot(y) = -1;",
    );
    let counted = planar(
        "a: y >= 0; b: x >= 0 => reset { dot(x) = -dot(x); n = n + 1; };",
        "x = 2; y = 1; dot(x) = -2; dot(y) = -1;",
    );
    for text in [periodic, counted] {
        let done = run_over(&[], &text, &["simulate", "-"]);
        assert_eq!(done.exit, Exit::Reached, "{}", done.output);
        assert!(done.output.contains("impacts     2"), "{}", done.output);
    }
    // The second reset takes the value that the first one gives.
    let shared = planar(
        "r: x <= 1 => reset { x = x - 2; n = n + 1; }; b: y >= -1 => reset { y = y + 2; n = 2*n; };",
        "x = 0.5; y = -0.5; n = 3; dot(x) = 1; dot(y) = -1;",
    );
    let done = run_over(&[], &shared, &["simulate", "-"]);
    assert!(done.output.contains("ambiguous"), "{}", done.output);
}
