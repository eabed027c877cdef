//! The tables of refused declarations in `docs/language.md`: every row gets the message of the page, with its help.

use std::path::Path;

use proc_macro2::TokenStream;

/// Head of the tables.
const HEAD: &str = "| refused | message |";
/// Parts of the declaration of every row.
const COORDINATES: &str = "coordinates { x; y; theta: angle; }";
const PARAMETERS: &str = "parameters { m > 0 = 1; k > 0 = 1; }";

/// A row: the declarations, and their message.
struct Row {
    line: usize,
    declarations: String,
    message: String,
}

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    std::fs::read_to_string(path).expect("the language reference")
}

/// The rows of all tables of refused declarations.
fn rows(page: &str) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut lines = page.lines().enumerate();
    while lines.by_ref().any(|(_, line)| line == HEAD) {
        let table = lines.by_ref().take_while(|(_, line)| line.starts_with('|'));
        rows.extend(table.skip(1).map(|(index, line)| row(index + 1, line)));
    }
    rows
}

fn row(line: usize, text: &str) -> Row {
    let cells = text
        .strip_prefix("| `")
        .and_then(|text| text.strip_suffix(" |"));
    let cells = cells.and_then(|text| text.split_once("` | "));
    let (declarations, message) = cells.unwrap_or_else(|| panic!("line {line}: not a row: {text}"));
    Row {
        line,
        declarations: declarations.replace(r"\|", "|"),
        message: message.replace("<br>", "\n").replace(r"\|", "|"),
    }
}

/// The model of a row. A row that begins with `pub` is a model whose shared declarations are written as `..`.
fn model(declarations: &str) -> String {
    let common = format!("{COORDINATES} {PARAMETERS}");
    if declarations.starts_with("pub") {
        let body = format!("{common} {}", lagrangian(""));
        return declarations.replace("..", &body);
    }
    let lagrangian = if declarations.contains("lagrangian =") || declarations.contains("field {") {
        String::new()
    } else {
        lagrangian(declarations)
    };
    format!("Page {{ {common} {lagrangian} {declarations} }}")
}

/// A Lagrangian: `m/2` times the sum of the squares of all velocities, including those of the row's own coordinates.
fn lagrangian(declarations: &str) -> String {
    let mut terms = String::from("dot(x)^2 + dot(y)^2 + dot(theta)^2");
    let section = declarations
        .split_once("coordinates {")
        .and_then(|(_, rest)| rest.split_once('}'));
    for entry in section.map_or("", |(section, _)| section).split(';') {
        let entry = entry.trim();
        let end = entry.find(|letter: char| !letter.is_alphanumeric());
        let (name, rest) = entry.split_at(end.unwrap_or(entry.len()));
        let size = rest.strip_prefix('[').and_then(|rest| rest.split_once(']'));
        match size.map(|(size, _)| size.parse::<usize>().unwrap_or(1)) {
            Some(size) => terms.push_str(&format!(
                " + sum(i in 1..={}: dot({name}[i])^2)",
                size.max(1)
            )),
            None if name.is_empty() => {}
            None => terms.push_str(&format!(" + dot({name})^2")),
        }
    }
    format!("lagrangian = m/2*({terms});")
}

/// Describes the difference between the actual message of a row and the promised one; `None` if they agree.
fn difference(row: &Row) -> Option<String> {
    let source = model(&row.declarations);
    let tokens: TokenStream = source.parse().expect("tokens");
    let actual = match dalembert_emit::try_expand(tokens) {
        Ok(_) => "nothing".to_owned(),
        Err(diagnostics) => {
            let messages: Vec<&str> = diagnostics.iter().map(|error| error.message()).collect();
            messages.join("\nand\n")
        }
    };
    (actual != row.message).then(|| {
        format!(
            "line {}: `{}` promises\n{}\nand gets\n{actual}\n",
            row.line, row.declarations, row.message
        )
    })
}

#[test]
fn every_refused_declaration_gets_the_message_of_the_page() {
    let rows = rows(&page());
    assert!(rows.len() >= 90, "{} rows", rows.len());
    let differences: Vec<String> = rows.iter().filter_map(difference).collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn the_refusal_in_the_readme_is_the_one_that_is_made() {
    let readme = include_str!("../README.md");
    let (_, rest) = readme
        .split_once("```rust,compile_fail")
        .expect("a refused model");
    let (code, rest) = rest.split_once("```").expect("its end");
    let (_, rest) = rest.split_once("```text\nerror: ").expect("its message");
    let (message, _) = rest.split_once("\n```").expect("its end");
    let (_, declaration) = code.split_once("model! {").expect("a model");
    let (declaration, _) = declaration.rsplit_once('}').expect("its end");
    let tokens: TokenStream = declaration.parse().expect("tokens");
    let refused = dalembert_emit::try_expand(tokens).expect_err("a false claim");
    let messages: Vec<&str> = refused.iter().map(|error| error.message()).collect();
    assert_eq!(messages.join("\n"), message.replace("\n       ", "\n"));
}

#[test]
fn a_wrong_row_is_noticed() {
    let table = |row: &str| format!("{HEAD}\n|---|---|\n{row}\n\nText.\n");
    let checked = |row: &str| rows(&table(row)).iter().find_map(difference);
    let right = "| `lagrangian = x/0;` | division by zero |";
    assert_eq!(checked(right), None);
    assert_eq!(rows(&table(right))[0].line, 3);
    let wrong = "| `lagrangian = x/0;` | division by one |";
    assert!(checked(wrong).is_some_and(|text| text.ends_with("and gets\ndivision by zero\n")));
    let no_help = "| `let m = 2;` | `m` declared again |";
    assert!(checked(no_help).is_some());
    let accepted = "| `let a = 2;` | `a` declared again |";
    assert!(checked(accepted).is_some_and(|text| text.ends_with("nothing\n")));
    assert!(rows("| other | table |\n|---|---|\n| `a` | b |\n").is_empty());
}
