//! Coefficient `k` of one value from those it follows from.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::super::function::joined;
use super::super::names::rational;
use super::layout::Sum;
use super::writer::{Room, Writer, parenthesised};
use crate::program::Value;
use crate::program::jet::degree::Degree;
use crate::program::jet::{History, Recurrence};

impl Writer<'_> {
    pub(super) fn expression(&mut self, value: Value, recurrence: &Recurrence) -> TokenStream {
        match recurrence {
            Recurrence::Constant | Recurrence::Component(_) => quote!(L::ZERO),
            Recurrence::Time => quote!(if k == 1 { unit } else { L::ZERO }),
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
                let (half, first, next) = (self.half(*a), self.first(*a), self.next(*a));
                quote!(L::of(2.0) * L::mul_add(#first, #next, #half))
            }
            Recurrence::Quotient(a, b) => self.quotient(value, *a, *b),
            Recurrence::Root(a) => {
                let (half, a, inverse) = (self.half(value), self.next(*a), self.inverse(value));
                quote!((L::of(0.5) * #a - #half) * #inverse)
            }
            Recurrence::Power(a, exponent) => {
                let exponent = rational(exponent);
                let rising = self.weighted_sum(*a, value);
                let known = self.middle(History::weighted(value), History::plain(*a));
                let inverse = self.inverse(*a);
                quote!((#exponent * #rising - #known) * inverse * #inverse)
            }
            Recurrence::Integral { of, by, negative } => {
                let sign = negative.then(|| quote!(-));
                let integral = self.integral(*of, *by);
                quote!(#sign #integral)
            }
            Recurrence::IntegralQuotient { of, by, negative } => {
                let known = self.middle(History::weighted(value), History::plain(*by));
                let (of, inverse) = (self.next(*of), self.inverse(*by));
                let sign = negative.then(|| quote!(-));
                quote!((#sign #of - inverse * #known) * #inverse)
            }
            Recurrence::Angle { y, x, squared } => self.angle(value, [*y, *x, *squared]),
            Recurrence::Absolute(a) => {
                let (first, next) = (self.first(*a), self.next(*a));
                quote!(L::turned(#next, #first))
            }
        }
    }

    /// `sum a_j b_(k-j)` for `j` in `0..=k`.
    fn product(&mut self, a: Value, b: Value) -> TokenStream {
        let degree = |value: Value| self.jet.degrees[value.index()];
        // The value that is known last comes into the sum last.
        let (a, b) = match (degree(a), a.index()) > (degree(b), b.index()) {
            true => (b, a),
            false => (a, b),
        };
        let (first, next) = (self.first(a), self.next(b));
        if degree(a) == Degree::Endless && self.is_early(a) && self.is_early(b) {
            let middle = self.middle(History::plain(a), History::plain(b));
            let (other_next, other_first) = (self.next(a), self.first(b));
            return parenthesised(quote! {
                L::mul_add(#first, #next, #other_next * #other_first) + #middle
            });
        }
        let rest = self.upper_sum(a, b);
        quote!(L::mul_add(#first, #next, #rest))
    }

    /// Whether coefficient `k` of a value is known when order `k` begins, before the sums over lower orders are.
    fn is_early(&self, value: Value) -> bool {
        matches!(
            self.jet.recurrences[value.index()],
            Recurrence::Component(_) | Recurrence::Time
        )
    }

    fn quotient(&mut self, value: Value, a: Option<Value>, b: Value) -> TokenStream {
        let (known, inverse) = (self.upper_sum(b, value), self.inverse(b));
        match a {
            Some(a) => {
                let a = self.next(a);
                quote!((#a - #known) * #inverse)
            }
            None => quote!(-#known * #inverse),
        }
    }

    fn angle(&mut self, value: Value, [y, x, squared]: [Value; 3]) -> TokenStream {
        let (rise, fall) = (self.weighted_sum(y, x), self.weighted_sum(x, y));
        let known = self.middle(History::weighted(value), History::plain(squared));
        let inverse = self.inverse(squared);
        quote!((#rise - #fall - #known) * inverse * #inverse)
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`.
    fn upper_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(product) = self.product_with_constant(a, b) {
            return product;
        }
        let (rising, other) = (History::plain(a), History::plain(b));
        if let Some(short) = self.short(rising, other) {
            return short;
        }
        let middle = self.middle(rising, other);
        let (next, first) = (self.next(a), self.first(b));
        quote!(L::mul_add(#next, #first, #middle))
    }

    /// `a_k b_0`, all that is left of a sum where one of the two is constant.
    fn product_with_constant(&mut self, a: Value, b: Value) -> Option<TokenStream> {
        let is_constant =
            |value: Value| self.jet.recurrences[value.index()] == Recurrence::Constant;
        match (is_constant(a), is_constant(b)) {
            (true, _) => Some(quote!(L::ZERO)),
            (false, true) => {
                let (next, first) = (self.next(a), self.first(b));
                Some(parenthesised(quote!(#next * #first)))
            }
            (false, false) => None,
        }
    }

    /// `sum j a_j b_(k-j)` for `j` in `1..=k`.
    fn weighted_sum(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(product) = self.product_with_constant(a, b) {
            return quote!(weight * #product);
        }
        let (rising, other) = (History::weighted(a), History::plain(b));
        if let Some(short) = self.short(rising, other) {
            return short;
        }
        let middle = self.middle(rising, other);
        let (next, first) = (self.next(a), self.first(b));
        quote!(L::mul_add(weight * #next, #first, #middle))
    }

    /// `sum j/k a_j b_(k-j)` for `j` in `1..=k`.
    fn integral(&mut self, a: Value, b: Value) -> TokenStream {
        if let Some(product) = self.product_with_constant(a, b) {
            return product;
        }
        let (rising, other) = (History::weighted(a), History::plain(b));
        if let Some(short) = self.short(rising, other) {
            return quote!(inverse * #short);
        }
        let middle = self.middle(rising, other);
        let (next, first) = (self.next(a), self.first(b));
        quote!(L::mul_add(inverse, #middle, #next * #first))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..k`.
    fn middle(&mut self, a: History, b: History) -> TokenStream {
        match &mut self.room {
            Room::Rows(layout) => named(layout.sum(Sum::Middle(a, b))),
            Room::Histories(places) => {
                let [a, b] = [a, b].map(|history| place(places.get(&history)));
                quote!(sum(&jets[#a], &jets[#b], k))
            }
        }
    }

    /// Half of `sum a_j a_(k-j)` for `j` in `1..k`.
    fn half(&mut self, a: Value) -> TokenStream {
        match &mut self.room {
            Room::Rows(layout) => named(layout.sum(Sum::Half(a))),
            Room::Histories(places) => {
                let a = place(places.get(&History::plain(a)));
                quote!(::dalembert::jet::half(&jets[#a], k))
            }
        }
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`, if the series of `a` ends.
    fn short(&mut self, a: History, b: History) -> Option<TokenStream> {
        let Degree::AtMost(degree) = self.jet.degrees[a.value.index()] else {
            return None;
        };
        let length = Literal::usize_unsuffixed(degree as usize);
        Some(match &mut self.room {
            Room::Rows(layout) if degree == 1 => {
                let [slope, last] = layout.product_with_steady(a.value, b.value);
                quote!(#slope * #last)
            }
            Room::Rows(layout) => {
                let [a, b] = [a, b].map(|history| layout.keep(history));
                quote!(::dalembert::jet::short(jets, #a, #b, k, #length))
            }
            Room::Histories(places) => {
                let [a, b] = [a, b].map(|history| place(places.get(&history)));
                quote!(::dalembert::jet::shared_short(&jets[#a], &jets[#b], k, #length))
            }
        })
    }
}

fn named(name: Ident) -> TokenStream {
    quote!(#name)
}

fn place(place: Option<&usize>) -> Literal {
    Literal::usize_unsuffixed(place.copied().unwrap_or_default())
}
