use std::fs;
use std::path::Path;

use dalembert_cli::Catalogue;
use dalembert_cli::gallery::{Density, Figure, Panel, Picture, Starts};

use super::folder::Folder;
use super::*;

fn figures() -> Vec<Figure> {
    let panel = |name: &str, picture| Panel {
        name: name.to_owned(),
        title: format!("The {name}"),
        picture,
    };
    let figure = Figure {
        model: "oscillator",
        name: "lissajous",
        title: "Two springs",
        chapter: "Springs",
        highlight: Some(0),
        caption: "Where k < 5 & more.".to_owned(),
        source: Some("A book, Fig. 1"),
        panels: vec![
            panel(
                "curve",
                Picture::Simulate("--set k=4 --axes x.1,x.2".to_owned()),
            ),
            panel(
                "starts",
                Picture::Starts(Starts {
                    flags: "--set k=4 --until 3".to_owned(),
                    members: 10,
                    scatter: vec![("x.1", 1.0, 0.1)],
                    seed: 1,
                }),
            ),
            panel(
                "density",
                Picture::Density(Density {
                    flags: "--set k=2".to_owned(),
                    every: 0.1,
                    positions: 5000,
                    discarded: 100,
                    boxes: 10,
                }),
            ),
        ],
    };
    let work = Figure {
        name: "work",
        panels: vec![panel("", Picture::Accuracy("--set k=4".to_owned()))],
        ..figure.clone()
    };
    vec![figure, work]
}

