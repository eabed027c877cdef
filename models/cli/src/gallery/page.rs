//! A gallery as one self-contained page with embedded pictures and without scripts, for light and dark mode.

use std::fmt::Write as _;

use super::mathematics::typeset;
use super::standard::MOTIONS;
use super::{Effort, Figure, Plate, Print};
use crate::entry::Entry;
use crate::error::CliError;
use crate::names;
use crate::plot::style;

const STYLE: &str = "\
:root{color-scheme:light dark;--paper:#fff;--ink:#323232;--faint:#696969;--line:#e2e5e9;--code:#f5f6f8;--link:#0072b2}
body{font:15px/1.5 sans-serif;background:var(--paper);color:var(--ink);max-width:1540px;margin:0 auto;padding:1.5em 1.2em 4em}
h1{font-size:1.7em;margin:.2em 0}h2{font-size:1.35em;margin:2.4em 0 0;padding-top:.5em;border-top:1px solid var(--line)}
h3{font-size:1.05em;margin:0}p{margin:.3em 0;max-width:75em}a{color:var(--link)}
nav ul{columns:21em;padding-left:1.2em}nav ul ul{columns:auto}nav li{break-inside:avoid}
figure{margin:1.6em 0 2.2em}figcaption{margin-bottom:.7em}.source{color:var(--faint)}
.panels{display:grid;align-items:stretch;grid-template-columns:repeat(auto-fill,minmax(min(100%,430px),1fr));gap:1.4em 1.2em}
.one{grid-template-columns:minmax(0,760px)}.fours{grid-template-columns:repeat(auto-fill,minmax(min(100%,340px),1fr))}
.panel{min-width:0;display:grid;grid-row:span 3;grid-template-rows:subgrid;align-items:end;gap:.3em}
.small .panels{grid-template-columns:repeat(auto-fill,minmax(min(100%,260px),1fr))}.small figure{margin:1em 0}
.highlights{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,400px),1fr));gap:1em;margin:1.2em 0 1.6em}
.highlights a{display:flex;flex-direction:column;justify-content:flex-end;color:var(--ink);text-decoration:none;text-align:center;
border:1px solid var(--line);border-radius:6px;padding:.5em}.highlights a:hover{border-color:var(--link)}
.highlights svg{display:block;width:100%;height:auto;max-height:420px;margin:auto}
.panel svg{display:block;width:100%;max-width:900px;height:auto}
.panel p{font-size:.9em}.error{color:#d55e00}
code{font:.88em monospace}.panel code{display:block;align-self:start;line-height:1.45;background:var(--code);border-radius:4px;padding:.4em .7em}
.panel code span{display:inline-block}
";

/// The page of these pictures.
pub fn page(models: &[Entry], plates: &[Plate<'_>], prints: &[Result<Print, CliError>]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\"><head><meta charset=\"utf-8\" />\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\
         <title>dalembert gallery</title>\n<style>\n{STYLE}{}</style></head>\n<body>\n",
        dark()
    );
    let drawn: Vec<_> = plates.iter().zip(prints).collect();
    let chapters = chapters(&drawn);
    page += "<h1>Gallery</h1>\n<p>Mechanical systems with constraints and impacts, declared with <b>dalembert</b>. \
             Each picture is followed by the command that draws it alone.";
    if plates.iter().any(|plate| plate.effort == Effort::Quick) {
        page += " A quick gallery: densities use a fiftieth of the positions, and measured times are left out.";
    }
    page += "</p>\n";
    page += &highlights(&chapters);
    page += &contents(&chapters);
    page += &animations(&drawn);
    for (number, (chapter, figures)) in chapters.iter().enumerate() {
        let _ = write!(
            page,
            "<section id=\"chapter-{number}\"{}>\n<h2>{}</h2>\n",
            match *chapter {
                MOTIONS => " class=\"small\"",
                _ => "",
            },
            escaped(chapter)
        );
        for drawn in figures {
            page += &figure(models, drawn);
        }
        page += "</section>\n";
    }
    page += "</body></html>\n";
    page
}

/// A picture of a figure, with its drawing or the error.
type Drawn<'a> = (&'a Plate<'a>, &'a Result<Print, CliError>);

