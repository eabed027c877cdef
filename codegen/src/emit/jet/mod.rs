//! `TaylorField`: coefficients of the motion's power series, order after order.
//!
//! Order 0 is straight-line code like every other function. Above it one loop over the orders holds a statement for
//! each value that varies; sums over products of kept coefficients are calls ([`layout`]).

mod layout;
mod recurrence;
mod writer;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::function::joined;
use super::{Context, doc};
use crate::program::Program;
use crate::program::jet::Jet;
use writer::Writer;

/// `impl TaylorField`
pub(super) fn emit_taylor(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let Expansion {
        start,
        results,
        advance,
        next,
        keep,
        room,
    } = Expansion::of(&context.program.jet, context);
    let documentation = doc::lines(&[
        "The power series of the motion from `coefficients[0]`: coefficient `k + 1` of the state is coefficient `k` of \
         its rate over `k + 1`, in units of time."
            .to_string(),
    ]);
    let attributes = super::attributes();
    let work = work(context.program);
    quote! {
        #attributes
        impl ::dalembert::TaylorField for #type_name {
            type Jets = #room;

            const WORK: ::core::option::Option<::dalembert::jet::Work> = #work;

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
                    let (weight, inverse) = (k as f64, ::dalembert::jet::INVERSES[k]);
                    let step = unit * ::dalembert::jet::INVERSES[k + 1];
                    #advance
                    coefficients[k + 1] = ::dalembert::__private::vector([#(step * #next),*]);
                    #keep
                }
                ::core::result::Result::Ok(())
            }
        }
    }
}

/// The work of expansions, those of gaps included.
fn work(program: &Program) -> TokenStream {
    let gaps = program
        .impacting
        .as_ref()
        .map(|functions| &functions.gap_jet);
    let jets = || core::iter::once(&program.jet).chain(gaps);
    let values: usize = jets()
        .map(|jet| jet.function.cost.multiplications_alike())
        .sum();
    let sums: f64 = jets().map(Jet::sums).sum();
    let values = Literal::u32_unsuffixed(u32::try_from(values).unwrap_or(u32::MAX));
    // NOTE: the conversion saturates.
    let sums = Literal::u32_unsuffixed(sums.ceil() as u32);
    quote!(::core::option::Option::Some(::dalembert::jet::Work { values: #values, sums: #sums }))
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
        keep,
        room,
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
            let jets: &mut #room = &mut ::dalembert::jet::Jets::ZERO;
            #start
            gaps[0] = ::dalembert::__private::vector([#(#results),*]);
            for k in 1..=::core::cmp::Ord::min(order, ::dalembert::jet::LENGTH - 1) {
                let (weight, inverse) = (k as f64, ::dalembert::jet::INVERSES[k]);
                #advance
                gaps[k] = ::dalembert::__private::vector([#(#next),*]);
                #keep
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
    /// What is kept for the next order, after the results: they take coefficients of the one before.
    keep: TokenStream,
    /// The type of the room for coefficients.
    room: TokenStream,
}

impl Expansion {
    fn of(jet: &Jet, context: &Context<'_>) -> Self {
        // What is kept, and what is read of order 0, is known once the orders above it are written; how it is read, once
        // order 0 is. Where values go through memory it is known beforehand.
        let mut writer = Writer::of(jet, context);
        let mut orders = writer.orders();
        let mut histories = writer.begin_histories();
        let mut inverses = writer.begin_inverses();
        let (body, firsts) = writer.begin(context);
        let mut sum = TokenStream::new();
        if writer.is_large() {
            sum = quote!(let sum = ::dalembert::jet::shared_middle;);
        } else {
            writer = writer.again(firsts);
            orders = writer.orders();
            (histories, inverses) = (writer.begin_histories(), writer.begin_inverses());
        }
        let (advance, next, keep) = orders;
        Self {
            start: joined([sum, body.statements, inverses, histories]),
            results: body.outputs,
            advance,
            next,
            keep,
            room: writer.room.type_tokens(),
        }
    }
}
