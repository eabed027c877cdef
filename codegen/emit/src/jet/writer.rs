//! Statements of a Taylor expansion: order 0, and order `k` of all values that vary.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, Group, Ident, Literal, TokenStream, TokenTree};
use quote::{ToTokens, quote};

use super::super::Context;
use super::super::function::joined;
use super::super::names::{pi, rational};
use super::layout::{Layout, local};
use dalembert_codegen::program::jet::{History, Jet, Recurrence};
use dalembert_codegen::program::{Input, Op, Value};

pub(super) struct Writer<'a> {
    pub(super) jet: &'a Jet,
    /// Number of components of the state.
    components: usize,
    /// Number of reads of coefficient `k`, by value.
    uses: Vec<usize>,
    pub(super) room: Room,
    /// Values whose order 0 is read.
    read: BTreeSet<Value>,
    /// Values whose reciprocal of order 0 is read.
    inverses: BTreeSet<Value>,
}

/// Storage of the coefficients.
#[derive(Debug, Clone)]
pub(super) enum Room {
    /// Row-major: all values of one order, then those of the next.
    Rows(Layout),
    /// One contiguous history per value, with its index. Used for large expansions.
    Histories(BTreeMap<History, usize>),
}

impl Room {
    fn of(jet: &Jet, uses: &[usize]) -> Self {
        if !jet.is_large() {
            return Self::Rows(Layout::default());
        }
        let mut histories: BTreeSet<History> = jet.histories.iter().copied().collect();
        let bound = |value: &Value| uses[value.index()] > 1 || jet.is_kept(*value);
        histories.extend(jet.varying().filter(bound).map(History::plain));
        let places = histories.into_iter().enumerate();
        Self::Histories(places.map(|(place, history)| (history, place)).collect())
    }

