//! `TaylorField`: Taylor coefficients of the motion and of the gaps along it, order after order.
//!
//! Order 0 is straight-line code like every other function. For higher orders, one loop contains a statement for each
//! value that varies. Sums over products of stored coefficients are calls ([`layout`]). Both parts are generic over
//! `L: Numbers`: one motion, or several motions in SIMD lanes.

mod layout;
mod recurrence;
mod writer;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::constants::Constant;
use super::function::{Body, emit_body, joined};
use super::{Context, doc};
use dalembert_codegen::program::jet::Jet;
use dalembert_codegen::program::{Function, Value};
use writer::Writer;

/// `impl TaylorField`
pub(super) fn emit_taylor(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let jet = &context.form.program.jet;
    let components = context.form.dimension() + context.form.motion_dimension();
    let gaps = jet.function.outputs.len() - components;
    let places = &context.names.parameters;
    let parameters = places.len();
    let Expansion {
        begin,
        known,
        advance,
        room,
    } = Expansion::of(jet, context);
    let documentation = doc::lines(&[
        "The power series of the motion from `coefficients[0]`: coefficient `k + 1` of the state is coefficient `k` of \
         its rate times `unit/(k + 1)`. The series of the gaps follow from that of the state."
            .to_string(),
    ]);
    let attributes = super::attributes();
    let work = Some(context.form.work()).tokens();
    quote! {
        #attributes
        impl ::dalembert::TaylorField for #type_name {
            type Parameters<L: ::dalembert::numbers::Numbers> = [L; #parameters];
            type Row<L: ::dalembert::numbers::Numbers> = [L; #components];
            type Gaps<L: ::dalembert::numbers::Numbers> = [L; #gaps];
            type Firsts<L: ::dalembert::numbers::Numbers> = [L; #known];
            type Jets<L: ::dalembert::numbers::Numbers> = #room;

            #[inline(always)]
            fn work(&self) -> ::core::option::Option<::dalembert::jet::Work> { #work }

            #[inline]
            fn parameters(&self) -> [f64; #parameters] {
                [#(#places),*]
            }

            #[inline]
            fn begin<L: ::dalembert::numbers::Numbers>(
                &self,
                parameters: &[L; #parameters],
                t: L,
                state: &[L; #components],
                firsts: &mut [L; #known],
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #begin
                ::core::result::Result::Ok(())
            }

            #documentation
            #[inline]
            fn advance<L: ::dalembert::numbers::Numbers>(
                &self,
                parameters: &[L; #parameters],
                unit: L,
                order: usize,
                firsts: &[L; #known],
                coefficients: &mut [[L; #components]; ::dalembert::jet::LENGTH],
                gaps: &mut [[L; #gaps]; ::dalembert::jet::LENGTH],
                jets: &mut #room,
            ) {
                #advance
            }
        }
    }
}

/// The parts of the generated expansion.
struct Expansion {
    /// Statements of order 0.
    begin: TokenStream,
    /// Number of values known at order 0.
    known: usize,
    /// Statements of all higher orders.
    advance: TokenStream,
    /// Type of the array that stores coefficients.
    room: TokenStream,
}

impl Expansion {
    fn of(jet: &Jet, context: &Context<'_>) -> Self {
        // The first pass finds the coefficients to store. The statements of a small expansion depend on the final
        // layout, so they are written a second time. In a large expansion, a coefficient keeps the place that it first
        // gets.
        let mut writer = Writer::of(jet, context);
        let mut orders = writer.orders();
        if !writer.is_large() {
            orders = writer.orders();
        }
        let (orders, next, keep) = orders;
        let histories = writer.begin_histories();
        let inverses = writer.begin_inverses();
        let (outputs, firsts) = writer.read_firsts();
        let known = outputs.len();
        let sum = match writer.is_large() {
            true => quote!(let sum = ::dalembert::jet::shared_middle;),
            false => TokenStream::new(),
        };
        let start = joined([sum, firsts, inverses, histories]);
        Self {
            begin: begin(jet, outputs, context),
            known,
            advance: advance(&start, &orders, &next, &keep, context),
            room: writer.room.type_tokens(),
        }
    }
}

/// The statements of order 0.
fn begin(jet: &Jet, outputs: Vec<Value>, context: &Context<'_>) -> TokenStream {
    let function = &jet.function;
    let extended = Function {
        ops: function.ops.clone(),
        names: function.names.clone(),
        outputs,
        cost: function.cost,
    };
    let bindings = context.bind_row(&extended);
    let Body {
        statements,
        outputs,
    } = emit_body(&extended, &context.names);
    joined([bindings, statements, quote!(*firsts = [#(#outputs),*];)])
}

/// Statements for the first coefficients, and the loop over the higher orders.
fn advance(
    start: &TokenStream,
    orders: &TokenStream,
    next: &[TokenStream],
    keep: &TokenStream,
    context: &Context<'_>,
) -> TokenStream {
    let components = context.form.dimension() + context.form.motion_dimension();
    let (rates, gaps) = next.split_at(components);
    let places = |from: usize, to: usize| (from..to).map(Literal::usize_unsuffixed);
    let first_rates = places(0, components);
    let coefficient = quote! {
        let step = unit * L::inverse(k + 1);
        coefficients[k + 1] = [#(step * #rates),*];
    };
    let (first_gaps, gaps, coefficient, last) = match gaps.is_empty() {
        true => (
            TokenStream::new(),
            TokenStream::new(),
            coefficient,
            quote!(1..),
        ),
        false => {
            let firsts = places(components, next.len());
            (
                quote!(gaps[0] = [#(firsts[#firsts]),*];),
                quote!(gaps[k] = [#(#gaps),*];),
                quote!(if k < order { #coefficient }),
                quote!(1..=),
            )
        }
    };
    quote! {
        #start
        coefficients[1] = [#(unit * firsts[#first_rates]),*];
        #first_gaps
        for k in #last ::core::cmp::Ord::min(order, ::dalembert::jet::LENGTH - 1) {
            let (weight, inverse) = (L::of(k as f64), L::inverse(k));
            #orders
            #gaps
            #coefficient
            #keep
        }
    }
}
