//! Fuzz targets over bytes. No input may cause a panic, a stack overflow or an endless loop.

use std::io::Cursor;

use dalembert_cli::Streams;
use proc_macro2::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream, TokenTree};

dalembert::model! {
    /// A skate between walls, with most declarations that flags of the command line can name.
    pub Skate {
        coordinates { x; y in (-10, 10); theta: angle; }
        parameters { m > 0 = 1; I > 0 = 0.1; e in [0, 1] = 0.5; k[2] >= 0 = [1, 2]; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 - k[1]*x^2 - k[2]*y^2;
        constraints { edge: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: 2 - x >= 0 => newton(e); floor: y + 5 >= 0; }
        initial { theta = 0.2; dot(theta) = 0.1; until = 1; }
        view { path: (x, y); }
        outputs { edge_force: multiplier(edge); }
        claims { conserved: energy; }
    }
}

/// Text as a declaration.
pub fn declaration(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    if let Ok(tokens) = text.parse() {
        expand(tokens);
    }
}

/// A sequence of tokens as a declaration, one for each byte.
pub fn tokens(bytes: &[u8]) {
    let mut bytes = bytes.iter().copied();
    let body = Group::new(Delimiter::Brace, group(&mut bytes, 0));
    let name = Ident::new("Model", Span::call_site());
    expand([TokenTree::from(name), body.into()].into_iter().collect());
}

/// Bytes as the states that `eval` reads.
pub fn states(bytes: &[u8]) {
    command(&["eval", "skate"], bytes);
}

/// Text as the flags of `simulate`, one flag per line. No file is written, and no run is longer than half a unit of
/// time.
pub fn arguments(bytes: &[u8]) {
    const OURS: [&str; 6] = ["--csv", "--html", "--json", "--plot", "--until", "--impacts"];
    let text = String::from_utf8_lossy(bytes);
    let is_ours = |flag: &str| OURS.iter().any(|known| flag.starts_with(known));
    let flags = text.lines().filter(|flag| !is_ours(flag)).take(12);
    let line = ["simulate", "skate", "--until", "0.5", "--json", "-"]
        .into_iter()
        .chain(flags);
    command(&line.collect::<Vec<_>>(), &[]);
}

fn expand(tokens: TokenStream) {
    let expanded = dalembert_emit::expand(tokens);
    assert!(!expanded.is_empty(), "neither code nor an error");
}

fn command(arguments: &[&str], input: &[u8]) {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut Cursor::new(input),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let line = ["dalembert"].iter().chain(arguments);
    dalembert_cli::run_with(line, &dalembert_cli::models![Skate], &mut streams);
}

/// Tokens up to a byte that closes their group.
fn group(bytes: &mut impl Iterator<Item = u8>, depth: usize) -> TokenStream {
    const DELIMITERS: [Delimiter; 4] = [
        Delimiter::Brace,
        Delimiter::Parenthesis,
        Delimiter::Bracket,
        Delimiter::None,
    ];
    let mut stream = TokenStream::new();
    while let Some(byte) = bytes.next() {
        let token = match byte {
            0..8 if depth > 0 => break,
            // NOTE: deeper than the language allows, so that its limit is reached.
            8..24 if depth < 300 => {
                let inner = group(bytes, depth + 1);
                Group::new(DELIMITERS[usize::from(byte) % DELIMITERS.len()], inner).into()
            }
            byte => leaf(byte),
        };
        stream.extend([token]);
    }
    stream
}

fn leaf(byte: u8) -> TokenTree {
    const WORDS: [&str; 36] = [
        "coordinates",
        "parameters",
        "const",
        "let",
        "lagrangian",
        "constraints",
        "forces",
        "impacts",
        "initial",
        "view",
        "outputs",
        "claims",
        "path",
        "region",
        "x",
        "y",
        "m",
        "f",
        "N",
        "i",
        "t",
        "pi",
        "d",
        "dot",
        "sum",
        "in",
        "when",
        "sin",
        "sqrt",
        "atan2",
        "angle",
        "elastic",
        "newton",
        "energy",
        "until",
        "density",
    ];
    const NUMBERS: [&str; 8] = ["0", "1", "2", "3", "0.5", "4096", "1e300", "1e-300"];
    const MARKS: &str = "=;,:+-*/^%<>.#!&";
    let index = usize::from(byte);
    match index % 3 {
        0 => Ident::new(WORDS[index / 3 % WORDS.len()], Span::call_site()).into(),
        1 => number(NUMBERS[index / 3 % NUMBERS.len()]),
        _ => {
            let spacing = if byte < 128 {
                Spacing::Joint
            } else {
                Spacing::Alone
            };
            let mark = MARKS.as_bytes()[index / 3 % MARKS.len()];
            Punct::new(char::from(mark), spacing).into()
        }
    }
}

fn number(text: &str) -> TokenTree {
    text.parse().map_or_else(
        |_| Literal::u8_unsuffixed(0).into(),
        |literal: Literal| literal.into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudorandom bytes.
    fn noise(seed: u64, length: usize) -> Vec<u8> {
        let mut state = seed;
        let step = |_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        };
        (0..length).map(step).collect()
    }

    #[test]
    fn every_target_takes_noise() {
        for seed in 0..300 {
            let bytes = noise(seed, 5 + 3 * seed as usize);
            declaration(&bytes);
            tokens(&bytes);
            states(&bytes);
            arguments(&bytes);
        }
    }

    #[test]
    fn every_target_takes_valid_input() {
        declaration(b"P { coordinates { x; } lagrangian = dot(x)^2; }");
        states(br#"[{"q": [0, 0, 0.2], "qdot": [0.98, "0.199", 0.1], "t": 1e308}]"#);
        arguments(b"--set\nm=2\n--law\nwall=elastic");
    }
}
