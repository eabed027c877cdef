//! Storage of the coefficients of all orders, and the sums over their products that are computed side by side. The
//! coefficients of one value are its history; a weighted history has each coefficient times its order.
//!
//! A sum over `a_j b_(k-j)` with `0 < j < k` needs no coefficient of order `k`: all such sums of an order can be
//! computed at its beginning, in any sequence. They are therefore computed side by side. Row `k` of the storage holds
//! coefficient `k` of all factors; the coefficients of neighbouring sums are adjacent.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use dalembert_codegen::program::Value;
use dalembert_codegen::program::jet::History;

/// Number of sums that are computed side by side. They fill one, two or four vector registers.
const SIDE_BY_SIDE: usize = 8;

/// The sum over `a_j b_(k-j)` with `0 < j < k`, for the coefficients of two series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sum {
    /// Half of the sum of `a_j a_(k-j)`, for one series.
    Half(Value),
    /// The sum over two series.
    Middle(History, History),
}

/// The storage of an expansion.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    /// Histories read one coefficient at a time, and their places.
    alone: BTreeMap<History, usize>,
    /// Values that are linear in time and multiply others. Their only coefficient above order 0 is a local.
    steady: BTreeSet<Value>,
    /// Values that the linear values multiply. Their coefficient of the previous order is a local.
    multiplied: BTreeSet<Value>,
    halves: Vec<Value>,
    middles: Vec<(History, History)>,
}

/// A block of sums that are computed side by side: the sums of one kind from index `first` on.
struct Block {
    first: usize,
    /// Index of the first factor's coefficients within a row.
    place: usize,
    /// Number of places that each factor takes.
    width: usize,
    /// Histories in the sums, by factor.
    factors: Vec<Vec<History>>,
}

impl Block {
    fn count(&self) -> usize {
        self.factors[0].len()
    }

    /// For each factor, the place of its coefficients in a row and the local that holds the newest ones.
    fn places(&self) -> impl Iterator<Item = (Literal, Ident)> + '_ {
        (0..self.factors.len()).map(|i| {
            let place = self.place + i * self.width;
            (Literal::usize_unsuffixed(place), name("newest", place))
        })
    }

    /// The first place behind the block.
    fn end(&self) -> usize {
        self.place + self.factors.len() * self.width
    }
}

impl Layout {
    /// Keeps a history whose coefficients are read one at a time, and gives its place in a row.
    pub(super) fn keep(&mut self, history: History) -> Literal {
        let place = self.alone.len();
        Literal::usize_unsuffixed(*self.alone.entry(history).or_insert(place))
    }

    /// For the product of a value that is linear in time with another value: the two locals whose product enters order
    /// `k`, the slope of the first and coefficient `k - 1` of the second. The product needs no stored coefficients.
    pub(super) fn product_with_steady(&mut self, steady: Value, other: Value) -> [Ident; 2] {
        self.steady.insert(steady);
        self.multiplied.insert(other);
        [local("slope", steady), local("last", other)]
    }

    /// True if a value is linear in time and multiplies another.
    pub(super) fn is_steady(&self, value: Value) -> bool {
        self.steady.contains(&value)
    }

