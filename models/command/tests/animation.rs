//! Pages that play a run. Their data are compared with the run. The index of a gallery lists them.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

#[path = "support/folder.rs"]
mod folder;
mod support;

use std::fs;

use dalembert_cli::Exit;
use folder::Folder;
use serde_json::Value;
use support::run_on;

/// The data of the page that `simulate` writes with these flags.
fn played(folder: &Folder, input: &str, line: &str) -> Value {
    let path = folder.path("run.html");
    let done = run_on(input, &format!("simulate {line} --html {path}"));
    assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
    let page = fs::read_to_string(path).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>"));
    let (_, rest) = page
        .split_once("(document.getElementById('player'), ")
        .unwrap();
    let (data, _) = rest.split_once(");</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

fn pair(value: &Value) -> [f64; 2] {
    [0, 1].map(|place| value[place].as_f64().unwrap())
}

/// A ball from height 2 with g = 1: `x = 2 - t^2/2` until the impact at t = 2 at the speed 2.
/// After it `x = 2 s - s^2/2` with `s = t - 2`.
#[test]
fn heads_follow_the_motion() {
    let folder = Folder::new("ball");
    let data = played(
        &folder,
        "",
        "bouncing_ball --initial x=2 --until 4 --duration 2",
    );
    let times = list(&data["times"]);
    assert_eq!(times.len(), 61);
    let curve = &data["curves"][0];
    assert_eq!(data["labels"][0], "t");
    for (time, head) in times.iter().zip(list(&curve["heads"])) {
        let t = time.as_f64().unwrap();
        let s = t - 2.0;
        let expected = if s < 0.0 {
            2.0 - t * t / 2.0
        } else {
            2.0 * s - s * s / 2.0
        };
        let [at, x] = pair(head);
        assert!((at - t).abs() < 1e-5, "{at} {t}");
        assert!((x - expected).abs() < 2e-3, "{t}: {x} {expected}");
    }
    let impacts = list(&curve["impacts"]);
    assert_eq!(impacts.len(), 1);
    assert!((impacts[0][0].as_f64().unwrap() - 2.0).abs() < 1e-12);
    let [left, right, low, high] = [0, 1, 2, 3].map(|k| data["box"][k].as_f64().unwrap());
    assert!(left < 0.0 && right > 4.0 && low < 0.0 && high > 2.0);
}

/// The table of the rolling disk is at rest. A region with a moving wall has a border for each frame.
#[test]
fn walls_are_drawn_where_they_are() {
    let folder = Folder::new("walls");
    let disk = played(&folder, "", "rolling_disk --until 5 --duration 1");
    assert_eq!(disk["equal"], true);
    let [border] = list(&disk["borders"]) else {
        panic!("{} borders", list(&disk["borders"]).len());
    };
    for line in list(border) {
        for point in list(line) {
            let [x, y] = pair(point);
            let radius = ((x / 0.15).powi(2) + (y / 0.20).powi(2)).sqrt();
            assert!((radius - 1.0).abs() < 1e-2, "{x} {y}");
        }
    }
    // The wall is at x = sin(t), and a puck meets it. In most frames the picture contains the wall.
    let wall = "
        Puck {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts { wall: x >= sin(t); }
            initial { x = 1; y = 0; dot(x) = -1; dot(y) = 1; until = 3; }
            view { path: (x, y); region: x >= sin(t); }
        }";
    let moving = played(&folder, wall, "- --duration 1");
    let times = list(&moving["times"]);
    let borders = list(&moving["borders"]);
    assert_eq!(borders.len(), times.len());
    let [left, right] = [0, 1].map(|place| moving["box"][place].as_f64().unwrap());
    let mut seen = 0;
    for (time, border) in times.iter().zip(borders) {
        let place = time.as_f64().unwrap().sin();
        let points: Vec<[f64; 2]> = list(border).iter().flat_map(list).map(pair).collect();
        if place < left + 0.1 || place > right - 0.1 {
            continue;
        }
        assert!(!points.is_empty(), "{time}");
        seen += 1;
        // The ends of the line follow the edge of the picture to the next point of the grid.
        let near = points.iter().filter(|[x, _]| (x - place).abs() < 1e-3);
        assert!(near.count() + 4 >= points.len(), "{time}: {points:?}");
    }
    assert!(seen > 20, "{seen}");
}

/// At a reset that moves the state the path is interrupted, and the head continues from the new state.
#[test]
fn jumps_interrupt_the_path() {
    let folder = Folder::new("jumps");
    let saw = "
        Saw {
            coordinates { x; }
            lagrangian = dot(x)^2/2;
            impacts { tooth: x <= 1 => reset { x = 0; }; }
            initial { x = 0; dot(x) = 1; until = 2.5; }
        }";
    let data = played(&folder, saw, "- --duration 1 --axes t,x");
    let curve = &data["curves"][0];
    let gaps = list(&curve["path"])
        .iter()
        .filter(|point| point[0].is_null());
    assert_eq!(gaps.count(), 2);
    let last = list(&curve["heads"]).last().unwrap();
    assert!((pair(last)[1] - 0.5).abs() < 1e-6, "{last}");
}

#[test]
fn a_gallery_lists_its_animations() {
    let folder = Folder::new("gallery-animations");
    let out = folder.path("out");
    let done = run_on(
        "",
        &format!("gallery {out} bouncing_ball --quick --animations"),
    );
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert!(done.output.contains("index.html"), "{}", done.output);
    let index = fs::read_to_string(format!("{out}/index.html")).unwrap();
    let (_, animations) = index.split_once("<nav id=\"animations\">").unwrap();
    let (animations, _) = animations.split_once("</nav>").unwrap();
    let pages: Vec<&str> = animations
        .split("href=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    assert!(!pages.is_empty());
    for page in pages {
        let text = fs::read_to_string(format!("{out}/{page}")).unwrap();
        assert!(text.contains("<canvas>"), "{page}");
    }
    let plain = folder.path("plain");
    run_on("", &format!("gallery {plain} bouncing_ball --quick"));
    let index = fs::read_to_string(format!("{plain}/index.html")).unwrap();
    assert!(!index.contains("animations"));
}

#[test]
fn flags_of_a_page_without_a_page_are_refused() {
    let done = run_on("", "simulate bouncing_ball --until 1 --duration 2");
    assert_eq!(done.exit, Exit::Refused);
    assert!(done.errors.contains("--html"), "{}", done.errors);
    let done = run_on("", "simulate bouncing_ball --until 1 --axes t,x");
    assert_eq!(done.exit, Exit::Refused);
}