/// Chapters in the order of their first figures. Each has its figures in order, and each figure has its pictures.
type Chapters<'a> = Vec<(&'a str, Vec<&'a [Drawn<'a>]>)>;

fn chapters<'a>(drawn: &'a [Drawn<'a>]) -> Chapters<'a> {
    let same = |a: &Drawn<'_>, b: &Drawn<'_>| std::ptr::eq(a.0.figure, b.0.figure);
    let mut chapters = Chapters::new();
    for figure in drawn.chunk_by(same) {
        let chapter = figure[0].0.figure.chapter;
        match chapters.iter_mut().find(|(name, _)| *name == chapter) {
            Some((_, figures)) => figures.push(figure),
            None => chapters.push((chapter, vec![figure])),
        }
    }
    chapters
}

/// The first row: one picture of each figure that has a highlight, with a link to the figure.
fn highlights(chapters: &Chapters<'_>) -> String {
    let mut row = String::new();
    for drawn in chapters.iter().flat_map(|(_, figures)| figures) {
        let figure = drawn[0].0.figure;
        let chosen = figure.highlight.and_then(|panel| figure.panels.get(panel));
        let print = chosen.and_then(|panel| {
            let mut drawn = drawn.iter();
            drawn.find(|(plate, _)| std::ptr::eq(plate.panel, panel))
        });
        if let Some((_, Ok(print))) = print {
            let _ = writeln!(
                row,
                "<a href=\"#{}\">{}<span>{}</span></a>",
                anchor(drawn),
                labelled(&print.svg, figure.title),
                escaped(figure.title)
            );
        }
    }
    match row.is_empty() {
        true => row,
        false => format!("<div class=\"highlights\">\n{row}</div>\n"),
    }
}

fn contents(chapters: &Chapters<'_>) -> String {
    let mut list = "<nav><ul>\n".to_owned();
    for (number, (chapter, figures)) in chapters.iter().enumerate() {
        let _ = write!(
            list,
            "<li><a href=\"#chapter-{number}\">{}</a><ul>",
            escaped(chapter)
        );
        for drawn in figures {
            let Figure {
                model,
                title,
                source,
                ..
            } = drawn[0].0.figure;
            let title = match *chapter {
                MOTIONS => model,
                _ => title,
            };
            let source = source.map_or(String::new(), |source| format!(" ({})", escaped(source)));
            let _ = write!(
                list,
                "<li><a href=\"#{}\">{}</a>{source}</li>",
                anchor(drawn),
                escaped(title)
            );
        }
        list += "</ul></li>\n";
    }
    list + "</ul></nav>\n"
}

/// The index of the animations; empty if there are none.
fn animations(drawn: &[Drawn<'_>]) -> String {
    let has_animation =
        |(_, print): &&Drawn<'_>| matches!(print, Ok(print) if print.animation.is_some());
    let mut list = String::new();
    for (plate, _) in drawn.iter().filter(has_animation) {
        let _ = write!(
            list,
            "<li><a href=\"{}\">{}: {}</a></li>",
            plate.animation_file(),
            escaped(plate.figure.title),
            escaped(&plate.panel.title)
        );
    }
    match list.is_empty() {
        true => list,
        false => format!("<nav id=\"animations\"><h2>Animations</h2><ul>{list}</ul></nav>\n"),
    }
}

fn anchor(drawn: &[Drawn<'_>]) -> String {
    let Figure { model, name, .. } = drawn[0].0.figure;
    format!("{model}-{name}")
}

fn figure(models: &[Entry], drawn: &[Drawn<'_>]) -> String {
    let figure = drawn[0].0.figure;
    let source = figure.source.map_or(String::new(), |source| {
        format!(
            " <span class=\"source\">Source: {}.</span>",
            escaped(source)
        )
    });
    let (title, caption) = match figure.chapter {
        MOTIONS => {
            let entry = models.iter().find(|entry| entry.name() == figure.model);
            let summary = entry.map_or("", |entry| names::summary(entry.description()));
            (figure.model, documented(summary))
        }
        _ => (figure.title, typeset(&figure.caption)),
    };
    let mut text = format!(
        "<figure id=\"{}\"><figcaption><h3>{}</h3><p>{caption}{source}</p></figcaption>\n<div class=\"panels{}\">\n",
        anchor(drawn),
        escaped(title),
        match drawn.len() {
            1 => " one",
            count if count % 4 == 0 => " fours",
            _ => "",
        }
    );
    for (plate, print) in drawn {
        text += &panel(plate, print);
    }
    text + "</div></figure>\n"
}

fn panel(plate: &Plate<'_>, print: &Result<Print, CliError>) -> String {
    let picture = match print {
        Ok(print) => labelled(&print.svg, &plate.panel.title),
        Err(error) => format!("<p class=\"error\">{}</p>\n", escaped(&error.to_string())),
    };
    let play = match print {
        Ok(print) if print.animation.is_some() => {
            format!(" <a href=\"{}\">Play</a>", plate.animation_file())
        }
        _ => String::new(),
    };
    format!(
        "<div class=\"panel\">{picture}<p>{}{play}</p><code>{}</code></div>\n",
        escaped(&plate.panel.title),
        words(&plate.command())
    )
}

/// A picture with a text for screen readers.
fn labelled(svg: &str, text: &str) -> String {
    let label = format!(
        "<svg role=\"img\" aria-label=\"{}\" ",
        escaped(text).replace('"', "&quot;")
    );
    svg.replacen("<svg ", &label, 1)
}

/// Style rules for dark mode: colours of the page and of the pictures.
fn dark() -> String {
    let mut rules = "@media (prefers-color-scheme:dark){\n\
        :root{--paper:#16181b;--ink:#dcdde0;--faint:#9b9fa6;--line:#33373d;--code:#202327;--link:#6cb8ea}\n"
        .to_owned();
    // Style rules of a page override attributes of an SVG.
    for (light, dark) in style::DARK {
        let (light, dark) = (style::hex(light), style::hex(dark));
        let _ = writeln!(
            rules,
            "svg [fill=\"{light}\"]{{fill:{dark}}}svg [stroke=\"{light}\"]{{stroke:{dark}}}"
        );
    }
    rules + "}\n"
}

/// A command that breaks between flags only, not between a flag and its value or at hyphens.
fn words(command: &str) -> String {
    let mut groups: Vec<String> = Vec::new();
    for word in command.split(' ') {
        match groups.last_mut() {
            Some(flag)
                if flag.starts_with("--") && !flag.contains(' ') && !word.starts_with("--") =>
            {
                *flag = format!("{flag} {word}");
            }
            _ => groups.push(word.to_owned()),
        }
    }
    let groups = groups
        .iter()
        .map(|group| format!("<span>{}</span>", escaped(group)));
    groups.collect::<Vec<_>>().join(" ")
}

/// Typesets the text of a documentation comment: backticks enclose code.
fn documented(text: &str) -> String {
    let mut parts = text.split('`').map(escaped);
    let mut page = parts.next().unwrap_or_default();
    while let (Some(code), rest) = (parts.next(), parts.next()) {
        let _ = write!(page, "<code>{code}</code>{}", rest.unwrap_or_default());
    }
    page
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_stay_with_their_values() {
        assert_eq!(
            words("dalembert gallery . --quick --picture a<b"),
            "<span>dalembert</span> <span>gallery</span> <span>.</span> <span>--quick</span> \
             <span>--picture a&lt;b</span>"
        );
    }

    #[test]
    fn backticks_are_code() {
        assert_eq!(
            documented("the `rate`, a < b"),
            "the <code>rate</code>, a &lt; b"
        );
        assert_eq!(documented("`a` `b`"), "<code>a</code> <code>b</code>");
        assert_eq!(documented(""), "");
    }

    #[test]
    fn every_colour_of_a_picture_has_one_for_dark_pages() {
        let rules = dark();
        for colour in [style::INK, style::GRID, style::REGION, style::PATH] {
            let light = style::hex(colour);
            assert!(
                rules.contains(&format!("svg [fill=\"{light}\"]")),
                "{light}"
            );
        }
    }
}
