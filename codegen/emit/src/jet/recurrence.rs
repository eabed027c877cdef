//! Expression of Taylor coefficient `k` of one value, from the coefficients that it depends on.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::super::function::{Binding, joined};
use super::super::names::rational;
use super::layout::Sum;
use super::writer::{Room, Writer, parenthesised};
use dalembert_codegen::program::Value;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

impl Writer<'_> {
    pub(super) fn expression(&mut self, value: Value) -> TokenStream {
        let term = self.jet.term(value);
        self.written(&term).0
    }

    /// The tokens of a term, with the binding strength of their outermost operator.
    fn written(&mut self, term: &Term) -> (TokenStream, Binding) {
        let tokens = match term {
            Term::Zero => quote!(L::ZERO),
            Term::Time => quote!(if k == 1 { unit } else { L::ZERO }),
            Term::Number(number) => rational(number),
            Term::Order => quote!(weight),
            Term::InverseOrder => quote!(inverse),
            Term::Next(value) => self.next(*value),
            Term::First(value) => self.first(*value),
            Term::Inverse(value) => {
                let inverse = self.inverse(*value);
                quote!(#inverse)
            }
            Term::Neg(a) => {
                let a = self.operand(a, Binding::Product);
                return (joined([quote!(-), a]), Binding::Unary);
            }
            Term::Add(operands) => return self.binary(operands, &quote!(+), Binding::Sum),
            Term::Sub(operands) => return self.binary(operands, &quote!(-), Binding::Sum),
            Term::Mul(operands) => return self.binary(operands, &quote!(*), Binding::Product),
            Term::MulAdd(operands) => {
                let [a, b, c] = operands.each_ref().map(|operand| self.written(operand).0);
                quote!(L::mul_add(#a, #b, #c))
            }
            Term::Turned(operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.written(operand).0);
                quote!(L::turned(#a, #b))
            }
            Term::Middle(a, b) => self.middle(*a, *b),
            Term::Half(a) => self.half(*a),
            Term::Short(a, b, degree) => self.short(*a, *b, *degree),
            Term::Steady(a, b) => return (self.steady(*a, *b), Binding::Product),
        };
        (tokens, Binding::Atom)
    }

    fn binary(
        &mut self,
        operands: &[Term; 2],
        operator: &TokenStream,
        binding: Binding,
    ) -> (TokenStream, Binding) {
        let tighter = match binding {
            Binding::Sum => Binding::Product,
            _ => Binding::Unary,
        };
        let [a, b] = operands;
        let (a, b) = (self.operand(a, binding), self.operand(b, tighter));
        (joined([a, operator.clone(), b]), binding)
    }

    fn operand(&mut self, term: &Term, least: Binding) -> TokenStream {
        let (tokens, binding) = self.written(term);
        match binding < least {
            true => parenthesised(tokens),
            false => tokens,
        }
    }

    fn middle(&mut self, a: History, b: History) -> TokenStream {
        match &mut self.room {
            Room::Rows(layout) => named(layout.sum(Sum::Middle(a, b))),
            Room::Histories(places) => {
                let [a, b] = [a, b].map(|history| place(places.get(&history)));
                quote!(sum(&jets[#a], &jets[#b], k))
            }
        }
    }

    fn half(&mut self, a: Value) -> TokenStream {
        match &mut self.room {
            Room::Rows(layout) => named(layout.sum(Sum::Half(a))),
            Room::Histories(places) => {
                let a = place(places.get(&History::plain(a)));
                quote!(::dalembert::jet::half(&jets[#a], k))
            }
        }
    }

    fn short(&mut self, a: History, b: History, degree: usize) -> TokenStream {
        let length = Literal::usize_unsuffixed(degree);
        match &mut self.room {
            Room::Rows(layout) => {
                let [a, b] = [a, b].map(|history| layout.keep(history));
                quote!(::dalembert::jet::short(jets, #a, #b, k, #length))
            }
            Room::Histories(places) => {
                let [a, b] = [a, b].map(|history| place(places.get(&history)));
                quote!(::dalembert::jet::shared_short(&jets[#a], &jets[#b], k, #length))
            }
        }
    }

    fn steady(&mut self, a: Value, b: Value) -> TokenStream {
        match &mut self.room {
            Room::Rows(layout) => {
                let [slope, last] = layout.product_with_steady(a, b);
                quote!(#slope * #last)
            }
            // NOTE: large expansions contain no such term.
            Room::Histories(_) => TokenStream::new(),
        }
    }
}

fn named(name: Ident) -> TokenStream {
    quote!(#name)
}

fn place(place: Option<&usize>) -> Literal {
    Literal::usize_unsuffixed(place.copied().unwrap_or_default())
}
