//! The declarations of the language: one file per section.

mod claims;
mod constraints;
mod coordinates;
mod cost;
mod definitions;
mod families;
mod field;
mod header;
mod impacts;
mod initial;
mod inputs;
mod instantaneous;
mod modes;
mod parameters;
mod reset;
mod scenes;
mod source;
mod target;
mod transitions;
mod view;
mod written_out;

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};

use super::ast::{Declaration, Declared, Index, Indices, Lagrangian, Spec, Word};
use super::cursor::{Cursor, Read, tokens_of};
use super::keyword::{self, SECTIONS};
use super::limits::check_nesting;
use crate::diagnostics::{Diagnostics, Location, global_of_modes, listed, nearest};

pub use families::mode_help;
pub use header::camel_case;

/// Reads a declaration: a model, or a model with modes. `indices` evaluates the indices of families of modes.
///
/// # Errors
/// All syntax errors, each at its token.
pub fn read(tokens: TokenStream, indices: Indices) -> Result<Declaration, Diagnostics> {
    let (spec, body, diagnostics) = header(tokens)?;
    let tokens = tokens_of(body.stream());
    if modes::are_declared(&tokens) && diagnostics.is_empty() {
        if let Some(at) = spec.global {
            return Err(global_of_modes(at));
        }
        return modes::read(&spec, &tokens, &body, indices).map(Declaration::Modes);
    }
    let spec = one_piece(spec, &tokens, &body, diagnostics)?;
    Ok(Declaration::Model(Box::new(spec)))
}

/// Reads the declaration of a model without modes.
///
/// # Errors
/// Same as [`read`]. Modes are refused, too.
pub fn parse(tokens: TokenStream) -> Result<Spec, Diagnostics> {
    let (spec, body, mut diagnostics) = header(tokens)?;
    let tokens = tokens_of(body.stream());
    if modes::are_declared(&tokens) {
        let text = format!(
            "`{}` has modes: it cannot be read as a single model",
            spec.name.text
        );
        diagnostics.error(spec.name.at, text);
        return Err(diagnostics);
    }
    one_piece(spec, &tokens, &body, diagnostics)
}

/// Reads one more claim of a model, without the `;` after it.
///
/// # Errors
/// The first syntax error.
pub fn add_claim(spec: &mut Spec, tokens: TokenStream) -> Result<(), Diagnostics> {
    check_nesting(&tokens)?;
    let tokens = tokens_of(tokens);
    let mut diagnostics = Diagnostics::new();
    let start = Location::from(Span::call_site());
    let mut cursor = Cursor::new(&tokens, start, &mut diagnostics);
    // The diagnostics contain the error, if any.
    let _ = claims::claim(&mut cursor, spec).and_then(|()| cursor.end());
    diagnostics.finish(())
}

/// Header of a model, and its braces.
fn header(tokens: TokenStream) -> Result<(Spec, Group, Diagnostics), Diagnostics> {
    check_nesting(&tokens)?;
    let tokens = source::flatten_header(tokens);
    let mut diagnostics = Diagnostics::new();
    let start = tokens
        .first()
        .map_or_else(|| Location::from(Span::call_site()), Location::of);
    let mut cursor = Cursor::new(&tokens, start, &mut diagnostics);
    match header::read(&mut cursor) {
        Ok((spec, body)) => Ok((spec, body, diagnostics)),
        Err(_) => Err(diagnostics),
    }
}

fn one_piece(
    mut spec: Spec,
    tokens: &[TokenTree],
    body: &Group,
    mut diagnostics: Diagnostics,
) -> Result<Spec, Diagnostics> {
    declarations(tokens, body, &mut spec, &mut diagnostics);
    diagnostics.finish(spec)
}

/// Attributes before a model or a declaration.
#[derive(Default)]
struct Attributes {
    /// The lines of the doc comments.
    documentation: Vec<String>,
    /// The place of `#[global]`.
    global: Option<Location>,
}

