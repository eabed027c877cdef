//! Fenced blocks of a page.

/// A fenced block: the words after the ticks, the text, and the line of the fence.
pub struct Fence<'a> {
    pub line: usize,
    pub words: Vec<&'a str>,
    pub text: &'a str,
}

/// The fenced blocks of a page that have a language, in order.
pub fn of(page: &str) -> impl Iterator<Item = Fence<'_>> {
    let mut rest = page;
    let mut line = 1;
    std::iter::from_fn(move || {
        loop {
            let (head, after) = rest.split_once('\n')?;
            rest = after;
            let opening = line;
            line += 1;
            let Some(info) = head.strip_prefix("```") else {
                continue;
            };
            let end = if rest.starts_with("```") {
                0
            } else {
                rest.find("\n```")? + 1
            };
            let (text, closing) = rest.split_at(end);
            line += text.lines().count() + 1;
            rest = closing.split_once('\n').map_or("", |(_, after)| after);
            let words: Vec<&str> = info.split_whitespace().collect();
            if !words.is_empty() {
                return Some(Fence {
                    line: opening,
                    words,
                    text,
                });
            }
        }
    })
}
