//! `TaylorField`: coefficients of the motion's power series, order after order.
//!
//! Order 0 is straight-line code like every other function. Above it one loop over the orders holds a statement for
//! each value that varies; sums over products of kept coefficients are calls.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, Group, Ident, Literal, Span, TokenStream, TokenTree};
use quote::quote;

use super::function::{Body, emit_body, joined};
use super::{Context, doc};
use crate::program::jet::degree::Degree;
use crate::program::jet::{History, Jet, Recurrence};
use crate::program::{Function, Input, Op, Value};

/// Series kept up to which values of order `k` are locals and sums are written into the loop. What is larger calls one
/// shared sum and goes through memory: a compiler spends stack on every local of a function that is as long.
const LARGE: usize = 128;

/// `impl TaylorField`
pub(super) fn emit_taylor(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let Expansion {
        start,
        results,
        advance,
        next,
        kept,
    } = Expansion::of(&context.program.jet, context);
    let documentation = doc::lines(&[
        "The power series of the motion from `coefficients[0]`: coefficient `k + 1` of the state is coefficient `k` of \
         its rate over `k + 1`, in units of time."
            .to_string(),
    ]);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::TaylorField for #type_name {
            type Jets = [[f64; ::dalembert::jet::LENGTH]; #kept];

            #documentation
            #[inline]
            fn expand(
                &self,
                t: f64,
                unit: f64,
                order: usize,
                coefficients: &mut [Self::State; ::dalembert::jet::LENGTH],
                jets: &mut Self::Jets,
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                let state = &coefficients[0];
                #start
                coefficients[1] = ::dalembert::__private::vector([#(unit * (#results)),*]);
                for k in 1..::core::cmp::Ord::min(order, ::dalembert::jet::LENGTH - 1) {
                    let weight = k as f64;
                    let (inverse, step) = (1.0 / weight, unit / (weight + 1.0));
                    #advance
                    coefficients[k + 1] = ::dalembert::__private::vector([#(step * #next),*]);
                }
                ::core::result::Result::Ok(())
            }
        }
    }
}

/// `gap_series` of `Impacting`, if it tells where gaps vanish.
pub(super) fn emit_gap_series(context: &Context<'_>, jet: &Jet) -> TokenStream {
    if !jet.is_analytic() {
        return TokenStream::new();
    }
    let Expansion {
        start,
        results,
        advance,
        next,
        kept,
    } = Expansion::of(jet, context);
    quote! {
        #[inline]
        fn gap_series(
            &self,
            t: f64,
            unit: f64,
            order: usize,
            coefficients: &[Self::State; ::dalembert::jet::LENGTH],
            gaps: &mut [Self::Gaps; ::dalembert::jet::LENGTH],
        ) -> bool {
            let state = &coefficients[0];
            let jets = &mut [[0.0; ::dalembert::jet::LENGTH]; #kept];
            #start
            gaps[0] = ::dalembert::__private::vector([#(#results),*]);
            for k in 1..=::core::cmp::Ord::min(order, ::dalembert::jet::LENGTH - 1) {
                let weight = k as f64;
                let inverse = 1.0 / weight;
                #advance
                gaps[k] = ::dalembert::__private::vector([#(#next),*]);
            }
            true
        }
    }
}

/// The parts of an expansion.
struct Expansion {
    /// Order 0, with the first entries of all histories.
    start: TokenStream,
    /// The results at order 0.
    results: Vec<TokenStream>,
    /// Order `k` of every value that varies.
    advance: TokenStream,
    /// The results at order `k`.
    next: Vec<TokenStream>,
    /// Number of histories.
    kept: usize,
}

impl Expansion {
    fn of(jet: &Jet, context: &Context<'_>) -> Self {
        // What is read of order 0 is known once the orders above it are written; how it is read, once order 0 is. Where
        // values go through memory it is known beforehand.
        let mut draft = Writer::of(jet, context, Firsts::default());
        let (advance, next) = draft.orders();
        if draft.is_large {
            let (histories, inverses) = (draft.begin_histories(), draft.begin_inverses());
            let kept = draft.slots.len();
            let (body, _) = draft.begin(context);
            let statements = body.statements;
            let sum = quote!(let sum = ::dalembert::jet::shared_middle;);
            return Self {
                start: joined([sum, statements, inverses, histories]),
                results: body.outputs,
                advance,
                next,
                kept,
            };
        }
        let (body, firsts) = draft.begin(context);
        let mut writer = Writer::of(jet, context, firsts);
        let (advance, next) = writer.orders();
        let (histories, inverses) = (writer.begin_histories(), writer.begin_inverses());
        let statements = body.statements;
        Self {
            start: joined([statements, inverses, histories]),
            results: body.outputs,
            advance,
            next,
            kept: writer.slots.len(),
        }
    }
}

fn parenthesised(tokens: TokenStream) -> TokenStream {
    TokenTree::from(Group::new(Delimiter::Parenthesis, tokens)).into()
}

fn local(prefix: &str, value: Value) -> Ident {
    Ident::new(&format!("{prefix}_{}", value.index()), Span::mixed_site())
}

/// How order 0 of values is read above it.
type Firsts = BTreeMap<Value, TokenStream>;

struct Writer<'a> {
    jet: &'a Jet,
    parameters: &'a [TokenStream],
    /// Number of components of the state.
    components: usize,
    is_large: bool,
    /// How often coefficient `k` of each value is read.
    uses: Vec<usize>,
    /// Places of the histories.
    slots: BTreeMap<History, usize>,
    firsts: Firsts,
    /// Values whose order 0 is read, and those whose reciprocal is.
    read: BTreeSet<Value>,
    inverses: BTreeSet<Value>,
}

impl<'a> Writer<'a> {
    fn of(jet: &'a Jet, context: &'a Context<'_>, firsts: Firsts) -> Self {
        let uses = jet.uses();
        let is_large = jet.histories.len() > LARGE;
        let mut histories: BTreeSet<History> = jet.histories.iter().copied().collect();
        if is_large {
            let bound = |value: &Value| uses[value.index()] > 1 || jet.is_kept(*value);
            histories.extend(jet.varying().filter(bound).map(History::plain));
        }
        let slots = histories.into_iter().enumerate();
        Self {
            jet,
            parameters: &context.names.parameters,
            components: context.dimension() + context.motion_dimension(),
            is_large,
            uses,
            slots: slots.map(|(slot, history)| (history, slot)).collect(),
            firsts,
            read: BTreeSet::new(),
            inverses: BTreeSet::new(),
        }
    }

    /// Order `k` of every value that varies, and of the results.
    fn orders(&mut self) -> (TokenStream, Vec<TokenStream>) {
        let varying: Vec<Value> = self.jet.varying().collect();
        let components = self.bind_components(&varying);
        let values = varying.iter().map(|&value| self.advance(value));
        let values: TokenStream = values.collect();
        let outputs = self.jet.function.outputs.iter();
        let next = outputs.map(|&output| match self.jet.recurrences[output.index()] {
            Recurrence::Constant => quote!(0.0),
            _ => self.next(output),
        });
        let next = next.collect();
        (joined([components, values]), next)
    }

    /// `let [next_0, _] = components(&coefficients[k]);`
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
        quote!(let [#(#locals),*] = ::dalembert::__private::components(&coefficients[k]);)
    }

    /// The statements of order 0, the results, and how everything that is read of it is.
    fn begin(self, context: &Context<'_>) -> (Body, Firsts) {
        let function = &self.jet.function;
        let results = function.outputs.len();
        let read: Vec<Value> = self.read.union(&self.inverses).copied().collect();
        let mut outputs = function.outputs.clone();
        outputs.extend(&read);
        let extended = Function {
            ops: function.ops.clone(),
            names: function.names.clone(),
            outputs,
            cost: function.cost,
        };
        let bindings = context.bind_state(&extended);
        let Body {
            statements,
            mut outputs,
        } = emit_body(&extended, &context.names);
        let mut statements = joined([bindings, statements]);
        let mut firsts = Firsts::new();
        for (value, piece) in read.into_iter().zip(outputs.split_off(results)) {
            let is_name = piece.clone().into_iter().count() == 1;
            let first = match self.slots.get(&History::plain(value)) {
                Some(slot) if self.is_large => {
                    let slot = Literal::usize_unsuffixed(*slot);
                    statements.extend(quote!(jets[#slot][0] = #piece;));
                    quote!(jets[#slot][0])
                }
                _ if is_name && !self.is_large => piece,
                _ => {
                    let first = local("first", value);
                    statements.extend(quote!(let #first = #piece;));
                    quote!(#first)
                }
            };
            firsts.insert(value, first);
        }
        let body = Body {
            statements,
            outputs,
        };
        (body, firsts)
    }

    fn begin_inverses(&mut self) -> TokenStream {
        let inverses = self.inverses.clone().into_iter().map(|value| {
            let (inverse, value) = (local("inverse", value), self.first(value));
            quote!(let #inverse = 1.0 / #value;)
        });
        inverses.collect()
    }

    fn begin_histories(&mut self) -> TokenStream {
        let slots = self.slots.clone().into_iter();
        let entries = slots.filter_map(|(history, slot)| {
            let slot = Literal::usize_unsuffixed(slot);
            match history.weighted {
                true => Some(quote!(jets[#slot][0] = 0.0;)),
                false if self.is_large => None,
                false => {
                    let first = self.first(history.value);
                    Some(quote!(jets[#slot][0] = #first;))
                }
            }
        });
        entries.collect()
    }

    /// Order 0 of a value.
    fn first(&mut self, value: Value) -> TokenStream {
        match &self.jet.function.ops[value.index()] {
            Op::Number(number) => super::function::number(number.to_f64()),
            Op::Pi => quote!(::core::f64::consts::PI),
            Op::Input(Input::Parameter(k)) => self.parameters[*k].clone(),
            _ => {
                self.read.insert(value);
                let known = self.firsts.get(&value).cloned();
                known.unwrap_or_else(|| self.place_of_first(value))
            }
        }
    }

    /// Where order 0 of a value is kept.
    fn place_of_first(&self, value: Value) -> TokenStream {
        match self.slots.get(&History::plain(value)) {
            Some(slot) if self.is_large => {
                let slot = Literal::usize_unsuffixed(*slot);
                quote!(jets[#slot][0])
            }
            _ => {
                let first = local("first", value);
                quote!(#first)
            }
        }
    }

    /// The reciprocal of a value's order 0.
    fn inverse(&mut self, value: Value) -> Ident {
        self.first(value);
        self.inverses.insert(value);
        local("inverse", value)
    }

    /// Coefficient `k` of a value.
    fn next(&mut self, value: Value) -> TokenStream {
        let recurrence = &self.jet.recurrences[value.index()];
        if self.is_bound(value) || matches!(recurrence, Recurrence::Component(_)) {
            return match self.slots.get(&History::plain(value)) {
                Some(slot) if self.is_large => {
                    let slot = Literal::usize_unsuffixed(*slot);
                    quote!(jets[#slot][k])
                }
                _ => {
                    let next = local("next", value);
                    quote!(#next)
                }
            };
        }
        parenthesised(self.expression(value, &recurrence.clone()))
    }

    /// Whether coefficient `k` of a value is a statement of its own.
    fn is_bound(&self, value: Value) -> bool {
        self.uses[value.index()] > 1 || self.jet.is_kept(value)
    }

    /// The coefficients of a value that are kept.
    fn history(&self, value: Value, weighted: bool) -> TokenStream {
        let history = History { value, weighted };
        let slot = self.slots.get(&history).copied().unwrap_or_default();
        let slot = Literal::usize_unsuffixed(slot);
        quote!(jets[#slot])
    }

    /// Order `k` of a value, and its place in the histories.
    fn advance(&mut self, value: Value) -> TokenStream {
        let recurrence = self.jet.recurrences[value.index()].clone();
        let is_component = matches!(recurrence, Recurrence::Component(_));
        if !self.is_bound(value) {
            return TokenStream::new();
        }
        // The draft needs no histories; order 0 of each is read.
        let plain = self.slots.contains_key(&History::plain(value));
        if plain {
            self.first(value);
        }
        let name = local("next", value);
        let expression = match is_component {
            true => quote!(#name),
            false => self.expression(value, &recurrence),
        };
        let (place, next) = (self.history(value, false), self.next(value));
        let binding = match (self.is_large, is_component) {
            (true, _) => joined([place, quote!([k] =), expression, quote!(;)]),
            (false, true) if plain => quote!(#place[k] = #next;),
            (false, true) => TokenStream::new(),
            (false, false) => {
                let keep = plain.then(|| quote!(#place[k] = #next;));
                quote!(let #name = #expression; #keep)
            }
        };
        let weighted = self.slots.contains_key(&History {
            value,
            weighted: true,
        });
        let weighted = weighted.then(|| {
            let place = self.history(value, true);
            quote!(#place[k] = weight * #next;)
        });
        joined([binding, weighted.unwrap_or_default()])
    }

    fn expression(&mut self, value: Value, recurrence: &Recurrence) -> TokenStream {
        match recurrence {
            Recurrence::Constant | Recurrence::Component(_) => quote!(0.0),
            Recurrence::Time => quote!(if k == 1 { unit } else { 0.0 }),
            Recurrence::Same(a) => {
                let a = self.next(*a);
                quote!(#a)
            }
            Recurrence::Neg(a) => {
                let a = self.next(*a);
                quote!(-#a)
            }
            Recurrence::Add(a, b) => {
                let (a, b) = (self.next(*a), self.next(*b));
                joined([a, quote!(+), b])
            }
            Recurrence::Sub(a, b) => {
                let (a, b) = (self.next(*a), self.next(*b));
                joined([a, quote!(-), b])
            }
            Recurrence::Scaled(a, b) => {
                let (a, b) = (self.first(*a), self.next(*b));
                joined([a, quote!(*), b])
            }
            Recurrence::Divided(a, b) => {
                let (a, b) = (self.next(*a), self.inverse(*b));
                quote!(#a * #b)
            }
            Recurrence::Product(a, b) => self.product(*a, *b),
            Recurrence::Square(a) => {
                let (history, first, next) =
                    (self.history(*a, false), self.first(*a), self.next(*a));
                quote!(2.0 * (::dalembert::jet::half(&#history, k) + #first * #next))
            }
            Recurrence::Quotient(a, b) => {
                let (known, inverse) = (self.upper_sum(*b, value), self.inverse(*b));
                match a {
                    Some(a) => {
                        let a = self.next(*a);
                        quote!((#a - #known) * #inverse)
                    }
                    None => quote!(-#known * #inverse),
                }
            }
            Recurrence::Root(a) => {
                let (history, a, inverse) = (
                    self.history(value, false),
                    self.next(*a),
                    self.inverse(value),
                );
                quote!((0.5 * #a - ::dalembert::jet::half(&#history, k)) * #inverse)
            }
            Recurrence::Power(a, exponent) => {
                let exponent = super::function::number(exponent.to_f64());
                let (rising, known) = (
                    self.weighted_sum(*a, value),
                    self.middle((value, true), (*a, false)),
                );
                let inverse = self.inverse(*a);
                quote!((#exponent * #rising - #known) * inverse * #inverse)
            }
            Recurrence::Integral { of, by, negative } => {
                let rate = self.weighted_sum(*of, *by);
                let sign = negative.then(|| quote!(-));
                quote!(#sign #rate * inverse)
            }
            Recurrence::IntegralQuotient { of, by, negative } => {
                let known = self.middle((value, true), (*by, false));
                let (of, inverse) = (self.next(*of), self.inverse(*by));
                let sign = negative.then(|| quote!(-));
                quote!((#sign weight * #of - #known) * inverse * #inverse)
            }
            Recurrence::Angle { y, x, squared } => {
                let (rise, fall) = (self.weighted_sum(*y, *x), self.weighted_sum(*x, *y));
                let known = self.middle((value, true), (*squared, false));
                let inverse = self.inverse(*squared);
                quote!((#rise - #fall - #known) * inverse * #inverse)
            }
            Recurrence::Absolute(a) => {
                let (first, next) = (self.first(*a), self.next(*a));
                quote!(if #first < 0.0 { -#next } else { #next })
            }
        }
    }

    /// `sum a_j b_(k-j)` for `j` in `0..=k`.
    fn product(&mut self, a: Value, b: Value) -> TokenStream {
        let degree = |value: Value| self.jet.degrees[value.index()];
        let (a, b) = if degree(b) < degree(a) {
            (b, a)
        } else {
            (a, b)
        };
        let (first, next) = (self.first(a), self.next(b));
        let rest = self.upper_sum(a, b);
        parenthesised(joined([first, quote!(*), next, quote!(+), rest]))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`.
    fn upper_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(short) = self.short((a, false), (b, false)) {
            return short;
        }
        let middle = self.middle((a, false), (b, false));
        let (next, first) = (self.next(a), self.first(b));
        quote!((#middle + #next * #first))
    }

    /// `sum j a_j b_(k-j)` for `j` in `1..=k`.
    fn weighted_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(short) = self.short((a, true), (b, false)) {
            return short;
        }
        let middle = self.middle((a, true), (b, false));
        let (next, first) = (self.next(a), self.first(b));
        quote!((#middle + weight * #next * #first))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..k`.
    fn middle(&self, a: (Value, bool), b: (Value, bool)) -> TokenStream {
        let (a, b) = (self.history(a.0, a.1), self.history(b.0, b.1));
        match self.is_large {
            true => quote!(sum(&#a, &#b, k)),
            false => quote!(::dalembert::jet::middle(&#a, &#b, k)),
        }
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`, if the series of `a` ends.
    fn short(&self, a: (Value, bool), b: (Value, bool)) -> Option<TokenStream> {
        let Degree::AtMost(degree) = self.jet.degrees[a.0.index()] else {
            return None;
        };
        let (a, b) = (self.history(a.0, a.1), self.history(b.0, b.1));
        let degree = Literal::usize_unsuffixed(degree as usize);
        Some(quote!(::dalembert::jet::short(&#a, &#b, k, #degree)))
    }
}
