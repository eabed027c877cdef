//! Maps: classes and orbits with closed forms, files that do not depend on threads or interruptions, and refused flags.

use std::fs;

use super::folder::Folder;
use super::tables::{column, numbers_of};
use super::*;

/// A particle that tends to 1 or -1 or stays at 0, and a clock that ticks once per unit of time.
const SWITCH: &str = "
    Switch {
        coordinates { x; c; }
        parameters { a = 1; s = 1; }
        field { dot(x) = a*x - x^3; dot(c) = 1; }
        impacts { tick: c <= 1 => reset { c = 0; x = s*x; }; }
        initial { x = 0.5; until = 3; }
        outputs { square: x^2; }
    }";

/// Runs `map` over the switch, with flags given as words.
fn map_of(words: &[&str]) -> Done {
    let line: Vec<&str> = ["map", "-"].iter().chain(words).copied().collect();
    run_on(SWITCH, &line)
}

/// Runs `map` over the switch, with flags given as one text.
fn map(flags: &str) -> Done {
    map_of(&flags.split_whitespace().collect::<Vec<_>>())
}

/// The rows of `map`.
fn rows(flags: &str) -> String {
    let done = map(&format!("{flags} --csv -"));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    done.output
}

/// Nine starts. The middle one stays at 0.
const STARTS: &str = "--vary x=-2..2:9 --returns 20";

#[test]
fn cells_tend_to_the_orbits_of_their_basins() {
    let table = rows(&format!("{STARTS} --lyapunov 10"));
    // Orbits are numbered in the order of the cells.
    let orbits = ["1", "1", "1", "1", "2", "3", "3", "3", "3"];
    assert_eq!(column(&table, "orbit"), orbits);
    let classes = orbits.map(|orbit| format!("orbit {orbit} (period 1)"));
    assert_eq!(column(&table, "class"), classes);
    assert_eq!(column(&table, "period"), ["1"; 9]);
    assert_eq!(column(&table, "returns"), ["20"; 9]);
    assert_eq!(column(&table, "outcome"), ["returned"; 9]);
    for (orbit, end) in orbits.iter().zip(numbers_of(&table, "end.x")) {
        let expected = orbit.parse::<f64>().unwrap() - 2.0;
        assert!((end - expected).abs() < 1e-9, "{end} for {expected}");
    }
    for t in numbers_of(&table, "t") {
        assert!((t - 20.0).abs() < 1e-9, "{t}");
    }
    // The slope of the field is -2 at 1 and -1, and 1 at 0.
    for (orbit, exponent) in orbits.iter().zip(numbers_of(&table, "exponent")) {
        let expected = if *orbit == "2" { 1.0 } else { -2.0 };
        assert!((exponent - expected).abs() < 1e-9, "{exponent}");
    }
}

#[test]
fn an_orbit_may_need_several_returns() {
    let flags = format!("{STARTS} --set s=-1");
    let table = rows(&flags);
    let periods = ["2", "2", "2", "2", "1", "2", "2", "2", "2"];
    assert_eq!(column(&table, "period"), periods);
    // Both halves of the line tend to the orbit that alternates between 1 and -1.
    let orbits = ["1", "1", "1", "1", "2", "1", "1", "1", "1"];
    assert_eq!(column(&table, "orbit"), orbits);
    let classes = column(&rows(&format!("{flags} --period 1")), "class");
    assert_eq!(classes[0], "unsettled");
    // Without the coordinate that changes sign the period is one return.
    let table = rows(&format!("{flags} --ignore x"));
    assert_eq!(column(&table, "period"), ["1"; 9]);
}

#[test]
fn returns_that_have_not_settled_are_told() {
    let table = rows("--vary x=0.1..0.2:2 --returns 4");
    assert_eq!(column(&table, "class"), ["unsettled"; 2]);
    let table = rows("--vary x=0.1..0.2:2 --returns 4 --near 0.5");
    assert_eq!(column(&table, "class"), ["orbit 1 (period 1)"; 2]);
}

#[test]
fn a_varied_parameter_gives_every_cell_orbits_of_its_own() {
    let table = rows("--vary a=1..4:4 --returns 20 --lyapunov 10");
    assert_eq!(column(&table, "class"), ["period 1"; 4]);
    assert_eq!(column(&table, "orbit"), ["0"; 4]);
    let parameters = numbers_of(&table, "in.a").into_iter();
    let found = numbers_of(&table, "end.x").into_iter();
    for ((a, x), exponent) in parameters.zip(found).zip(numbers_of(&table, "exponent")) {
        assert!((x - a.sqrt()).abs() < 1e-8, "{x} for {a}");
        assert!((exponent + 2.0 * a).abs() < 1e-8, "{exponent} for {a}");
    }
}

