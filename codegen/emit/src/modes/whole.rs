//! `Declared`, tables and power series of a model with modes: lengths of vectors, and positions of each mode's
//! quantities among those of the model.

use dalembert_numbers::tables::Dimensions;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::Whole;
use crate::constants::{Constant, Record};
use crate::describe::emitted;
use crate::{actuation, attributes, constraint, kernels};

/// `impl Declared`, and the marker traits for constraints and surfaces.
pub(super) fn emit_declared(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let Dimensions {
        state,
        coordinates,
        motion,
        constraints,
        levels,
        surfaces,
        parameters,
    } = whole.known.dimensions();
    let room = whole.known.room();
    let list = whole.contexts.iter().flatten().rev();
    let list = list.fold(
        quote!(::dalembert::kernels::NoKernels),
        |others, context| {
            let first = kernels::type_name(context);
            quote!(::dalembert::kernels::Choice<#first, #others>)
        },
    );
    let places = crate::names::places(whole.model(), &quote!(self));
    let may_be_narrow = whole.known.tables().can_be_narrow;
    let hooks = emit_hooks(whole);
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    let parts = [
        (constraints > 0, quote!(HasConstraints)),
        (surfaces > 0, quote!(HasSurfaces)),
    ];
    let parts = parts.iter().filter(|(has, _)| *has).map(|(_, part)| part);
    quote! {
        #attributes
        impl ::dalembert::kernels::Declared for #type_name {
            type State = ::dalembert::__private::SVector<f64, #state>;
            type Vector = ::dalembert::__private::SVector<f64, #coordinates>;
            type Impulse = ::dalembert::__private::SVector<f64, #motion>;
            type Gaps = ::dalembert::__private::SVector<f64, #surfaces>;
            type Multipliers = ::dalembert::__private::SVector<f64, #constraints>;
            type Levels = ::dalembert::__private::SVector<f64, #levels>;
            type Positions<#numbers> = [L; #coordinates];
            type Components<#numbers> = [L; #state];
            type Arguments<#numbers> = [L; #parameters];
            type Room<#numbers> = [L; #room];
            type Values<'a> = [f64; #parameters];
            type Kernels = #list;

            const MAY_BE_NARROW: bool = #may_be_narrow;
            const HAS_MODES: bool = true;

            fn kernels(&self) -> Self::Kernels { ::dalembert::kernels::Given::GIVEN }

            #[inline(always)]
            fn kernels_at(&self, place: usize) -> Self::Kernels {
                ::dalembert::kernels::Chosen::at(place)
            }

            #[inline(always)]
            fn tables(&self) -> &'static ::dalembert::kernels::Tables {
                <Self as ::dalembert::declaration::Emitted>::TABLES
            }

            #[inline(always)]
            fn arguments(&self) -> [f64; #parameters] { [#(#places),*] }

            #[inline(always)]
            fn start(&self) -> usize { self.mode as usize }

            fn starting_in(&self, mode: usize) -> Self {
                let mut whole = *self;
                ::dalembert::kernels::Documented::set_start(&mut whole, mode);
                whole
            }

            #hooks
        }

        #(impl ::dalembert::kernels::#parts for #type_name {})*
    }
}

