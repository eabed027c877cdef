//! Broken texts. Each is loaded or refused in bounded time, without a panic. Every refusal can be printed.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::time::{Duration, Instant};

use dalembert::erased::Erased;
use dalembert::{Instance, System};

/// Time limit for a text, generous enough for a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// Models of several kinds, none of which takes long: impacts, constraints, modes, resets, fields.
const MODELS: [&str; 8] = [
    "bouncing_ball",
    "point_billiard",
    "filippov_field",
    "refracted_particle",
    "rimless_wheel_five",
    "holonomic_bead_on_ellipses",
    "spring_mass_walker",
    "rolling_disk",
];

/// Words and marks that a declaration may have, and some that it may not.
const PIECES: [&str; 40] = [
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    ";",
    ":",
    ",",
    "=",
    "=>",
    ">=",
    "<=",
    "*",
    "/",
    "^",
    "-",
    "+",
    "%",
    ".",
    "0",
    "1e308",
    "1e-308",
    "99999999999999999999",
    "1/0",
    "sin",
    "asinh",
    "dot",
    "d",
    "t",
    "pi",
    "claims",
    "impacts",
    "when",
    "angle",
    "sum(i in 0..4096, x)",
    "//",
    "\"",
    "'",
    "\u{0301}\u{1f3b1}",
];

struct Draws(u64);

impl Draws {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % bound.max(1)
    }
}

/// Positions at which words and marks of a text begin and end.
fn pieces(text: &str) -> Vec<(usize, usize)> {
    let mut pieces: Vec<(usize, usize)> = Vec::new();
    let mut is_in_word = false;
    for (at, character) in text.char_indices() {
        let end = at + character.len_utf8();
        let is_word = character.is_alphanumeric() || character == '_';
        match pieces.last_mut() {
            Some(last) if is_word && is_in_word => last.1 = end,
            _ if character.is_whitespace() => {}
            _ => pieces.push((at, end)),
        }
        is_in_word = is_word;
    }
    pieces
}

/// A text with a few of its words and marks taken out, doubled, exchanged or replaced; now and then cut off.
fn broken(text: &str, draws: &mut Draws) -> String {
    let mut text = text.to_owned();
    for _ in 0..=draws.below(4) {
        let places = pieces(&text);
        if places.is_empty() {
            return text;
        }
        let (start, end) = places[draws.below(places.len())];
        let (other_start, other_end) = places[draws.below(places.len())];
        let other = text[other_start..other_end].to_owned();
        let piece = PIECES[draws.below(PIECES.len())];
        match draws.below(24) {
            0..5 => text.replace_range(start..end, ""),
            5..10 => text.replace_range(start..end, &format!(" {other} ")),
            10..17 => text.replace_range(start..end, &format!(" {piece} ")),
            17..20 => text.insert_str(start, &format!(" {piece} ")),
            20..22 => text.insert_str(start, &format!("{} ", text[start..end].to_owned())),
            22 => text.insert_str(start, &"(".repeat(1 + draws.below(600))),
            _ => text.truncate(start),
        }
    }
    text
}

fn load_broken_texts(count: usize, seed: u64) {
    let texts = MODELS.map(|name| fs::read_to_string(format!("../models/src/{name}.dal")).unwrap());
    let mut draws = Draws(seed);
    let mut refused = 0;
    for round in 0..count {
        let text = broken(&texts[round % texts.len()], &mut draws);
        let begun = Instant::now();
        match dalembert_jit::load("broken.dal", &text) {
            Ok(models) => models.iter().for_each(|model| begin(&model.form)),
            Err(mistakes) => {
                refused += 1;
                let shown = mistakes.to_string();
                assert!(shown.contains("broken.dal:"), "no place: {shown}\n{text}");
                assert!(!mistakes.mistakes().is_empty(), "no mistake:\n{text}");
            }
        }
        let taken = begun.elapsed();
        assert!(taken < PATIENCE, "{taken:?} for\n{text}");
    }
    assert!(
        refused > count / 2 && refused < count,
        "{refused} of {count} refused"
    );
}

/// Evaluates the declared start of a loaded model. The start may be refused.
fn begin(form: &dalembert::erased::Form) {
    let Ok(system) = Erased::<32>::of(form) else {
        return;
    };
    let start = system.initial();
    if let Ok(state) = system.state(0.0, &start.q, &start.qdot) {
        let _ = system.energy(0.0, &state);
    }
}

#[test]
fn broken_texts_are_refused_or_loaded() {
    load_broken_texts(400, 0x9e37_79b9_7f4a_7c15);
}

#[test]
#[ignore = "nightly: 100 000 texts"]
fn a_hundred_thousand_broken_texts_are_refused_or_loaded() {
    let now = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap();
    let seed = now.as_nanos() as u64 | 1;
    println!("seed {seed}");
    load_broken_texts(100_000, seed);
}