/// The lines of the next doc comments. Other attributes are refused.
fn documentation(cursor: &mut Cursor<'_>) -> Read<Vec<String>> {
    let attributes = attributes(cursor)?;
    match attributes.global {
        None => Ok(attributes.documentation),
        Some(at) => {
            let help = "write it before the name of the model: `#[global] pub Name { .. }`";
            Err(cursor.refuse(at, "`#[global]` belongs to a whole model", help))
        }
    }
}

/// The next attributes: doc comments and `#[global]`. Others are refused.
fn attributes(cursor: &mut Cursor<'_>) -> Read<Attributes> {
    let mut attributes = Attributes::default();
    while cursor.eat_operator("#").is_some() {
        let at = cursor.last();
        let tokens = cursor
            .eat_group(Delimiter::Bracket)
            .map(|group| tokens_of(group.stream()));
        match tokens.as_deref() {
            Some([TokenTree::Ident(doc), TokenTree::Punct(_), text]) if *doc == "doc" => {
                attributes.documentation.extend(source::doc_lines(text));
            }
            Some([TokenTree::Ident(global)]) if *global == "global" => {
                attributes.global = Some(at);
            }
            _ => {
                let help = "a comment is written `// ..`, a doc comment `/// ..`; before a model, `#[global]` asks for its global form";
                return Err(cursor.refuse(at, "unknown attribute", help));
            }
        }
    }
    Ok(attributes)
}

/// Reads the declarations in order. An error in one does not hide errors in the next.
fn declarations(
    tokens: &[TokenTree],
    body: &Group,
    spec: &mut Spec,
    diagnostics: &mut Diagnostics,
) {
    let mut rest = tokens;
    let mut before = Location::opening(body);
    while !rest.is_empty() {
        let length = declaration_length(rest);
        let (declaration, others) = rest.split_at(length);
        let mut cursor = Cursor::new(declaration, before, diagnostics);
        let read = declare(&mut cursor, spec);
        let ends_well = matches!(declaration.last(), Some(TokenTree::Punct(punct)) if punct.as_char() == ';')
            || is_section(declaration);
        if let (Ok(()), false, Some(last)) = (read, ends_well, declaration.last()) {
            diagnostics
                .error(Location::of(last), "expected `;`")
                .help("end the declaration with `;`");
        }
        before = declaration.last().map_or(before, Location::of);
        rest = others;
    }
}

/// The tokens of each declaration, in order.
fn split(tokens: &[TokenTree]) -> impl Iterator<Item = &[TokenTree]> {
    let mut rest = tokens;
    core::iter::from_fn(move || {
        let (declaration, others) = rest.split_at(declaration_length(rest));
        rest = others;
        (!declaration.is_empty()).then_some(declaration)
    })
}

/// Number of tokens of the first declaration: up to a `;`, a section's braces, or the beginning of another declaration.
fn declaration_length(tokens: &[TokenTree]) -> usize {
    let documentation = documentation_length(tokens);
    for (index, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Punct(punct) if punct.as_char() == ';' => return index + 1,
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => return index + 1,
            TokenTree::Ident(word)
                if index > documentation && begins_declaration(word, tokens.get(index + 1)) =>
            {
                return index;
            }
            _ => {}
        }
    }
    tokens.len()
}

/// Number of tokens of the attributes at the beginning, doc comments included.
fn documentation_length(tokens: &[TokenTree]) -> usize {
    let is_attribute = |pair: &&[TokenTree]| {
        matches!(pair, [TokenTree::Punct(hash), TokenTree::Group(group)]
            if hash.as_char() == '#' && group.delimiter() == Delimiter::Bracket)
    };
    2 * tokens.chunks(2).take_while(is_attribute).count()
}

