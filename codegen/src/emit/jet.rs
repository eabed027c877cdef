//! `TaylorField`: coefficients of the motion's power series, order after order.
//!
//! Order 0 is straight-line code like every other function. Above it one loop over the orders holds a statement for
//! each value that varies; sums over products of kept coefficients are calls.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::function::{Body, emit_body};
use super::{Context, doc};
use crate::program::jet::degree::Degree;
use crate::program::jet::{Jet, Recurrence};
use crate::program::{Function, Input, Op, Value};

/// Sums written into the loop up to this many; functions with more of them call one that is shared. The loop of a
/// chain of eight links is as large as a compiler optimises in good time, and a call no longer matters there.
const WRITTEN_OUT: usize = 96;

/// `impl TaylorField`
pub(super) fn emit_taylor(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let jet = &context.program.jet;
    let expansion = Expansion::of(jet, context);
    let outputs = &jet.function.outputs;
    let derivatives = outputs.iter().map(|&output| expansion.rate(output));
    let series = doc::lines(&[
        "The power series of the motion from `coefficients[0]`, in units of time: state `k + 1` is rate `k` over \
         `k + 1`."
            .to_string(),
    ]);
    let (start, kept, advance) = (&expansion.start, jet.histories.len(), &expansion.advance);
    let first = &expansion.results;
    let components = expansion.bind_components(jet);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::TaylorField for #type_name {
            type Jets = [[f64; ::dalembert::__private::jet::LENGTH]; #kept];

            #series
            #[inline]
            fn expand(
                &self,
                t: f64,
                unit: f64,
                order: usize,
                coefficients: &mut [Self::State; ::dalembert::__private::jet::LENGTH],
                jets: &mut Self::Jets,
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                let state = &coefficients[0];
                #start
                coefficients[1] = ::dalembert::__private::vector([#(unit * (#first)),*]);
                let order = ::core::cmp::Ord::min(order, ::dalembert::__private::jet::LENGTH - 1);
                for k in 1..order {
                    let weight = k as f64;
                    let (inverse, step) = (1.0 / weight, unit / (weight + 1.0));
                    #components
                    #advance
                    coefficients[k + 1] = ::dalembert::__private::vector([#(#derivatives),*]);
                }
                ::core::result::Result::Ok(())
            }
        }
    }
}

/// The two parts of an expansion, and what they share.
struct Expansion<'a> {
    jet: &'a Jet,
    /// Order 0, with the first entries of all histories.
    start: TokenStream,
    /// The results at order 0.
    results: Vec<TokenStream>,
    /// Order `k` of every value that varies.
    advance: TokenStream,
}

impl<'a> Expansion<'a> {
    fn of(jet: &'a Jet, context: &Context<'_>) -> Self {
        let mut writer = Writer::of(jet, context);
        let varying: Vec<Value> = jet.varying().collect();
        let advance: TokenStream = varying.iter().map(|&value| writer.advance(value)).collect();
        let histories: TokenStream = (0..jet.histories.len())
            .map(|slot| writer.begin_history(slot))
            .collect();
        let inverses: TokenStream = writer
            .inverses
            .clone()
            .into_iter()
            .map(|value| {
                let (inverse, value) = (local("inverse", value), writer.first(value));
                quote!(let #inverse = 1.0 / #value;)
            })
            .collect();
        let (start, results) = writer.start(context);
        Self {
            jet,
            start: quote!(#start #inverses #histories),
            results,
            advance,
        }
    }

    /// `next_3 / (k + 1)` in units of time.
    fn rate(&self, output: Value) -> TokenStream {
        match self.jet.recurrences[output.index()] {
            Recurrence::Constant => quote!(0.0),
            _ => {
                let next = local("next", output);
                quote!(step * #next)
            }
        }
    }

    /// `let [next_0, _] = components(&coefficients[k]);`
    fn bind_components(&self, jet: &Jet) -> TokenStream {
        let count = jet.function.outputs.len();
        let mut locals = vec![quote!(_); count];
        let mut any = false;
        for value in jet.varying() {
            if let Recurrence::Component(i) = jet.recurrences[value.index()] {
                let next = local("next", value);
                locals[i] = quote!(#next);
                any = true;
            }
        }
        match any {
            true => quote! {
                let [#(#locals),*] = ::dalembert::__private::components(&coefficients[k]);
            },
            false => TokenStream::new(),
        }
    }
}

fn local(prefix: &str, value: Value) -> Ident {
    Ident::new(&format!("{prefix}_{}", value.index()), Span::mixed_site())
}

struct Writer<'a> {
    jet: &'a Jet,
    parameters: &'a [TokenStream],
    /// Values whose order 0 is read above order 0.
    firsts: BTreeSet<Value>,
    /// Values whose reciprocal at order 0 is.
    inverses: BTreeSet<Value>,
    middle: Ident,
}

impl<'a> Writer<'a> {
    fn of(jet: &'a Jet, context: &'a Context<'_>) -> Self {
        let sums = jet.histories.len();
        let middle = if sums <= WRITTEN_OUT {
            "middle"
        } else {
            "shared_middle"
        };
        Self {
            jet,
            parameters: &context.names.parameters,
            firsts: BTreeSet::new(),
            inverses: BTreeSet::new(),
            middle: Ident::new(middle, Span::call_site()),
        }
    }

    /// Order 0 of a value.
    fn first(&mut self, value: Value) -> TokenStream {
        match &self.jet.function.ops[value.index()] {
            Op::Number(number) => super::function::number(number.to_f64()),
            Op::Pi => quote!(::core::f64::consts::PI),
            Op::Input(Input::Parameter(k)) => self.parameters[*k].clone(),
            _ => {
                self.firsts.insert(value);
                let first = local("first", value);
                quote!(#first)
            }
        }
    }

    /// The reciprocal of a value's order 0.
    fn inverse(&mut self, value: Value) -> Ident {
        self.inverses.insert(value);
        local("inverse", value)
    }

    /// The coefficients of a value that are kept.
    fn history(&self, value: Value, weighted: bool) -> TokenStream {
        let slot = self.jet.slot(value, weighted).unwrap_or_default();
        let slot = Literal::usize_unsuffixed(slot);
        quote!(jets[#slot])
    }

    fn begin_history(&mut self, slot: usize) -> TokenStream {
        let history = self.jet.histories[slot];
        let place = self.history(history.value, history.weighted);
        let first = match history.weighted {
            true => quote!(0.0),
            false => self.first(history.value),
        };
        quote!(#place[0] = #first;)
    }

    /// Order 0, and the results.
    fn start(self, context: &Context<'_>) -> (TokenStream, Vec<TokenStream>) {
        let function = &self.jet.function;
        let results = function.outputs.len();
        let mut outputs = function.outputs.clone();
        outputs.extend(&self.firsts);
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
        let values = outputs.split_off(results);
        let firsts = self.firsts.iter().zip(values).map(|(value, piece)| {
            let first = local("first", *value);
            quote!(let #first = #piece;)
        });
        (quote!(#bindings #statements #(#firsts)*), outputs)
    }

    /// Order `k` of a value, and its place in the histories.
    fn advance(&mut self, value: Value) -> TokenStream {
        let next = local("next", value);
        let binding = match &self.jet.recurrences[value.index()] {
            Recurrence::Component(_) => TokenStream::new(),
            recurrence => {
                let expression = self.expression(value, &recurrence.clone());
                quote!(let #next = #expression;)
            }
        };
        let keep = [false, true].map(|weighted| {
            let _slot = self.jet.slot(value, weighted)?;
            let place = self.history(value, weighted);
            Some(match weighted {
                true => quote!(#place[k] = weight * #next;),
                false => quote!(#place[k] = #next;),
            })
        });
        let [plain, weighted] = keep;
        quote!(#binding #plain #weighted)
    }

    fn expression(&mut self, value: Value, recurrence: &Recurrence) -> TokenStream {
        let next = |value: &Value| local("next", *value);
        match recurrence {
            Recurrence::Constant | Recurrence::Component(_) => quote!(0.0),
            Recurrence::Time => quote!(if k == 1 { unit } else { 0.0 }),
            Recurrence::Same(a) => {
                let a = next(a);
                quote!(#a)
            }
            Recurrence::Neg(a) => {
                let a = next(a);
                quote!(-#a)
            }
            Recurrence::Add(a, b) => {
                let (a, b) = (next(a), next(b));
                quote!(#a + #b)
            }
            Recurrence::Sub(a, b) => {
                let (a, b) = (next(a), next(b));
                quote!(#a - #b)
            }
            Recurrence::Scaled(a, b) => {
                let (a, b) = (self.first(*a), next(b));
                quote!(#a * #b)
            }
            Recurrence::Divided(a, b) => {
                let (a, b) = (next(a), self.inverse(*b));
                quote!(#a * #b)
            }
            Recurrence::Product(a, b) => self.product(*a, *b),
            Recurrence::Square(a) => {
                let (history, first, next) =
                    (self.history(*a, false), self.first(*a), next(a));
                quote!(2.0 * (::dalembert::__private::jet::half(&#history, k) + #first * #next))
            }
            Recurrence::Quotient(a, b) => {
                let (known, inverse) = (self.upper_sum(*b, value), self.inverse(*b));
                match a {
                    Some(a) => {
                        let a = next(a);
                        quote!((#a - #known) * #inverse)
                    }
                    None => quote!(-#known * #inverse),
                }
            }
            Recurrence::Root(a) => {
                let (history, a, inverse) = (
                    self.history(value, false),
                    next(a),
                    self.inverse(value),
                );
                quote!((0.5 * #a - ::dalembert::__private::jet::half(&#history, k)) * #inverse)
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
                let (of, inverse) = (next(of), self.inverse(*by));
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
                let (first, next) = (self.first(*a), next(a));
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
        let (first, next) = (self.first(a), local("next", b));
        let rest = self.upper_sum(a, b);
        quote!((#first * #next + #rest))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`.
    fn upper_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(short) = self.short((a, false), (b, false)) {
            return short;
        }
        let middle = self.middle((a, false), (b, false));
        let (next, first) = (local("next", a), self.first(b));
        quote!((#middle + #next * #first))
    }

    /// `sum j a_j b_(k-j)` for `j` in `1..=k`.
    fn weighted_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(short) = self.short((a, true), (b, false)) {
            return short;
        }
        let middle = self.middle((a, true), (b, false));
        let (next, first) = (local("next", a), self.first(b));
        quote!((#middle + weight * #next * #first))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..k`.
    fn middle(&self, a: (Value, bool), b: (Value, bool)) -> TokenStream {
        let (a, b) = (self.history(a.0, a.1), self.history(b.0, b.1));
        let middle = &self.middle;
        quote!(::dalembert::__private::jet::#middle(&#a, &#b, k))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`, if the series of `a` ends.
    fn short(&self, a: (Value, bool), b: (Value, bool)) -> Option<TokenStream> {
        let Degree::AtMost(degree) = self.jet.degrees[a.0.index()] else {
            return None;
        };
        let (a, b) = (self.history(a.0, a.1), self.history(b.0, b.1));
        let degree = Literal::usize_unsuffixed(degree as usize);
        Some(quote!(::dalembert::__private::jet::short(&#a, &#b, k, #degree)))
    }
}
