//! The book under `docs/` and the README: commands run and print the shown text, models load, and the stored pictures
//! are those that the commands draw.
//!
//! Blocks of the pages that are tested:
//!
//! | fence | meaning |
//! |---|---|
//! | `` ```dal `` | a declaration that loads |
//! | `` ```dal NAME.dal `` | the same, saved under this name for the commands below |
//! | `` ```dal NAME.dal refused `` | a declaration that is refused |
//! | `` ```console `` | commands after `$ `, each with its output; a line `..` stands for any lines, ` ..` at the end of a line for its rest |
//! | `` ```console fails `` | the same with an exit status other than 0 |
//! | `` ```sh `` | lines that begin with `cargo run --release -- ` are run, except for the gallery, which `tests/gallery.rs` draws |
//!
//! `ACCEPT=1` stores pictures and the page of the command line anew.

mod examples;
mod fences;
mod output;
mod pages;
mod prose;
mod reference;
mod session;

use fences::Fence;
use session::Session;

/// Runs the blocks of a page from top to bottom, and returns the mistakes.
fn mistakes(page: &str, text: &str) -> Vec<String> {
    let mut session = Session::begin(&page.replace('/', "-"));
    let mut found = Vec::new();
    for fence in fences::of(text) {
        if let Err(mistake) = tried(&mut session, &fence) {
            found.push(format!("docs/{page}:{}: {mistake}", fence.line));
        }
    }
    for (line, picture) in pages::pictures(text) {
        if let Err(mistake) = session.compare_picture(&pages::target(page, picture)) {
            found.push(format!("docs/{page}:{line}: {mistake}"));
        }
    }
    found
}

fn tried(session: &mut Session, fence: &Fence<'_>) -> Result<(), String> {
    match fence.words[..] {
        ["dal"] => session.load("block.dal", fence.text, true),
        ["dal", name] => session.load(name, fence.text, true),
        ["dal", name, "refused"] => session.load(name, fence.text, false),
        ["console"] => session.commands(fence.text, true),
        ["console", "fails"] => session.commands(fence.text, false),
        ["console" | "dal", ..] => Err(format!("unknown words after ```: {:?}", fence.words)),
        ["sh"] => session.cargo_commands(fence.text),
        _ => Ok(()),
    }
}

#[test]
fn every_block_of_the_book_does_what_the_page_says() {
    let mut found = Vec::new();
    let mut commands = 0;
    for page in pages::all().into_iter().chain(["../README.md".to_owned()]) {
        let text = pages::text(&page);
        let consoles = fences::of(&text).filter(|fence| fence.words[0] == "console");
        commands += consoles
            .map(|fence| session::split(fence.text).len())
            .sum::<usize>();
        found.extend(mistakes(&page, &text));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(commands >= 40, "{commands} commands");
}

#[test]
fn a_page_that_is_wrong_is_noticed() {
    let wrong = [
        ("```dal\nBall { coordinates { x; } }\n```\n", "1: "),
        (
            "```dal a.dal refused\nBall { coordinates { x; } lagrangian = dot(x)^2; }\n```\n",
            "is loaded",
        ),
        (
            "\n```console\n$ dalembert list\nno model\n```\n",
            "2: `dalembert list`: expected `no model`",
        ),
        (
            "```console\n$ dalembert simulate nothing\n```\n",
            "exit status 2",
        ),
        ("```console fails\n$ dalembert list\n```\n", "exit status 0"),
        (
            "```console\n$ dalembert list\n..\n```\n![a](x.svg)\n",
            "5: ",
        ),
    ];
    for (text, expected) in wrong {
        let found = mistakes("wrong.md", text).join("\n");
        assert!(found.contains(expected), "{text}\n{found}");
    }
    let right = "```console\n$ dalembert --version\ndalembert-cli ..\n$ dalembert list\n..\n```\n";
    assert_eq!(mistakes("right.md", right), Vec::<String>::new());
}