    /// The type of the storage.
    pub(super) fn type_tokens(&self) -> TokenStream {
        match self {
            Self::Rows(layout) => {
                let width = layout.width();
                quote!([[L; #width]; ::dalembert::jet::LENGTH])
            }
            Self::Histories(places) => {
                let kept = places.len();
                quote!([[L; ::dalembert::jet::LENGTH]; #kept])
            }
        }
    }
}

impl<'a> Writer<'a> {
    pub(super) fn of(jet: &'a Jet, context: &Context<'_>) -> Self {
        let uses = jet.uses();
        Self {
            jet,
            components: context.form.dimension() + context.form.motion_dimension(),
            room: Room::of(jet, &uses),
            uses,
            read: BTreeSet::new(),
            inverses: BTreeSet::new(),
        }
    }

    pub(super) fn is_large(&self) -> bool {
        matches!(self.room, Room::Histories(_))
    }

    /// Statements for order `k` of every value that varies; expressions for coefficient `k` of the results; statements
    /// that store coefficients for later orders.
    pub(super) fn orders(&mut self) -> (TokenStream, Vec<TokenStream>, TokenStream) {
        let varying: Vec<Value> = self.jet.varying().collect();
        let components = self.bind_components(&varying);
        let values = varying.iter().map(|&value| self.advance(value));
        let values: TokenStream = values.collect();
        let outputs = self.jet.function.outputs.iter();
        let next = outputs.map(|&output| match self.jet.recurrences[output.index()] {
            Recurrence::Constant => quote!(L::ZERO),
            _ => self.next(output),
        });
        let next = next.collect();
        let (mut sums, mut factors) = (TokenStream::new(), TokenStream::new());
        if let Room::Rows(layout) = &self.room {
            sums = layout.sums();
            factors = layout.keep_factors(|history| {
                let next = local("next", history.value);
                match history.weighted {
                    true => quote!(weight * #next),
                    false => quote!(#next),
                }
            });
        }
        (joined([sums, components, values]), next, factors)
    }

    /// `let [next_0, _] = coefficients[k];`
    fn bind_components(&self, varying: &[Value]) -> TokenStream {
        let mut locals = vec![quote!(_); self.components];
        let mut any = false;
        for &value in varying {
            if let Recurrence::Component(i) = self.jet.recurrences[value.index()] {
                let next = local("next", value);
                (locals[i], any) = (quote!(#next), true);
            }
        }
        if !any {
            return TokenStream::new();
        }
        quote!(let [#(#locals),*] = coefficients[k];)
    }

    /// The values whose order 0 is in the array `firsts`, the results first, and statements that take from it the
    /// values that are read.
    pub(super) fn read_firsts(&self) -> (Vec<Value>, TokenStream) {
        let mut known = self.jet.function.outputs.clone();
        let mut statements = TokenStream::new();
        for &value in self.read.union(&self.inverses) {
            let place = known.iter().position(|other| *other == value);
            let place = place.unwrap_or_else(|| {
                known.push(value);
                known.len() - 1
            });
            let place = Literal::usize_unsuffixed(place);
            let first = self.memory(value, &quote!(0));
            statements.extend(match first {
                Some(first) => quote!(#first = firsts[#place];),
                None => {
                    let first = local("first", value);
                    quote!(let #first = firsts[#place];)
                }
            });
        }
        (known, statements)
    }

    /// Statements that compute the reciprocals of order 0.
    pub(super) fn begin_inverses(&mut self) -> TokenStream {
        let inverses = self.inverses.clone().into_iter().map(|value| {
            let (inverse, value) = (local("inverse", value), self.first(value));
            quote!(let #inverse = L::of(1.0) / #value;)
        });
        inverses.collect()
    }

    /// Statements that store order 0 of the histories that [`Writer::read_firsts`] does not store.
    pub(super) fn begin_histories(&mut self) -> TokenStream {
        let histories: Vec<(History, TokenStream)> = match &self.room {
            Room::Rows(layout) => {
                let place = |history| Some((history, layout.coefficient(history, &quote!(0))?));
                layout.alone().filter_map(place).collect()
            }
            Room::Histories(places) => {
                let weighted = places.iter().filter(|(history, _)| history.weighted);
                let place = |(history, place): (&History, &usize)| {
                    let place = Literal::usize_unsuffixed(*place);
                    (*history, quote!(jets[#place][0]))
                };
                weighted.map(place).collect()
            }
        };
        let entries = histories.into_iter().map(|(history, place)| {
            let first = match history.weighted {
                true => quote!(L::ZERO),
                false => self.first(history.value),
            };
            quote!(#place = #first;)
        });
        let entries: TokenStream = entries.collect();
        let locals = match self.room.clone() {
            Room::Rows(layout) => layout.begin(|value| self.first(value)),
            Room::Histories(_) => TokenStream::new(),
        };
        joined([entries, locals])
    }

    /// Expression for order 0 of a value.
    pub(super) fn first(&mut self, value: Value) -> TokenStream {
        match &self.jet.function.ops[value.index()] {
            Op::Number(number) => rational(number),
            Op::Pi => pi(),
            Op::Input(Input::Parameter(k)) => {
                let place = Literal::usize_unsuffixed(*k);
                quote!(parameters[#place])
            }
            _ => {
                self.read.insert(value);
                let memory = self.memory(value, &quote!(0));
                memory.unwrap_or_else(|| local("first", value).into_token_stream())
            }
        }
    }

    /// Local variable for the reciprocal of order 0 of a value.
    pub(super) fn inverse(&mut self, value: Value) -> Ident {
        self.first(value);
        self.inverses.insert(value);
        local("inverse", value)
    }

    /// Expression for coefficient `k` of a value.
    pub(super) fn next(&mut self, value: Value) -> TokenStream {
        let recurrence = &self.jet.recurrences[value.index()];
        if self.is_bound(value) || matches!(recurrence, Recurrence::Component(_)) {
            let memory = self.memory(value, &quote!(k));
            return memory.unwrap_or_else(|| local("next", value).into_token_stream());
        }
        parenthesised(self.expression(value))
    }

    /// True if coefficient `k` of a value has a statement of its own.
    fn is_bound(&self, value: Value) -> bool {
        self.uses[value.index()] > 1 || self.jet.is_kept(value)
    }

    /// The place of a coefficient in the histories; `None` if it is a local variable.
    fn memory(&self, value: Value, order: &TokenStream) -> Option<TokenStream> {
        let Room::Histories(places) = &self.room else {
            return None;
        };
        let place = Literal::usize_unsuffixed(*places.get(&History::plain(value))?);
        Some(quote!(jets[#place][#order]))
    }

    /// Statements that compute order `k` of a value and store it.
    fn advance(&mut self, value: Value) -> TokenStream {
        let recurrence = &self.jet.recurrences[value.index()];
        let is_component = matches!(recurrence, Recurrence::Component(_));
        if !self.is_bound(value) {
            return TokenStream::new();
        }
        if self.keeps_first(value) {
            self.first(value);
        }
        let name = local("next", value);
        let expression = match is_component {
            true => quote!(#name),
            false => self.expression(value),
        };
        let binding = match self.memory(value, &quote!(k)) {
            Some(place) => quote!(#place = #expression;),
            None if is_component => TokenStream::new(),
            None => quote!(let #name = #expression;),
        };
        let next = self.next(value);
        let mut statements = binding;
        if let Room::Rows(layout) = &self.room
            && layout.is_steady(value)
        {
            let slope = local("slope", value);
            statements.extend(quote!(if k == 1 { #slope = #next; }));
        }
        for history in [History::plain(value), History::weighted(value)] {
            if let Some(place) = self.place(history) {
                let coefficient = match history.weighted {
                    true => quote!(weight * #next),
                    false => next.clone(),
                };
                statements.extend(quote!(#place = #coefficient;));
            }
        }
        statements
    }

    /// True if order 0 of a value is stored with its higher orders.
    fn keeps_first(&self, value: Value) -> bool {
        let history = History::plain(value);
        match &self.room {
            Room::Rows(layout) => {
                let alone = layout.alone().any(|kept| kept == history);
                alone || layout.multiplied().any(|kept| kept == value)
            }
            Room::Histories(places) => places.contains_key(&history),
        }
    }

    /// Storage of order `k` of a history; `None` if the coefficient was computed in place or is stored with others.
    fn place(&self, history: History) -> Option<TokenStream> {
        match &self.room {
            Room::Rows(layout) => layout.coefficient(history, &quote!(k)),
            Room::Histories(places) if history.weighted => {
                let place = Literal::usize_unsuffixed(*places.get(&history)?);
                Some(quote!(jets[#place][k]))
            }
            _ => None,
        }
    }
}

pub(super) fn parenthesised(tokens: TokenStream) -> TokenStream {
    TokenTree::from(Group::new(Delimiter::Parenthesis, tokens)).into()
}
