//! The prose of the book has short sentences and none of the listed phrases.

use crate::pages;

/// Phrases that are odd in English, or that avoid a noun.
const ODD: [&str; 15] = [
    " are had ",
    " is had ",
    " be had ",
    " told of ",
    " said of ",
    " that there are not",
    " that there is none",
    " what there is",
    " what it is",
    " what they are",
    " whichever",
    " nobody",
    " to be said",
    " tells of ",
    " one likes",
];
/// Beginnings of a sentence that hide its subject.
const OPENINGS: [&str; 4] = ["What ", "Whether ", "How ", "Of "];
/// Largest number of words in a sentence.
const LONGEST: usize = 36;

/// Beginnings of the paths of the pages that are examined.
const BOOK: [&str; 12] = [
    "introduction",
    "start",
    "tutorial/",
    "guide/",
    "theory/",
    "glossary",
    "cases",
    "conventions",
    "ensembles",
    "testing",
    "reference/json",
    "reference/messages",
];

/// The sentences of a page, without blocks of code. An item of a list, a cell of a table and a colon end a sentence.
fn sentences(page: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    let page = format!("\n{page}");
    for line in page.split("\n```").step_by(2).flat_map(str::lines) {
        let begins = line.trim().is_empty() || line.starts_with(['|', '-', '#', '$', '!']);
        if begins {
            paragraphs.push(String::new());
        }
        if let Some(last) = paragraphs.last_mut() {
            last.push_str(line.trim().trim_start_matches("- "));
            last.push(' ');
        }
    }
    let parts = paragraphs.iter().flat_map(|text| text.split('|'));
    let parts = parts.flat_map(|text| text.split(". ").flat_map(|text| text.split(": ")));
    parts.map(|text| text.trim().to_owned()).collect()
}

/// Number of words of a sentence; code and formulas count as one word each.
fn length(sentence: &str) -> usize {
    let mut words = 0;
    for (index, part) in sentence.split(['`', '$']).enumerate() {
        words += if index % 2 == 0 {
            part.split_whitespace().count()
        } else {
            1
        };
    }
    words
}

/// Mistakes on a page, one sentence each.
fn mistakes(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    for sentence in sentences(page) {
        let lower = format!(" {} ", sentence.to_lowercase());
        if let Some(odd) = ODD.iter().find(|odd| lower.contains(*odd)) {
            found.push(format!("`{}` in: {sentence}", odd.trim()));
        }
        if let Some(opening) = OPENINGS.iter().find(|start| sentence.starts_with(*start))
            && !sentence.ends_with('?')
        {
            found.push(format!("begins with `{}`: {sentence}", opening.trim()));
        }
        if length(&sentence) > LONGEST {
            found.push(format!("{} words: {sentence}", length(&sentence)));
        }
    }
    found
}

#[test]
fn sentences_of_the_book_are_short_and_plain() {
    let all = pages::all();
    let written = all
        .iter()
        .filter(|page| BOOK.iter().any(|start| page.starts_with(start)));
    let mut found = Vec::new();
    for page in written {
        let wrong = mistakes(&pages::text(page));
        found.extend(
            wrong
                .iter()
                .map(|mistake| format!("docs/{page}: {mistake}")),
        );
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn odd_prose_is_noticed() {
    let long = "word ".repeat(LONGEST + 1);
    for wrong in [
        "Digits are had from it.",
        "A list:\n\n- Whether it holds.",
        "| a | What it does |\n",
        long.as_str(),
    ] {
        assert_eq!(mistakes(wrong).len(), 1, "{wrong}");
    }
    for right in [
        "Digits come from it. Does it hold?",
        "```text\nWhat it is\n```\nText.",
        "`a b c d` is $x + y + z$.",
    ] {
        assert_eq!(mistakes(right), Vec::<String>::new(), "{right}");
    }
}