/// Runs `gallery` or another command with the figures of [`figures`].
fn run_line(line: &str) -> Done {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut std::io::empty(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let catalogue = Catalogue::of(systems::entries().to_vec()).with_figures(figures());
    let exit = catalogue.run_with(line.split_whitespace(), &mut streams);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Done {
        exit,
        output: text(output),
        errors: text(errors),
    }
}

fn gallery(folder: &Path, words: &str) -> Done {
    run_line(&format!("dalembert gallery {} {words}", folder.display()))
}

/// Asserts that all elements are closed in order.
fn assert_well_formed(page: &str) {
    let mut open = Vec::new();
    for (start, _) in page.match_indices('<') {
        let end = start + page[start..].find('>').unwrap();
        let tag = &page[start + 1..end];
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = |tag: &str| {
            let end = tag.find(|letter: char| letter.is_whitespace() || letter == '/');
            tag[..end.unwrap_or(tag.len())].to_owned()
        };
        match tag {
            _ if tag.starts_with('!') || tag.ends_with('/') => {}
            _ if tag.starts_with('/') => assert_eq!(open.pop().as_deref(), Some(&tag[1..])),
            _ => open.push(name(tag)),
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn the_commands_of_a_page_draw_its_pictures() {
    let (folder, alone) = (Folder::not_made("page"), Folder::not_made("alone"));
    let done = gallery(&folder.0, "oscillator bead --quick");
    // The motion of the oscillator cannot be drawn, since its parameter has no default.
    assert_eq!(done.exit, Exit::Other, "{}", done.errors);
    assert!(
        done.errors
            .contains("error: oscillator-motion-path: parameter `k` has no default"),
        "{}",
        done.errors
    );
    let page = folder.read("index.html");
    assert_well_formed(&page);
    assert!(!page.contains("<script") && !page.contains("src=") && !page.contains("url("));
    assert!(page.contains("Where k &lt; 5 &amp; more.") && page.contains("A book, Fig. 1"));
    assert!(page.contains("parameter `k` has no default"));

    fs::create_dir_all(&alone.0).unwrap();
    let commands = page.split("<code>").skip(1);
    let mut drawn = 0;
    for words in commands.map(|rest| rest.split("</code>").next().unwrap()) {
        let command = &words.replace("<span>", "").replace("</span>", "");
        let (line, file) = match command.split_once(" --plot ") {
            Some((line, file)) => {
                let path = alone.0.join(file);
                (format!("{line} --plot {}", path.display()), file.to_owned())
            }
            None => {
                let name = command.split_whitespace().nth(4).unwrap();
                let out = format!(" {} ", alone.0.display());
                (command.replacen(" . ", &out, 1), format!("{name}.svg"))
            }
        };
        let done = run_line(&line);
        if command.contains("oscillator-motion") {
            assert_eq!(done.exit, Exit::Refused, "{command}");
            continue;
        }
        assert_eq!(done.exit, Exit::Reached, "{command}: {}", done.errors);
        // `assert_eq` would print the long pictures.
        assert!(alone.read(&file) == folder.read(&file), "{command}");
        // The page contains the picture inline.
        let picture = folder.read(&file);
        let (_, picture) = picture.split_once("<svg ").unwrap();
        assert!(page.contains(picture), "{command}");
        drawn += 1;
    }
    // Three pictures of the figure, and at least three of the motion of the bead.
    assert!(drawn >= 6, "{drawn}");
    assert!(!alone.0.join("index.html").exists());
}

#[test]
fn two_galleries_are_the_same_to_the_byte_and_the_manifest_names_what_was_drawn() {
    let folders = [Folder::not_made("first"), Folder::not_made("second")];
    for folder in &folders {
        assert_eq!(gallery(&folder.0, "oscillator --quick").exit, Exit::Other);
    }
    let [first, second] = &folders;
    assert!(first.read("index.html") == second.read("index.html"));
    let manifest: Value = serde_json::from_str(&first.read("manifest.json")).unwrap();
    let rows = manifest["pictures"].as_array().unwrap();
    let row = |picture: &str| {
        let found = rows.iter().find(|row| row["picture"] == picture);
        found.unwrap_or_else(|| panic!("{picture} in {manifest}"))
    };
    let curve = row("oscillator-lissajous-curve");
    assert_eq!(curve["source"], "A book, Fig. 1");
    assert_eq!(curve["outcome"], "done at t = 20");
    assert!(curve["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(
        curve["command"],
        "dalembert simulate oscillator --set k=4 --axes x.1,x.2 --plot oscillator-lissajous-curve.svg"
    );
    let starts = row("oscillator-lissajous-starts");
    assert_eq!(starts["outcome"], "10 of 10 runs at t = 3");
    assert!(
        first
            .read(starts["file"].as_str().unwrap())
            .contains("scattered starts (10)")
    );
    let failed = row("oscillator-motion-path");
    assert!(failed["error"].as_str().unwrap().contains("`k`"));
    assert!(failed["file"].is_null());
    assert!(!rows.iter().any(|row| row["figure"] == "work"));
}

#[test]
fn pictures_are_listed_and_drawn_by_name() {
    let listed = run_line("dalembert gallery --list").output;
    assert!(
        listed
            .lines()
            .any(|line| line.starts_with("oscillator-lissajous-starts ")
                && line.ends_with("  Two springs (A book, Fig. 1): The starts")),
        "{listed}"
    );
    assert!(listed.contains("oscillator-work "), "{listed}");
    assert!(
        !run_line("dalembert gallery --list --quick")
            .output
            .contains("oscillator-work")
    );

    let folder = Folder::not_made("one");
    let done = gallery(&folder.0, "--picture oscillator-lissajous-density");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let files = fs::read_dir(&folder.0).unwrap().count();
    assert_eq!(files, 1);
    let svg = folder.read("oscillator-lissajous-density.svg");
    assert!(
        svg.contains("5000 positions") && svg.contains("<image x="),
        "{svg}"
    );
}

#[test]
fn what_does_not_exist_or_cannot_be_written_is_refused() {
    let refused = |line: &str| {
        let done = run_line(&format!("dalembert gallery {line}"));
        assert_eq!(done.exit, Exit::Refused, "{line}: {}", done.output);
        done.errors
    };
    let error = refused("never oscilator");
    assert!(
        error.contains("unknown model `oscilator`; did you mean `oscillator`?"),
        "{error}"
    );
    assert!(
        error.contains("accepted: bouncing_ball, oscillator, bead"),
        "{error}"
    );
    assert!(!Path::new("never").exists());
    let error = refused("never --picture oscillator-lissajous");
    assert!(error.contains("--picture: unknown picture"), "{error}");
    assert!(refused("").contains("<OUT>"));

    let folder = Folder::not_made("file");
    fs::write(&folder.0, "").unwrap();
    let error = refused(&format!("{} bead", folder.0.display()));
    assert!(error.starts_with("error: OUT "), "{error}");
    fs::remove_file(&folder.0).unwrap();
}