#[test]
fn an_expression_ends_runs_as_failed() {
    let words = STARTS.split_whitespace();
    let words: Vec<&str> = words
        .chain(["--fail", "x + a > 1.9", "--csv", "-"])
        .collect();
    let table = map_of(&words).output;
    let class = column(&table, "class");
    // For starts at 1 and above the condition holds at once; from 0.5 it begins to hold after the first return.
    let (stays, later, once) = ("orbit", "failed", "failed at once");
    let expected = [stays, stays, stays, stays, stays, later, once, once, once];
    assert_eq!(class.len(), expected.len());
    for (class, expected) in class.iter().zip(expected) {
        let same = class == expected || (expected == stays && class.starts_with("orbit "));
        assert!(same, "{class} for {expected}");
    }
    let (outcome, returns) = (column(&table, "outcome"), column(&table, "returns"));
    assert_eq!(outcome[5..], ["failed"; 4]);
    // x(t) = (1 + 3 exp(-2 t))^(-1/2) passes 0.9 at t = 1.2743..
    assert_eq!(returns[5..], ["1", "0", "0", "0"]);
}

#[test]
fn without_returns_the_outcome_of_the_run_is_the_class() {
    let table = rows("--vary x=-1..1:3 --until 0.5");
    assert_eq!(column(&table, "class"), ["done"; 3]);
    assert_eq!(numbers_of(&table, "t"), [0.5; 3]);
    let table = rows("--vary x=-1..1:3 --until 0.5 --fail x>0.9");
    assert_eq!(column(&table, "class"), ["done", "done", "failed"]);
    let table = rows("--vary x=-1..1:3 --returns 9 --until 2.5");
    assert_eq!(column(&table, "class"), ["done"; 3]);
    assert_eq!(column(&table, "returns"), ["2"; 3]);
}

#[test]
fn values_and_lines_are_those_of_the_expressions() {
    let flags =
        "--vary x=-2..2:5 --vary a=1..4:2 --returns 20 --class x^2/a --contour x=a/2 --contour x+1";
    let table = rows(flags);
    let starts = numbers_of(&table, "in.x");
    let parameters = numbers_of(&table, "in.a");
    // The last --vary varies fastest.
    assert_eq!(starts[..4], [-2.0, -2.0, -1.0, -1.0]);
    assert_eq!(parameters[..4], [1.0, 4.0, 1.0, 4.0]);
    for (k, value) in numbers_of(&table, "value").into_iter().enumerate() {
        let expected = if starts[k] == 0.0 { 0.0 } else { 1.0 };
        assert!((value - expected).abs() < 1e-7, "{value}");
        let lines = [
            numbers_of(&table, "contour.1")[k],
            numbers_of(&table, "contour.2")[k],
        ];
        assert_eq!(lines, [starts[k] - 0.5 * parameters[k], starts[k] + 1.0]);
    }
}

/// A grid with two basins and their boundary, a contour and exponents.
const GRID: &str = "--vary x=-2..2:13 --vary c=0..0.5:11 --returns 20 --lyapunov 3 --contour x=c";

#[test]
fn rows_and_documents_do_not_depend_on_threads() {
    let folder = Folder::new("map-threads");
    let files = |threads: u32| {
        let [rows, plot] = ["rows.csv", "map.svg"].map(|name| folder.path(name));
        let done = map(&format!(
            "{GRID} --threads {threads} --csv {rows} --plot {plot} --json -"
        ));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        (folder.read("rows.csv"), folder.read("map.svg"), done.output)
    };
    let one = files(1);
    assert_eq!(one.0.lines().count(), 1 + 13 * 11);
    for threads in [2, 5] {
        assert_eq!(files(threads), one);
    }
}

#[test]
fn a_map_that_was_cut_off_goes_on_to_the_same_files() {
    let folder = Folder::new("map-resume");
    let path = folder.path("rows.csv");
    let plot = folder.path("map.svg");
    let line = format!("{GRID} --csv {path} --plot {plot}");
    let document = |line: &str| map(&format!("{line} --resume --json -")).output;
    let complete = document(&line);
    let (whole, picture) = (folder.read("rows.csv"), folder.read("map.svg"));
    for cut in [10, whole.len() / 3, whole.len() - 1, whole.len()] {
        fs::write(folder.path("rows.csv"), &whole.as_bytes()[..cut]).unwrap();
        assert_eq!(document(&line), complete, "cut at {cut}");
        assert_eq!(folder.read("rows.csv"), whole, "cut at {cut}");
        assert_eq!(folder.read("map.svg"), picture, "cut at {cut}");
    }
    let done = map(&format!("{line} --resume"));
    assert!(
        done.output.contains("(143 cells taken over)"),
        "{}",
        done.output
    );
    let other = line.replace("--contour x=c", "--contour x=2*c");
    let refused = map(&format!("{other} --resume"));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("another ensemble"),
        "{}",
        refused.errors
    );
}

