//! Merged shards give the files of one run, to the byte. Messages name shards that do not fit.

use super::*;

const COUNTED: &str = "--density x_dot=-3..3,x=0..4:8 --every 0.25";

/// Runs the shards of an ensemble, and returns the paths of their files, last shard first.
fn shards(folder: &Folder, line: &str, of: u64) -> Vec<String> {
    let paths = (1..=of).rev().map(|shard| {
        let path = folder.path(&format!("part{shard}.csv"));
        let done = run(&format!("{line} --shard {shard}/{of} --csv {path}"));
        assert_ne!(done.exit, Exit::Refused, "{}", done.errors);
        path
    });
    paths.collect()
}

#[test]
fn shards_merge_to_the_files_of_the_whole() {
    let folder = Folder::new("merge");
    for more in ["", COUNTED] {
        let line = format!("{BALLS} {more}");
        let whole = run(&format!(
            "{line} --csv {} --json -",
            folder.path("whole.csv")
        ));
        for of in [1, 3, 7] {
            let parts = shards(&folder, &line, of).join(" ");
            let merged = run(&format!(
                "{line} --merge {parts} --csv {} --json -",
                folder.path("all.csv")
            ));
            assert_eq!(merged.exit, whole.exit, "{}", merged.errors);
            assert_eq!(merged.output, whole.output, "{of} shards");
            for ending in ["", ".meta.json", ".sums"] {
                let [one, other] =
                    ["whole", "all"].map(|name| folder.read(&format!("{name}.csv{ending}")));
                assert_eq!(one, other, "{of} shards, {ending}");
            }
            if !more.is_empty() {
                let [one, other] = ["whole", "all"]
                    .map(|name| fs::read(folder.0.join(format!("{name}.csv.counts"))).unwrap());
                assert_eq!(one, other, "{of} shards");
            }
        }
    }
}

/// The message of a merge that is refused.
fn refused(line: &str, parts: &[&String]) -> String {
    let parts: Vec<&str> = parts.iter().map(|part| part.as_str()).collect();
    let done = run(&format!("{line} --merge {}", parts.join(" ")));
    assert_eq!(done.exit, Exit::Refused, "{}", done.output);
    done.errors
}

#[test]
fn shards_that_are_not_the_whole_are_refused() {
    let folder = Folder::new("unmerged");
    let line = format!("{BALLS} {COUNTED}");
    let parts = shards(&folder, &line, 3);
    let [last, middle, first] = [&parts[0], &parts[1], &parts[2]];
    let told = |parts: &[&String], words: &[&str]| {
        let message = refused(&line, parts);
        for word in words {
            assert!(message.contains(word), "{word}: {message}");
        }
    };
    told(
        &[first, last],
        &["--merge", "part3.csv", "members 42 to 83"],
    );
    told(&[first, middle], &["part2.csv", "members 84 to 125"]);
    told(
        &[first, middle, middle, last],
        &["members 42 to 83", "once"],
    );
    let other = line.replace("--until 6", "--until 7");
    let message = refused(&other, &[first, middle, last]);
    assert!(
        message.contains("`until` was 6.0 and is 7.0; give --until 6.0"),
        "{message}"
    );
    let output = run(&format!("{line} --merge {first} --csv {first}"));
    assert!(
        output.errors.contains("cannot be an output"),
        "{}",
        output.errors
    );
    let absent = folder.path("absent.csv");
    told(&[first, &absent, last], &["absent.csv.meta.json"]);

    let rows = folder.read("part2.csv");
    fs::write(folder.0.join("part2.csv"), rows.replacen("done", "gone", 1)).unwrap();
    told(
        &[first, middle, last],
        &["part2.csv, line", "altered", "run the shard again"],
    );
    let cut = rows.trim_end().rfind('\n').unwrap() + 1;
    fs::write(folder.0.join("part2.csv"), &rows[..cut]).unwrap();
    told(&[first, middle, last], &["holds 41 rows and counts of 42"]);
    fs::remove_file(folder.0.join("part2.csv.sums")).unwrap();
    told(&[first, middle, last], &["part2.csv.sums", "missing"]);
}