    /// The values whose coefficient of the previous order is a local.
    pub(super) fn multiplied(&self) -> impl Iterator<Item = Value> + '_ {
        self.multiplied.iter().copied()
    }

    /// Statements before the loop; `first` gives order 0 of a value.
    pub(super) fn begin(&self, mut first: impl FnMut(Value) -> TokenStream) -> TokenStream {
        let slopes = self.steady.iter().map(|&value| {
            let slope = local("slope", value);
            quote!(let mut #slope = L::ZERO;)
        });
        let lasts = self.multiplied.iter().map(|&value| {
            let (last, first) = (local("last", value), first(value));
            quote!(let mut #last = #first;)
        });
        let blocks = self.blocks();
        let newest = blocks.iter().flat_map(|block| {
            let width = block.width;
            let of = move |(_, newest)| quote!(let mut #newest = [L::ZERO; #width];);
            block.places().map(of)
        });
        slopes.chain(lasts).chain(newest).collect()
    }

    /// Coefficient `order` of a history, if it is kept alone.
    pub(super) fn coefficient(&self, history: History, order: &TokenStream) -> Option<TokenStream> {
        let place = Literal::usize_unsuffixed(*self.alone.get(&history)?);
        Some(quote!(jets[#order][#place]))
    }

    /// All histories that are kept alone.
    pub(super) fn alone(&self) -> impl Iterator<Item = History> + '_ {
        self.alone.keys().copied()
    }

    /// Adds a sum to the layout and returns the name of its value.
    pub(super) fn sum(&mut self, sum: Sum) -> Ident {
        match sum {
            Sum::Half(value) => name("half", position(&mut self.halves, value)),
            Sum::Middle(a, b) => name("sum", position(&mut self.middles, (a, b))),
        }
    }

    /// Statements that compute all sums of order `k`.
    pub(super) fn sums(&self) -> TokenStream {
        let statements = self.blocks().into_iter().map(|block| {
            let (prefix, function) = match block.factors.len() {
                1 => ("half", quote!(halves)),
                _ => ("sum", quote!(middles)),
            };
            let names = (0..block.width).map(|i| match i < block.count() {
                true => {
                    let name = name(prefix, block.first + i);
                    quote!(#name)
                }
                false => quote!(_),
            });
            let factors = block
                .places()
                .map(|(place, newest)| quote!((#place, &#newest)));
            quote!(let [#(#names),*] = ::dalembert::jet::#function(jets, #(#factors,)* k);)
        });
        statements.collect()
    }

    /// Statements that keep coefficient `k` for the sums of the next orders; `coefficient` gives it.
    pub(super) fn keep_factors(&self, coefficient: impl Fn(History) -> TokenStream) -> TokenStream {
        let lasts = self.multiplied.iter().map(|&value| {
            let (last, next) = (local("last", value), coefficient(History::plain(value)));
            quote!(#last = #next;)
        });
        let mut statements: TokenStream = lasts.collect();
        for block in self.blocks() {
            let zeros = vec![quote!(L::ZERO); block.width - block.count()];
            for ((place, newest), factor) in block.places().zip(&block.factors) {
                let coefficients = factor.iter().map(|&history| coefficient(history));
                statements.extend(quote! {
                    #newest = [#(#coefficients,)* #(#zeros),*];
                    ::dalembert::jet::keep(&mut jets[k], #place, &#newest);
                });
            }
        }
        statements
    }

    /// Number of places in a row.
    pub(super) fn width(&self) -> usize {
        let blocks = self.blocks();
        blocks.last().map_or(self.alone.len(), Block::end)
    }

    /// The half sums, then the sums over two series, in blocks of at most `SIDE_BY_SIDE`.
    fn blocks(&self) -> Vec<Block> {
        let halves = self.halves.iter().map(|&value| History::plain(value));
        let (left, right) = self.middles.iter().copied().unzip();
        let mut blocks = Vec::new();
        let mut place = self.alone.len();
        for factors in [vec![halves.collect()], vec![left, right]] {
            let count = factors.first().map_or(0, Vec::len);
            for first in (0..count).step_by(SIDE_BY_SIDE) {
                let together = SIDE_BY_SIDE.min(count - first);
                let part = |all: &Vec<History>| all[first..][..together].to_vec();
                let block = Block {
                    first,
                    place,
                    width: together.next_power_of_two(),
                    factors: factors.iter().map(part).collect(),
                };
                place = block.end();
                blocks.push(block);
            }
        }
        blocks
    }
}

pub(super) fn local(prefix: &str, value: Value) -> Ident {
    name(prefix, value.index())
}

fn name(prefix: &str, index: usize) -> Ident {
    Ident::new(&format!("{prefix}_{index}"), Span::mixed_site())
}

fn position<T: PartialEq>(list: &mut Vec<T>, entry: T) -> usize {
    let known = list.iter().position(|other| *other == entry);
    known.unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}