#[test]
fn the_document_has_classes_and_orbits() {
    let document = map(&format!("{GRID} --json -")).json();
    assert_eq!(document["model"], "switch");
    assert_eq!(document["cells"], 143);
    assert_eq!(document["axes"][1]["name"], "c");
    assert_eq!(document["axes"][1]["count"], 11);
    assert_eq!(document["map"]["contours"][0], "x=c");
    let classes = document["classes"].as_object().unwrap();
    let names: Vec<&str> = classes.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [1, 2, 3].map(|orbit| format!("orbit {orbit} (period 1)"))
    );
    let orbits = document["orbits"].as_array().unwrap();
    let cells: Vec<u64> = orbits
        .iter()
        .map(|orbit| orbit["cells"].as_u64().unwrap())
        .collect();
    assert_eq!(cells, [66, 11, 66]);
    for (orbit, expected) in orbits.iter().zip([-1.0, 0.0, 1.0]) {
        let x = orbit["point"]["x"].as_f64().unwrap();
        assert!((x - expected).abs() < 1e-9, "{x}");
    }
}

/// The size of the image in a picture, and the colours of its pixels by rows.
fn image(svg: &str) -> ((u32, u32), Vec<[u8; 3]>) {
    use base64::Engine;
    let (_, rest) = svg.split_once("data:image/png;base64,").expect("an image");
    let data = rest.split('"').next().unwrap();
    let file = base64::engine::general_purpose::STANDARD
        .decode(data)
        .unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let palette = reader.info().palette.clone().unwrap().into_owned();
    let size = (reader.info().width, reader.info().height);
    let mut frame = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut frame).unwrap();
    let colour = |&index: &u8| {
        let first = 3 * usize::from(index);
        [palette[first], palette[first + 1], palette[first + 2]]
    };
    (size, frame.iter().map(colour).collect())
}

#[test]
fn a_picture_has_a_pixel_for_each_cell() {
    let folder = Folder::new("map-picture");
    let plot = folder.path("map.svg");
    let words = "--vary x=-2..2:5 --vary c=0..0.5:3 --returns 20 --plot".split(' ');
    let words: Vec<&str> = words
        .chain([
            plot.as_str(),
            "--contour",
            "x = 4*c - 1",
            "--fail",
            "x + c > 2.2",
        ])
        .collect();
    let done = map_of(&words);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let svg = folder.read("map.svg");
    let (size, pixels) = image(&svg);
    assert_eq!(size, (5, 3));
    // Rows are listed from top to bottom. The columns are the basins of -1, 0 and 1; at x = 2 the first two rows fail.
    let (left, middle, right) = (pixels[0], pixels[2], pixels[3]);
    assert!(left != middle && middle != right && left != right);
    for row in 0..3 {
        let row_of = &pixels[5 * row..5 * row + 4];
        assert_eq!(row_of, [left, left, middle, right]);
    }
    let fails = [pixels[4], pixels[9], pixels[14]];
    assert!(
        fails[0] != right && fails[1] != right && fails[2] == right,
        "{fails:?}"
    );
    for text in [
        "failed at once, ",
        "orbit 1 (period 1), ",
        "x = 4*c - 1",
        ">x<",
        ">c<",
    ] {
        assert!(svg.replace('\n', "").contains(text), "{text}");
    }
}

#[test]
fn one_axis_is_a_strip_and_numbers_have_a_bar() {
    let folder = Folder::new("map-strip");
    let plot = folder.path("map.svg");
    for class in ["end", "returns", "lyapunov", "x^2", "x>0"] {
        let done = map(&format!(
            "{STARTS} --lyapunov 3 --class {class} --plot {plot}"
        ));
        assert_eq!(done.exit, Exit::Reached, "{class}: {}", done.errors);
        let (size, pixels) = image(&folder.read("map.svg"));
        assert_eq!(size, (9, 1), "{class}");
        let is_even = class == "x^2" || class == "lyapunov";
        assert_eq!(
            is_even,
            pixels[0] == pixels[8] && pixels[0] != pixels[4],
            "{class}"
        );
    }
}

