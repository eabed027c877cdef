//! The parser reads or refuses a model with missing tokens, and never panics.

use proc_macro2::{Group, TokenStream, TokenTree};

use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::model;
use dalembert_codegen::spec::parse;

use super::MODEL;

#[test]
fn models_with_tokens_missing_never_panic() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let tokens = thinned(MODEL.parse().unwrap(), &mut random);
        if let Ok(spec) = parse(tokens) {
            let _ = model::check(&spec).map_err(Diagnostics::into_compile_error);
        }
    }
}

#[test]
fn models_with_single_tokens_missing_never_panic() {
    let mut random = Random(2);
    let count = 400;
    for _ in 0..count {
        let mut position = random.next() % 300;
        let tokens = without(MODEL.parse().unwrap(), &mut position);
        if let Ok(spec) = parse(tokens) {
            let _ = model::check(&spec).map_err(Diagnostics::into_compile_error);
        }
    }
}

/// Linear congruential generator with Knuth's multiplier. The high bits are used.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }
}

/// The stream with 30 % of its tokens left out. Of a group that is left out, the content stays.
fn thinned(tokens: TokenStream, random: &mut Random) -> TokenStream {
    let mut kept = TokenStream::new();
    for token in tokens {
        let leave_out = random.next() % 10 < 3;
        match token {
            TokenTree::Group(group) => {
                let inside = thinned(group.stream(), random);
                if leave_out {
                    kept.extend(inside);
                } else {
                    kept.extend([TokenTree::from(Group::new(group.delimiter(), inside))]);
                }
            }
            other if leave_out => drop(other),
            other => kept.extend([other]),
        }
    }
    kept
}

/// The stream without the token at `position`, counted depth-first.
fn without(tokens: TokenStream, position: &mut u64) -> TokenStream {
    let mut kept = TokenStream::new();
    for token in tokens {
        let leave_out = *position == 0;
        *position = position.wrapping_sub(1);
        match token {
            TokenTree::Group(group) => {
                let inside = without(group.stream(), position);
                if leave_out {
                    kept.extend(inside);
                } else {
                    kept.extend([TokenTree::from(Group::new(group.delimiter(), inside))]);
                }
            }
            other if leave_out => drop(other),
            other => kept.extend([other]),
        }
    }
    kept
}
