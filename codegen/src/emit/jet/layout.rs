//! Where coefficients are kept over the orders, and which sums over products of them are taken.
//!
//! A sum over `a_j b_(k-j)` with `0 < j < k` takes no coefficient of order `k`: all such sums of an order can be taken at its
//! beginning, whatever depends on what. So they are taken side by side. Row `k` of the room holds coefficient `k` of
//! all factors, those of neighbouring sums next to each other.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use crate::program::Value;
use crate::program::jet::History;

/// Sums taken side by side: what one vector register holds, or two, or four.
const SIDE_BY_SIDE: usize = 8;

/// A sum over all products of coefficients of two series that add up to an order, but those with order 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sum {
    /// Half of that of a series with itself.
    Half(Value),
    /// That of two series.
    Middle(History, History),
}

/// The room of an expansion.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    /// Histories read one coefficient at a time, and their places.
    alone: BTreeMap<History, usize>,
    /// Values that grow steadily and multiply others: their one coefficient is a local; and values whose coefficient of
    /// the order before is one.
    steady: BTreeSet<Value>,
    multiplied: BTreeSet<Value>,
    halves: Vec<Value>,
    middles: Vec<(History, History)>,
}

/// Sums taken together: which of their kind, where the coefficients of their factors lie in a row, and how many places each
/// factor has.
struct Block {
    first: usize,
    count: usize,
    place: usize,
    width: usize,
}

impl Block {
    /// The places of the factors in a row: how many, for sums with this many factors.
    fn end(&self, factors: usize) -> usize {
        self.place + factors * self.width
    }
}

impl Layout {
    /// Keeps a history whose coefficients are read one at a time, and gives its place in a row.
    pub(super) fn keep(&mut self, history: History) -> Literal {
        let place = self.alone.len();
        Literal::usize_unsuffixed(*self.alone.entry(history).or_insert(place))
    }

    /// The only product of a value that grows steadily with coefficients of another: no memory is on its way from order to
    /// order.
    pub(super) fn product_with_steady(&mut self, steady: Value, other: Value) -> [Ident; 2] {
        self.steady.insert(steady);
        self.multiplied.insert(other);
        [local("slope", steady), local("last", other)]
    }

    /// Whether a value grows steadily and multiplies another.
    pub(super) fn is_steady(&self, value: Value) -> bool {
        self.steady.contains(&value)
    }

    /// The values whose coefficient of the order before is a local.
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
        slopes.chain(lasts).collect()
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

    /// Takes a sum, and gives the name of its value.
    pub(super) fn sum(&mut self, sum: Sum) -> Ident {
        match sum {
            Sum::Half(value) => name("half", position(&mut self.halves, value)),
            Sum::Middle(a, b) => name("sum", position(&mut self.middles, (a, b))),
        }
    }

    /// Statements that take all sums of order `k`.
    pub(super) fn sums(&self) -> TokenStream {
        let of = |blocks: Vec<Block>, prefix: &'static str, function: TokenStream, factors| {
            let statements = blocks.into_iter().map(move |block| {
                let names = (0..block.width).map(|i| match i < block.count {
                    true => {
                        let name = name(prefix, block.first + i);
                        quote!(#name)
                    }
                    false => quote!(_),
                });
                let places =
                    (0..factors).map(|i| Literal::usize_unsuffixed(block.place + i * block.width));
                quote!(let [#(#names),*] = ::dalembert::jet::#function(jets, #(#places,)* k);)
            });
            statements.collect::<TokenStream>()
        };
        let halves = of(self.half_blocks(), "half", quote!(halves), 1);
        let middles = of(self.middle_blocks(), "sum", quote!(middles), 2);
        quote!(#halves #middles)
    }

    /// Statements that keep coefficient `k` of what the next orders take; `coefficient` gives it.
    pub(super) fn keep_factors(&self, coefficient: impl Fn(History) -> TokenStream) -> TokenStream {
        let lasts = self.multiplied.iter().map(|&value| {
            let (last, next) = (local("last", value), coefficient(History::plain(value)));
            quote!(#last = #next;)
        });
        let mut statements: TokenStream = lasts.collect();
        let mut keep = |place: usize, history| {
            let (place, coefficient) = (Literal::usize_unsuffixed(place), coefficient(history));
            statements.extend(quote!(jets[k][#place] = #coefficient;));
        };
        for block in self.half_blocks() {
            for i in 0..block.count {
                keep(
                    block.place + i,
                    History::plain(self.halves[block.first + i]),
                );
            }
        }
        for block in self.middle_blocks() {
            let pairs = &self.middles[block.first..][..block.count];
            for (i, (a, _)) in pairs.iter().enumerate() {
                keep(block.place + i, *a);
            }
            for (i, (_, b)) in pairs.iter().enumerate() {
                keep(block.place + block.width + i, *b);
            }
        }
        statements
    }

    /// Places of a row.
    pub(super) fn width(&self) -> usize {
        let halves = self.half_blocks();
        let middles = self.middle_blocks();
        let ends = halves.last().map(|block| block.end(1));
        let ends = middles.last().map(|block| block.end(2)).or(ends);
        ends.unwrap_or(self.alone.len())
    }

    fn half_blocks(&self) -> Vec<Block> {
        blocks(self.halves.len(), 1, self.alone.len())
    }

    fn middle_blocks(&self) -> Vec<Block> {
        let halves = self.half_blocks();
        let place = halves.last().map_or(self.alone.len(), |block| block.end(1));
        blocks(self.middles.len(), 2, place)
    }
}

/// This many sums with this many factors each, from a place of the row on.
fn blocks(count: usize, factors: usize, mut place: usize) -> Vec<Block> {
    let firsts = (0..count).step_by(SIDE_BY_SIDE);
    let block = firsts.map(|first| {
        let count = SIDE_BY_SIDE.min(count - first);
        let block = Block {
            first,
            count,
            place,
            width: count.next_power_of_two(),
        };
        place = block.end(factors);
        block
    });
    block.collect()
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