#[test]
fn a_shard_that_is_not_finished_is_named() {
    let folder = Folder::new("unfinished");
    let parts = shards(&folder, BALLS, 2);
    let rows = folder.read("part1.csv");
    let cut = rows.trim_end().rfind('\n').unwrap() + 1;
    fs::write(folder.0.join("part1.csv"), &rows[..cut]).unwrap();
    let message = refused(BALLS, &[&parts[0], &parts[1]]);
    for part in ["part1.csv", "62 of the 63 members", "--shard 1/2 --resume"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn statistics_are_those_of_the_rows() {
    let table = rows(BALLS);
    let outcomes = column(&table, "outcome");
    assert!(outcomes.iter().any(|outcome| outcome == "starts_inside"));
    let energies = numbers_of(&table, "energy").into_iter().zip(outcomes);
    let finite: Vec<f64> = energies
        .filter(|(energy, outcome)| energy.is_finite() && outcome != "starts_inside")
        .map(|(energy, _)| energy)
        .collect();
    let document = run(&format!("{BALLS} --json -")).json();
    let told = &document["statistics"]["energy"];
    let number = |key: &str| told[key].as_f64().unwrap();
    let count = finite.len() as f64;
    assert_eq!(number("count"), count);
    let mean = finite.iter().sum::<f64>() / count;
    let squares: f64 = finite.iter().map(|it| (it - mean).powi(2)).sum();
    let deviation = (squares / (count - 1.0)).sqrt();
    for (key, value) in [("mean", mean), ("std", deviation)] {
        assert!((number(key) / value - 1.0).abs() < 1e-13, "{key}: {told}");
    }
    let extremes = [f64::min, f64::max].map(|of| finite.iter().copied().reduce(of));
    assert_eq!([Some(number("least")), Some(number("greatest"))], extremes);

    let text = run(BALLS).output;
    let row = text
        .lines()
        .find(|line| line.starts_with("  energy   ") && line.ends_with(" 112"));
    let shown = row.unwrap_or_else(|| panic!("{text}")).split_whitespace();
    let shown: Vec<f64> = shown.skip(1).map(|word| word.parse().unwrap()).collect();
    assert!((shown[0] / mean - 1.0).abs() < 1e-8, "{text}");
    assert!((shown[1] / deviation - 1.0).abs() < 1e-8, "{text}");
}

/// The files of a finished ensemble, with their content.
fn files(folder: &Folder, name: &str) -> Vec<(String, Option<Vec<u8>>)> {
    let endings = ["", ".meta.json", ".sums", ".counts"].iter();
    let named = endings.map(|ending| format!("{name}{ending}"));
    let read = |name: String| {
        let content = fs::read(folder.0.join(&name)).ok();
        (name, content)
    };
    named.map(read).collect()
}

/// The names of all files of a folder.
fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(&folder.0).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_refused_merge_changes_no_file() {
    let folder = Folder::new("untouched");
    let line = format!("{BALLS} {COUNTED}");
    let parts = shards(&folder, &line, 2);
    let (both, one) = (parts.join(" "), &parts[1]);
    let whole = run(&format!("{line} --csv {}", folder.path("all.csv")));
    assert_ne!(whole.exit, Exit::Refused, "{}", whole.errors);
    let (before, listed) = (files(&folder, "all.csv"), names(&folder));
    assert!(before.iter().all(|(_, content)| content.is_some()));
    let assert_untouched = |line: &str, part: &str| {
        for name in ["all.csv", "fresh.csv"] {
            let done = run(&format!("{line} --csv {}", folder.path(name)));
            assert_eq!(done.exit, Exit::Refused, "{line}");
            assert!(done.errors.contains(part), "{}", done.errors);
            assert!(files(&folder, "all.csv") == before, "changed by {line}");
            assert_eq!(names(&folder), listed, "{line}");
        }
    };
    assert_untouched(&format!("{line} --merge {one}"), "members 63 to 125");
    let flags = "give --density x_dot=-3.0..3.0,x=0.0..4.0:8x8 --every 0.25 --discard 0.0";
    assert_untouched(&format!("{BALLS} --merge {both}"), flags);

    // A row that was altered is found when it is read.
    let rows = folder.read("part2.csv");
    fs::write(folder.0.join("part2.csv"), rows.replacen("done", "gone", 1)).unwrap();
    assert_untouched(&format!("{line} --merge {both}"), "altered");
    fs::write(folder.0.join("part2.csv"), rows).unwrap();

    let done = run(&format!(
        "{line} --merge {both} --csv {}",
        folder.path("all.csv")
    ));
    assert_eq!(done.exit, whole.exit, "{}", done.errors);
    let ran = "members per second";
    assert!(
        whole.output.contains(ran) && !done.output.contains(ran),
        "{}",
        done.output
    );
    assert!(
        files(&folder, "all.csv") == before,
        "the merge is the whole"
    );
    assert_eq!(names(&folder), listed);
}