/// Emits the methods of a model whose modes have constraints. They override defaults that accept every state.
fn emit_hooks(whole: &Whole<'_>) -> TokenStream {
    let drop = whole.known.tables().can_lose_rank.then(|| {
        let types = emit_list(whole);
        quote! {
            const MAY_LOSE_RANK: bool = true;

            fn rank_drop_along(
                &self,
                motion: impl ::core::ops::Fn(f64) -> (f64, Self::State),
                reach: f64,
            ) -> ::core::option::Option<::dalembert::RankDrop> {
                ::dalembert::__private::modes::rank_drop::<Self, #types>(self, motion, reach)
            }
        }
    });
    let constrained: Vec<_> = (whole.mode_contexts())
        .filter_map(|mode| mode.form.program.constrained.as_ref())
        .collect();
    let positions = constrained
        .iter()
        .any(|functions| functions.level_scales.is_some());
    let positions = positions.then(constraint::emit_positions);
    let nearest = whole
        .mode_contexts()
        .any(|mode| mode.form.model.is_nonlinear());
    let nearest = nearest.then(constraint::emit_nearest);
    let velocities = (!constrained.is_empty()).then(constraint::emit_velocities);
    quote!(#drop #positions #nearest #velocities)
}

/// The types of the modes as a nested list: `(First, (Second, ()))`.
fn emit_list(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    let types = types.iter().rev();
    types.fold(quote!(()), |others, mode| quote!((#mode, #others)))
}

/// Tables of the model. They refer to the tables of the modes, which are constants of the modes' types.
pub(super) fn emit_tables(whole: &Whole<'_>) -> TokenStream {
    let tables = whole.known.tables();
    let types = whole.types();
    let modes = tables.modes.iter().zip(&types).map(|(mode, type_name)| {
        let (tables, documentation) = (
            emitted(type_name, "TABLES"),
            emitted(type_name, "DOCUMENTATION"),
        );
        mode.tokens_with(&[
            ("tables", quote!(::dalembert::erased::Held::Static(#tables))),
            (
                "documentation",
                quote!(::dalembert::erased::Held::Static(#documentation)),
            ),
        ])
    });
    let modes = quote!(::dalembert::erased::Held::Static(&[#(#modes),*]));
    let tables = tables.tokens_with(&[("modes", modes)]);
    quote!(&#tables)
}

/// The forms of the modes and their global forms, in the order of their kernels.
pub(super) fn emit_forms(whole: &Whole<'_>) -> TokenStream {
    let types = whole.contexts.iter().flatten();
    let types = types.map(|context| &context.names.type_name);
    let is_narrow = whole.known.tables().can_be_narrow;
    quote!(&[#(::dalembert::erased::Shared::Static(
        ::dalembert::declaration::of_mode::<#types, #is_narrow>()
    )),*])
}

/// `impl From<Model>` for the type of each mode.
pub(super) fn emit_conversions(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let modes = whole.types().into_iter().map(|mode| {
        quote! {
            #attributes
            impl ::core::convert::From<#type_name> for #mode {
                #[inline(always)]
                fn from(model: #type_name) -> Self { Self(model) }
            }
        }
    });
    quote!(#(#modes)*)
}

/// `impl Actuated`, if inputs are declared.
pub(super) fn emit_actuated(whole: &Whole<'_>) -> TokenStream {
    let places = crate::names::places(whole.model(), &quote!(self));
    actuation::emit_actuated_type(whole.model(), whole.type_name(), &places)
}

/// `impl TaylorField`
pub(super) fn emit_taylor(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let types = whole.types();
    let list = emit_list(whole);
    let Dimensions {
        state, parameters, ..
    } = whole.known.dimensions();
    let gaps = whole.known.series_gaps();
    let work = whole.known.work().tokens();
    let lengths = quote!(::dalembert::__private::modes::Lengths { state: #state, gaps: #gaps });
    let modes = quote!((
        0,
        <Self as ::dalembert::declaration::Emitted>::TABLES
            .modes
            .value()
    ));
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        /// Number of initial terms: rates, gaps, and the other initial terms of the mode with the most of them.
        const __FIRSTS: usize = #state + #gaps + ::dalembert::__private::modes::longest(&[
            #(::dalembert::__private::modes::rest::<#types>()),*
        ]);

        #attributes
        impl ::dalembert::TaylorField for #type_name {
            type Parameters<#numbers> = [L; #parameters];
            type Row<#numbers> = [L; #state];
            type Gaps<#numbers> = [L; #gaps];
            type Firsts<#numbers> = [L; __FIRSTS];
            type Jets<#numbers> = <#list as ::dalembert::__private::modes::ModeList<Self>>::Jets<L>;

            fn work(&self) -> ::core::option::Option<::dalembert::jet::Work> { #work }

            fn parameters(&self) -> [f64; #parameters] {
                ::dalembert::kernels::Declared::arguments(self)
            }

            fn begin<#numbers>(
                &self,
                parameters: &[L; #parameters],
                t: L,
                state: &[L; #state],
                firsts: &mut [L; __FIRSTS],
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                <#list as ::dalembert::__private::modes::ModeList<Self>>::begin(
                    self, #modes, #lengths, (parameters, t, state), firsts,
                )
            }

            fn advance<#numbers>(
                &self,
                parameters: &[L; #parameters],
                unit: L,
                order: usize,
                firsts: &[L; __FIRSTS],
                coefficients: &mut [[L; #state]; ::dalembert::jet::LENGTH],
                gaps: &mut [[L; #gaps]; ::dalembert::jet::LENGTH],
                jets: &mut Self::Jets<L>,
            ) {
                let expansion = ::dalembert::__private::modes::Expansion {
                    lengths: #lengths, parameters, unit, order, firsts,
                };
                <#list as ::dalembert::__private::modes::ModeList<Self>>::advance(
                    self, #modes, expansion, coefficients, gaps, jets,
                );
            }
        }
    }
}

/// Items of the model that variations need.
pub(super) fn emit_variations(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let Dimensions {
        state,
        motion,
        surfaces,
        ..
    } = whole.known.dimensions();
    let (collision, deviations) = (5 + motion, state - 1);
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::HasVariations for #type_name {
            type Clearances<#numbers> = [L; #surfaces];
            type Collision<#numbers> = [L; #collision];
            type Deviations<#numbers> = [L; #deviations];
            type Columns = [::dalembert::__private::SVector<f64, #state>; #state];
            type Tangents = [::dalembert::Tangent<Self>; #state];

            fn columns() -> Self::Columns { [::dalembert::StateVector::zeros(#state); #state] }

            fn tangents() -> Self::Tangents { [::dalembert::Tangent::zero(); #state] }
        }
    }
}

/// Sets the mode to the one with the number in `mode`; a number past the end changes nothing.
pub(super) fn emit_choice(whole: &Whole<'_>) -> TokenStream {
    let module = Ident::new(&whole.model().snake_name, Span::call_site());
    let arms = whole.graph.modes.iter().enumerate().map(|(index, mode)| {
        let variant = Ident::new(&mode.scene.type_name, Span::call_site());
        let number = Literal::usize_unsuffixed(index);
        quote!(#number => self.mode = #module::Mode::#variant,)
    });
    quote!(match mode { #(#arms)* _ => {} })
}

/// Emits `inspect_mode`, which reports the quantities of one mode.
pub(super) fn emit_inspection(whole: &Whole<'_>) -> TokenStream {
    let list = emit_list(whole);
    quote! {
        fn inspect_mode(
            &self,
            mode: usize,
            t: f64,
            state: &[f64],
            report: &mut dyn ::dalembert::describe::Report,
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            <#list as ::dalembert::__private::modes::ModeList<Self>>::inspect(self, mode, t, state, report)
        }
    }
}