#[test]
fn a_cell_that_does_not_start_is_a_row() {
    let text = SWITCH.replace("a = 1;", "a > 0 = 1;");
    let words = "map - --vary a=-1..1:3 --returns 30 --csv -".split(' ');
    let done = run_on(&text, &words.collect::<Vec<_>>());
    assert_eq!(done.exit, Exit::Other);
    assert_eq!(
        column(&done.output, "class"),
        ["refused", "refused", "period 1"]
    );
    assert!(
        column(&done.output, "reason")[0].contains("`a`"),
        "{}",
        done.output
    );
}

#[test]
fn bad_flags_are_refused_where_they_are_wrong() {
    let cases: [(&[&str], &str); 22] = [
        (
            &["--vary", "y=0..1:3"],
            "unknown coordinate, velocity or parameter `y`",
        ),
        (
            &["--vary", "x=0..1:3", "--vary", "x=0..1:4"],
            "every name once",
        ),
        (&["--vary", "x=0..1:1"], "a count from 2 to 4000"),
        (&["--vary", "x=0..1:5000"], "a count from 2 to 4000"),
        (&["--vary", "x=1..1:3"], "A below B"),
        (&["--vary", "x=1,2"], "equally spaced"),
        (&["--vary", "x_dot=1..2:3"], "a coordinate or a parameter"),
        (
            &[
                "--vary", "x=0..1:2", "--vary", "c=0..1:2", "--vary", "a=0..1:2",
            ],
            "one axis or two",
        ),
        (&[], "--vary <NAME=A..B:COUNT>"),
        (&["--vary", "x=0..1:3", "--returns", "0"], "0 is not in 1.."),
        (&["--vary", "x=0..1:3", "--surface", "tick"], "--returns"),
        (
            &["--vary", "x=0..1:3", "--returns", "3", "--surface", "tock"],
            "did you mean `tick`?",
        ),
        (
            &["--vary", "x=0..1:3", "--returns", "3", "--ignore", "z"],
            "--ignore: unknown",
        ),
        (&["--vary", "x=0..1:3", "--fail", "x"], "a comparison by >"),
        (
            &["--vary", "x=0..1:3", "--fail", "x > 1 > 2"],
            "one comparison at most",
        ),
        (
            &["--vary", "x=0..1:3", "--contour", "x > 1"],
            "an equation such as",
        ),
        (
            &["--vary", "x=0..1:3", "--class", "x = 1"],
            "a number such as",
        ),
        (
            &["--vary", "x=0..1:3", "--class", "lyapunov"],
            "--lyapunov N",
        ),
        (&["--vary", "x=0..1:3", "--class", "returns"], "--returns N"),
        (&["--vary", "x=0..1:3", "--plot", "map.png"], "ends in .svg"),
        (
            &["--vary", "x=0..1:3", "--resume"],
            "--resume continues the file",
        ),
        (
            &["--vary", "x=0..1:3", "--csv", "a.svg", "--plot", "a.svg"],
            "different files",
        ),
    ];
    for (words, text) in cases {
        let done = map_of(words);
        assert_eq!(done.exit, Exit::Refused, "{words:?}");
        assert!(done.errors.contains(text), "{words:?}: {}", done.errors);
        assert!(done.output.is_empty());
    }
}

#[test]
fn mistakes_in_expressions_are_shown_in_the_flag() {
    let refused = |text: &str| {
        let done = map_of(&["--vary", "x=0..1:3", "--fail", text]);
        assert_eq!(done.exit, Exit::Refused, "{text}");
        done.errors
    };
    let errors = refused("x > 2*bb");
    assert!(errors.starts_with("error: --fail: "), "{errors}");
    assert!(errors.contains("`bb`"), "{errors}");
    assert!(errors.ends_with("  | x > 2*bb\n  |       ^^\n"), "{errors}");
    assert!(refused("sin(x)) > 0").ends_with("  | sin(x)) > 0\n  |       ^\n"));
    assert!(refused("x + > 0").contains("  | x + > 0\n"));
    assert!(refused("d(x) > 0").contains("  | d(x) > 0\n  | ^"));
    // A system written by hand may have no text.
    let words = "map oscillator --set k=1 --until 1 --vary x.1=0..1:3 --fail x>1".split(' ');
    let words: Vec<&str> = words.collect();
    let done = run_over(&[systems::made_by_hand()], "", &words);
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.contains("expressions need the text"),
        "{}",
        done.errors
    );
}

