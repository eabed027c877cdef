//! Comparison of a printed text with the text that a page shows.

/// Largest relative difference of two numbers that count as the same, because further digits depend on the machine.
const RELATIVE: f64 = 1e-6;
/// Two numbers whose absolute values are below this are rounding errors, and count as the same.
const ROUNDING: f64 = 1e-8;

/// Compares an output with the text of a page, in which a line `..` stands for any lines.
///
/// # Errors
/// The first expected line that the output lacks, with the output; or a line that the page does not show.
pub fn compare(expected: &str, actual: &str) -> Result<(), String> {
    let mut lines = actual.lines().map(str::trim_end);
    let mut skipping = false;
    for wanted in expected.lines().map(str::trim_end) {
        if wanted.trim_start() == ".." {
            skipping = true;
            continue;
        }
        let found = if skipping {
            lines.find(|line| same_line(wanted, line))
        } else {
            lines.next().filter(|line| same_line(wanted, line))
        };
        if found.is_none() {
            return Err(format!("expected `{wanted}` in\n{actual}"));
        }
        skipping = false;
    }
    match lines.next() {
        Some(line) if !skipping => Err(format!("the page does not show `{line}`")),
        _ => Ok(()),
    }
}

/// True if a line is the expected one, up to the last digits of its numbers.
pub fn same_line(wanted: &str, line: &str) -> bool {
    let (wanted, open) = match wanted.strip_suffix(" ..") {
        Some(start) => (start, true),
        None => (wanted, false),
    };
    let (mut left, mut right) = (pieces(wanted), pieces(line));
    loop {
        match (left.next(), right.next()) {
            (None, None) => return true,
            (None, Some(_)) => return open,
            (Some(a), Some(b)) if same_piece(a, b) => {}
            _ => return false,
        }
    }
}

fn same_piece(a: &str, b: &str) -> bool {
    if a == b {
        return true;
    }
    let whole = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else {
        return false;
    };
    let near = (x - y).abs() <= RELATIVE * x.abs().max(y.abs());
    let small = x.abs().max(y.abs()) < ROUNDING;
    !(whole(a) && whole(b)) && (near || small)
}

/// Words, numbers and signs of a line, without the spaces between them.
fn pieces(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        rest = rest.trim_start();
        let end = end_of_piece(rest)?;
        let (piece, after) = rest.split_at(end);
        rest = after;
        Some(piece)
    })
}

fn end_of_piece(text: &str) -> Option<usize> {
    let first = text.chars().next()?;
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let end = if first.is_ascii_digit()
        || (first == '-' && text[1..].starts_with(|c: char| c.is_ascii_digit()))
    {
        end_of_number(text)
    } else if word(first) {
        text.find(|c| !word(c)).unwrap_or(text.len())
    } else {
        first.len_utf8()
    };
    Some(end)
}

/// The end of a decimal number, its exponent included.
fn end_of_number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let count = bytes[from..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit());
        from + count.count()
    };
    let mut end = digits(1);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
        end = digits(end + 1);
    }
    if bytes.get(end) == Some(&b'e') {
        let sign = usize::from(bytes.get(end + 1) == Some(&b'-'));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

#[test]
fn lines_are_compared_up_to_the_last_digits_of_numbers() {
    for (wanted, line) in [
        ("energy  4.0824004665 J", "energy 4.0824004661 J"),
        ("change -5.3e-10, done", "change -1.2e-13, done"),
        ("impacts 20 ..", "impacts 20 (leading_edge 10)"),
        ("x1 = [1, 2]", "x1 = [1, 2]"),
    ] {
        assert!(same_line(wanted, line), "{wanted} {line}");
    }
    for (wanted, line) in [
        ("impacts 20", "impacts 21"),
        ("impacts 20", "impacts 20 (wall)"),
        ("energy 4.0824", "energy 4.0825"),
        ("energy 4.08", "energy -4.08"),
        ("done", "zeno"),
    ] {
        assert!(!same_line(wanted, line), "{wanted} {line}");
    }
}

#[test]
fn lines_may_be_left_out_where_the_page_says_so() {
    let text = "a\nb\nc\n";
    for page in ["a\nb\nc", "..\nc", "a\n..", "a\n..\nc", ".."] {
        assert_eq!(compare(page, text), Ok(()), "{page}");
    }
    for page in ["a", "a\nc", "b\n..", "..\nb", "..\nd\n.."] {
        assert!(compare(page, text).is_err(), "{page}");
    }
}
