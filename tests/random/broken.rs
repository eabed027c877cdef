//! Broken declarations are refused without a panic, with messages that point at tokens and not at the whole call.

use std::fmt;

use dalembert::Instance;
use dalembert_codegen::diagnostics::{Diagnostic, Location};
use dalembert_emit::try_expand;
use dalembert_tests::sampling::every_system;
use proc_macro2::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream, TokenTree};
use proptest::prelude::*;
use proptest::strategy::BoxedStrategy;

use super::config;
use super::declaration::Declaration;

/// Tokens that are printed as text.
#[derive(Clone)]
struct Tokens(TokenStream);

impl fmt::Debug for Tokens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// The declarations of every system of [`every_system`].
fn sources() -> Vec<&'static str> {
    let systems = every_system().iter();
    systems
        .map(|system| system.description().source.value())
        .collect()
}

/// Number of tokens, where the brackets of a group count once.
fn count(tokens: &TokenStream) -> usize {
    let inner = |token: TokenTree| match token {
        TokenTree::Group(group) => 1 + count(&group.stream()),
        _ => 1,
    };
    tokens.clone().into_iter().map(inner).sum()
}

/// The tokens without the marked ones. Brackets are deleted in pairs, since an unpaired bracket never reaches a macro.
fn thinned(tokens: TokenStream, is_deleted: &mut impl Iterator<Item = bool>) -> TokenStream {
    let mut kept = TokenStream::new();
    for token in tokens {
        let is_deleted_itself = is_deleted.next().unwrap_or(false);
        match token {
            TokenTree::Group(group) => {
                let inner = thinned(group.stream(), is_deleted);
                if is_deleted_itself {
                    kept.extend(inner);
                } else {
                    let mut thinned = Group::new(group.delimiter(), inner);
                    thinned.set_span(group.span());
                    kept.extend([TokenTree::from(thinned)]);
                }
            }
            token if !is_deleted_itself => kept.extend([token]),
            _ => {}
        }
    }
    kept
}

/// A declaration with three of ten tokens deleted, or with fewer, so that errors after parsing occur too.
fn deleted(source: String) -> impl Strategy<Value = Tokens> {
    let tokens = count(&source.parse().expect("tokens"));
    let marks = |share| prop::collection::vec(prop::bool::weighted(share), tokens);
    prop_oneof![marks(0.3), marks(0.03), marks(0.003)].prop_map(move |marks| {
        let tokens = source.parse().expect("tokens");
        Tokens(thinned(tokens, &mut marks.into_iter()))
    })
}

fn deleted_from_any() -> impl Strategy<Value = Tokens> {
    let known = prop::sample::select(sources()).prop_map(str::to_owned);
    let drawn = Declaration::any(3).prop_map(|declaration| declaration.named("Random"));
    prop_oneof![known, drawn].prop_flat_map(deleted)
}

/// Words of the language, and some that are not.
const WORDS: [&str; 34] = [
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
    "pub",
    "Model",
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
    "angle",
    "elastic",
    "newton",
    "energy",
    "until",
];
const LITERALS: [&str; 10] = [
    "0", "1", "2", "0.5", "1e400", "2x", "\"a\"", "'a'", "70", "1e-9",
];
const MARKS: [char; 21] = [
    '=', ';', ',', ':', '+', '-', '*', '/', '^', '%', '<', '>', '.', '#', '!', '|', '&', '?', '$',
    '@', '~',
];

/// Any token, with groups nested a few times.
fn token() -> BoxedStrategy<TokenTree> {
    let words = prop::sample::select(&WORDS[..])
        .prop_map(|word| TokenTree::from(Ident::new(word, Span::call_site())));
    let literals = prop::sample::select(&LITERALS[..])
        .prop_map(|text| TokenTree::from(text.parse::<Literal>().expect("a literal")));
    let marks = (prop::sample::select(&MARKS[..]), any::<bool>()).prop_map(|(mark, is_joint)| {
        let spacing = if is_joint {
            Spacing::Joint
        } else {
            Spacing::Alone
        };
        TokenTree::from(Punct::new(mark, spacing))
    });
    let leaf = prop_oneof![4 => words, 2 => literals, 4 => marks];
    leaf.prop_recursive(4, 60, 12, |inner| {
        let delimiter = prop::sample::select(vec![
            Delimiter::Brace,
            Delimiter::Parenthesis,
            Delimiter::Bracket,
            Delimiter::None,
        ]);
        (delimiter, prop::collection::vec(inner, 0..12)).prop_map(|(delimiter, inner)| {
            Group::new(delimiter, inner.into_iter().collect()).into()
        })
    })
    .boxed()
}

/// A model with arbitrary tokens in its braces.
fn scrambled() -> impl Strategy<Value = Tokens> {
    prop::collection::vec(token(), 0..40).prop_map(|inner| {
        let name = Ident::new("Model", Span::call_site());
        let body = Group::new(Delimiter::Brace, inner.into_iter().collect());
        Tokens([TokenTree::from(name), body.into()].into_iter().collect())
    })
}

/// Checks that the tokens are accepted, or that every error has a text and points at some, but not all, of the tokens.
fn check(tokens: &Tokens) -> Result<(), TestCaseError> {
    let Err(errors) = try_expand(tokens.0.clone()) else {
        return Ok(());
    };
    prop_assert!(errors.iter().next().is_some(), "refused without a reason");
    for (at, text) in errors.iter().flat_map(Diagnostic::places) {
        prop_assert!(!text.is_empty(), "an empty message");
        prop_assert!(is_within(tokens, *at), "{text}: not at a token");
        prop_assert!(!is_whole(tokens, *at), "{text}: at the whole call");
    }
    Ok(())
}

/// True if a place consists of tokens that were read.
fn is_within(tokens: &Tokens, at: Location) -> bool {
    tokens.0.is_empty() || !at.first.byte_range().is_empty()
}

/// True if a place goes from the first token to the last.
fn is_whole(tokens: &Tokens, at: Location) -> bool {
    let tokens: Vec<TokenTree> = tokens.0.clone().into_iter().collect();
    let [first, .., last] = tokens.as_slice() else {
        return false;
    };
    at.first.byte_range().start == first.span().byte_range().start
        && at.last.byte_range().end == last.span().byte_range().end
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn tokens_may_be_missing(tokens in deleted_from_any()) {
        check(&tokens)?;
    }

    #[test]
    fn tokens_may_be_anything(tokens in scrambled()) {
        // These tokens were not read from a text and have no places. The test asserts that nothing panics.
        let _ = try_expand(tokens.0);
    }
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    #[ignore = "nightly: many deletions"]
    fn many_tokens_may_be_missing(tokens in deleted_from_any()) {
        check(&tokens)?;
    }
}