#[test]
fn a_model_with_several_surfaces_or_none_needs_a_word() {
    let two = SWITCH.replace("};", "}; wall: x >= -9 => reset { };");
    let words = "map - --vary x=0..1:3 --returns 3"
        .split(' ')
        .collect::<Vec<_>>();
    let refused = run_on(&two, &words);
    assert!(
        refused.errors.contains("choose one with --surface"),
        "{}",
        refused.errors
    );
    let named: Vec<&str> = words.iter().copied().chain(["--surface", "tick"]).collect();
    assert_eq!(run_on(&two, &named).exit, Exit::Reached);
    let none = run("map oscillator --set k=1 --vary x.1=0..1:3 --returns 3");
    assert!(
        none.errors.contains("no impact surfaces"),
        "{}",
        none.errors
    );
}

/// A neuron with the same state after every firing and a current that depends on time.
const FIRING: &str = "
    Firing {
        coordinates { v; }
        parameters { drive = 1.5; A = 0.4; w = 0.5; }
        field { dot(v) = drive - v + A*cos(w*t); }
        impacts { threshold: v <= 1 => reset { v = 0; }; }
        initial { until = 1000; }
    }";

#[test]
fn returns_at_uneven_times_are_no_orbit() {
    let map = |flags: &str| {
        let line = format!("map - --vary v=0..0.5:2 --returns 60 --csv - {flags}");
        let done = run_on(FIRING, &line.split_whitespace().collect::<Vec<_>>());
        assert_eq!((done.exit, done.errors.as_str()), (Exit::Reached, ""));
        done.output
    };
    // The times between firings range from 0.75 to 2.26.
    assert_eq!(numbers_of(&map(""), "period"), [0.0, 0.0]);
    // With a constant current these times are equal.
    assert_eq!(numbers_of(&map("--set A=0"), "period"), [1.0, 1.0]);
    // A field that depends on time has no exponent on its section.
    let exponents = numbers_of(&map("--lyapunov 3"), "exponent");
    assert!(exponents.iter().all(|it| it.is_nan()), "{exponents:?}");
}

#[test]
fn exponents_of_orbits_are_means_over_whole_periods() {
    let text = "
        Logistic {
            coordinates { x; tau; }
            parameters { r = 3.5; }
            field { dot(x) = 0; dot(tau) = 1; }
            impacts { tick: tau <= 1 => reset { x = r*x*(1 - x); tau = 0; }; }
            initial { x = 0.4; until = 10000; }
        }";
    let (mut x, mut expected) = (0.4_f64, 0.0);
    for made in 0..4004 {
        if made >= 4000 {
            expected += (3.5 * (1.0 - 2.0 * x)).abs().ln() / 4.0;
        }
        x *= 3.5 * (1.0 - x);
    }
    for count in ["1", "3", "4", "5"] {
        let line = format!("map - --vary x=0.3..0.4:2 --returns 400 --csv - --lyapunov {count}");
        let done = run_on(text, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(numbers_of(&done.output, "period"), [4.0, 4.0]);
        for exponent in numbers_of(&done.output, "exponent") {
            assert!(
                (exponent - expected).abs() < 1e-9,
                "{exponent} for {expected}"
            );
        }
    }
}

/// A return to a floor rounds to a state just behind it, from which the exponent is computed.
#[test]
fn exponents_exist_where_a_return_is_rounded() {
    let text = "
        Ball {
            coordinates { x; }
            parameters { e in [0, 1] = 0.9; }
            lagrangian = dot(x)^2/2 - x;
            impacts { floor: x >= 0 => newton(e); }
            initial { x = 1; until = 20; }
        }";
    let line = "map - --vary x=0.3..3:40 --returns 3 --csv - --lyapunov 3";
    let done = run_on(text, &line.split(' ').collect::<Vec<_>>());
    for exponent in numbers_of(&done.output, "exponent") {
        let error = exponent - 0.9_f64.ln();
        assert!(error.abs() < 1e-9, "{exponent}");
    }
}

/// Returns that repeat up to `t = 50` need not repeat later if the motion depends on time.
#[test]
fn orbits_of_motion_that_depends_on_time_are_told_as_such() {
    let text = "
        Kicked {
            coordinates { s; x; }
            field { dot(s) = -1; dot(x) = 0; }
            impacts { tick: s >= 0 => reset { s = 1; x = x/2 + KICK; }; }
            initial { s = 1; x = 0.3; until = 1000; }
        }";
    let line = "map - --vary x=0..1:2 --returns 50";
    let summary = |kick: &str| {
        let text = text.replace("KICK", kick);
        run_on(&text, &line.split(' ').collect::<Vec<_>>()).output
    };
    let note = "the motion depends on time";
    assert!(summary("exp(-(t - 60)^2)").contains(note));
    assert!(!summary("0").contains(note));
}