/// True if this word, followed by this token, always begins a declaration.
fn begins_declaration(word: &Ident, next: Option<&TokenTree>) -> bool {
    let word = word.to_string();
    let known = SECTIONS.contains(&word.as_str());
    match next {
        Some(TokenTree::Ident(next)) => match word.as_str() {
            "let" | "const" => true,
            "claims" => next == "for",
            _ => false,
        },
        Some(TokenTree::Punct(punct)) => word == "lagrangian" && punct.as_char() == '=',
        Some(TokenTree::Group(group)) => known && group.delimiter() == Delimiter::Brace,
        _ => false,
    }
}

/// True if a declaration ends with the braces of a section.
fn is_section(declaration: &[TokenTree]) -> bool {
    matches!(declaration.last(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace)
}

/// Reads one declaration.
fn declare(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    documentation(cursor)?;
    if cursor.is_operator(";") {
        return Ok(());
    }
    let word = cursor.name("a declaration")?;
    match word.text.as_str() {
        "const" => definitions::constant(cursor, spec),
        "let" => definitions::definition(cursor, spec),
        "lagrangian" => lagrangian(&word, cursor, spec),
        "coordinates" => coordinates::section(&word, cursor, spec),
        "parameters" => section(&word, cursor, spec, parameters::parameter),
        "field" => {
            field::begin(&word, spec);
            section(&word, cursor, spec, field::rate)
        }
        "constraints" => section(&word, cursor, spec, constraints::constraint),
        "inputs" => section(&word, cursor, spec, inputs::input),
        "cost" => {
            cost::begin(&word, spec);
            section(&word, cursor, spec, cost::entry)
        }
        "forces" => section(&word, cursor, spec, constraints::force),
        "frame" => section(&word, cursor, spec, constraints::quasi_velocity),
        "outputs" => section(&word, cursor, spec, constraints::output),
        "impacts" => section(&word, cursor, spec, impacts::surface),
        "initial" => section(&word, cursor, spec, initial::value),
        "view" => section(&word, cursor, spec, view::entry),
        "modes" | "transitions" => Err(modes::refuse_nested(&word, cursor)),
        "scenes" => section(&word, cursor, spec, scenes::scene),
        "claims" => claims_section(&word, cursor, spec),
        _ => Err(unknown_declaration(&word, cursor)),
    }
}

/// Refuses a word that begins no declaration.
fn unknown_declaration(word: &Word, cursor: &mut Cursor<'_>) -> super::cursor::Refused {
    let help = if let Some(section) = keyword::foreign_section(&word.text) {
        section.to_owned()
    } else if let Some(near) = nearest(&word.text, SECTIONS) {
        format!("did you mean `{near}`?")
    } else if cursor.is_operator("=") {
        format!("a definition is written `let {} = ..;`", word.text)
    } else {
        format!("a model consists of {}", listed(SECTIONS))
    };
    cursor.refuse(
        word.at,
        format!("unknown declaration `{}`", word.text),
        &help,
    )
}

/// Reads the entries of a section, each up to its `;`.
fn section(
    keyword: &Word,
    cursor: &mut Cursor<'_>,
    spec: &mut Spec,
    entry: fn(&mut Cursor<'_>, &mut Spec) -> Read<()>,
) -> Read<()> {
    let Some(group) = cursor.eat_group(Delimiter::Brace) else {
        let text = format!("expected `{{ .. }}` after `{}`", keyword.text);
        return Err(cursor.unexpected(&text, &format!("write `{} {{ .. }}`", keyword.text)));
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    while !inside.is_at_end() {
        let length = entry_length(inside.remaining());
        let (tokens, ended) = inside.take(length);
        let mut cursor = inside.inside(tokens, group);
        if !cursor.is_at_end()
            && entry(&mut cursor, spec).and_then(|()| cursor.end()).is_ok()
            && !ended
        {
            let at = cursor.last();
            cursor.refuse(at, "expected `;`", "end the declaration with `;`");
        }
    }
    Ok(())
}

/// `claims { .. }` about the whole model, `claims for SCENE { .. }` about a scene.
fn claims_section(keyword: &Word, cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let scene = match cursor.eat_word("for") {
        true => Some(cursor.name("the name of a scene")?),
        false => None,
    };
    let first = spec.claims.len();
    let read = section(keyword, cursor, spec, claims::claim);
    for claim in &mut spec.claims[first..] {
        claim.scene.clone_from(&scene);
    }
    read
}

/// Number of tokens before the next `;`.
fn entry_length(tokens: &[TokenTree]) -> usize {
    let is_end =
        |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ';');
    tokens.iter().position(is_end).unwrap_or(tokens.len())
}

/// `lagrangian = e;`
fn lagrangian(keyword: &Word, cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    cursor.expect_operator("=", "lagrangian = ..;")?;
    let value = cursor.scalar()?;
    end_of_declaration(cursor)?;
    if let Some(first) = &spec.lagrangian {
        let at = spec.location(first.item);
        cursor
            .diagnostics
            .error(keyword.at, "`lagrangian` declared again")
            .help("keep one of the two")
            .also(at, "first declared here");
        return Ok(());
    }
    let item = spec.item(value.at);
    spec.lagrangian = Some(Lagrangian { value, item });
    Ok(())
}

/// Takes the `;` after a declaration. The caller reports a missing one.
fn end_of_declaration(cursor: &mut Cursor<'_>) -> Read<()> {
    cursor.eat_operator(";");
    cursor.end()
}

/// A name to be declared, with its index in brackets.
fn declared(cursor: &mut Cursor<'_>, what: &str) -> Read<Declared> {
    let name = cursor.new_name(what)?;
    let index = index(cursor)?;
    Ok(Declared { name, index })
}

/// `[N]`, `[i in 1..=N]` or nothing.
fn index(cursor: &mut Cursor<'_>) -> Read<Option<Index>> {
    let Some(group) = cursor.eat_group(Delimiter::Bracket) else {
        return Ok(None);
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let is_binder = match inside.peek_second() {
        Some(TokenTree::Ident(word)) => *word == "in",
        Some(TokenTree::Punct(punct)) => punct.as_char() == '=',
        _ => false,
    };
    if !is_binder {
        let index = inside.scalar()?;
        if inside.is_operator("..=") || inside.is_operator("..") {
            let help = "write `name[i in 1..=N]`; a family is declared by its size: `name[N]`";
            return Err(inside.refuse(inside.here(), "a range in brackets needs an index", help));
        }
        inside.end()?;
        return Ok(Some(Index::One(index)));
    }
    let binder = inside.binder("name[i in 1..=N]")?;
    inside.end()?;
    Ok(Some(Index::Each(binder)))
}

/// A doc comment, a name with an index, and the `:` after it. `entry` is a noun such as `a surface`, `form` the form of
/// an entry; both are for messages.
fn labelled(cursor: &mut Cursor<'_>, entry: &str, form: &str) -> Read<(Vec<String>, Declared)> {
    let documentation = documentation(cursor)?;
    if !begins_with_name(cursor.remaining()) {
        let help = format!("write `{form}`");
        return Err(cursor.refuse(
            cursor.here(),
            format!("{entry} begins with its name"),
            &help,
        ));
    }
    let declared = declared(cursor, &format!("the name of {entry}"))?;
    cursor.expect_operator(":", form)?;
    Ok((documentation, declared))
}

/// True if the first token of an entry can be its name: the token after it, or after its index, cannot continue an
/// expression.
fn begins_with_name(tokens: &[TokenTree]) -> bool {
    let is_index = |token: &TokenTree| matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Bracket);
    let [TokenTree::Ident(_), rest @ ..] = tokens else {
        return false;
    };
    match rest.iter().find(|token| !is_index(token)) {
        Some(TokenTree::Punct(punct)) => matches!(punct.as_char(), ':' | '='),
        Some(TokenTree::Group(_)) | None => false,
        Some(_) => true,
    }
}
