//! The contract of the whole: each trait asks the mode of the state.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::Whole;
use crate::emit::attributes;

/// Lengths of the vectors of the whole, from those of its modes.
pub(super) fn emit_sizes(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    quote! {
        /// Components of a state: those of the longest mode, and the number of the mode.
        const __STATE: usize = 1 + ::dalembert::__private::modes::longest(&[
            #(<<#types as ::dalembert::VectorField>::State as ::dalembert::StateVector>::CAPACITY),*
        ]);
        /// Components of an impulse.
        const __IMPULSE: usize = ::dalembert::__private::modes::longest(&[
            #(<<#types as ::dalembert::System>::Impulse as ::dalembert::StateVector>::CAPACITY),*
        ]);
    }
}

/// `impl Mode` for each of them.
pub(super) fn emit_modes(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let modes = whole.graph.modes.iter().zip(&whole.contexts).enumerate();
    let modes = modes.map(|(index, (mode, contexts))| {
        let context = &contexts[0];
        let type_name = &context.names.type_name;
        let places = &mode.places;
        let [coordinates, surfaces, outputs] =
            [&places.coordinates, &places.surfaces, &places.outputs]
                .map(|own| quote!(&[#(#own),*]));
        let can_leave = context.program.constrained.is_some() && context.program.reduced.is_none();
        let functions = context.program.impacting.iter();
        let mut entries = functions.flat_map(|functions| &functions.entries);
        let entry = entries.any(Option::is_some).then(emit_entry);
        quote! {
            #attributes
            impl ::dalembert::Mode for #type_name {
                type Model = #own;
                const INDEX: usize = #index;
                const COORDINATES: &'static [usize] = #coordinates;
                const SURFACES: &'static [usize] = #surfaces;
                const OUTPUTS: &'static [usize] = #outputs;
                const CAN_LEAVE_CONSTRAINTS: bool = #can_leave;

                #[inline(always)]
                fn of(model: &#own) -> Self { Self(*model) }

                #entry
            }
        }
    });
    modes.collect()
}

/// `entry`, by the kernels of surfaces for which a state of another mode is declared.
fn emit_entry() -> TokenStream {
    quote! {
        fn entry(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
            q: &mut [f64],
            qdot: &mut [f64],
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            ::dalembert::__private::enter(self, surface, t, state, [q, qdot])
        }
    }
}

/// `impl VectorField`
pub(super) fn emit_field(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let rate = whole.of_state(
        |_, mode| quote!(::dalembert::__private::modes::rate::<#mode>(self, t, state, rate)),
    );
    let scale = whole
        .of_state(|_, mode| quote!(::dalembert::__private::modes::scale::<#mode>(self, t, state)));
    let mut modes = whole.contexts.iter().map(|contexts| contexts[0].program);
    let along = modes
        .any(|program| program.can_be_narrow)
        .then(emit_rates_along);
    quote! {
        #attributes
        impl ::dalembert::VectorField for #own {
            type State = ::dalembert::__private::SVector<f64, __STATE>;

            #[inline]
            fn rate(
                &self,
                t: f64,
                state: &Self::State,
                rate: &mut Self::State,
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #rate
            }

            #[inline]
            fn scale(&self, t: f64, state: &Self::State) -> Self::State {
                #scale
            }

            #along
        }
    }
}

/// `impl TaylorField`
pub(super) fn emit_taylor(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let types = whole.types();
    let parameters = whole.model().parameters.len();
    let places = places_of_parameters(whole);
    let gaps = count_of_series(whole);
    let rooms = types.iter().rev().fold(
        quote!(()),
        |rest, mode| quote!((<#mode as ::dalembert::TaylorField>::Jets<L>, #rest)),
    );
    let begin = types.iter().map(|mode| {
        quote!(::dalembert::__private::modes::begin::<#mode, L>(&<#mode as ::dalembert::Mode>::of(self), shape, parameters, t, state, firsts)?;)
    });
    let advance = types.iter().enumerate().map(|(index, mode)| {
        let rest = (0..index).map(|_| quote!(.1));
        quote! {
            ::dalembert::__private::modes::advance::<#mode, L, __STATE, #gaps>(
                &<#mode as ::dalembert::Mode>::of(self),
                parameters, unit, order, firsts, coefficients, gaps, &mut jets #(#rest)* .0,
            );
        }
    });
    quote! {
        /// What is known at a moment besides rates and gaps, of the mode that knows most.
        const __REST: usize = ::dalembert::__private::modes::longest(&[
            #(::dalembert::__private::modes::rest::<#types>()),*
        ]);
        const __FIRSTS: usize = __STATE + #gaps + __REST;

        #attributes
        impl ::dalembert::TaylorField for #own {
            type Parameters<L: ::dalembert::numbers::Numbers> = [L; #parameters];
            type Row<L: ::dalembert::numbers::Numbers> = [L; __STATE];
            type Gaps<L: ::dalembert::numbers::Numbers> = [L; #gaps];
            type Firsts<L: ::dalembert::numbers::Numbers> = [L; __FIRSTS];
            type Jets<L: ::dalembert::numbers::Numbers> = #rooms;

            fn work(&self) -> ::core::option::Option<::dalembert::jet::Work> {
                ::dalembert::__private::modes::work(&[
                    #(::dalembert::TaylorField::work(&<#types as ::dalembert::Mode>::of(self))),*
                ])
            }

            #[inline]
            fn parameters(&self) -> [f64; #parameters] { [#(#places),*] }

            #[inline]
            fn begin<L: ::dalembert::numbers::Numbers>(
                &self,
                parameters: &[L; #parameters],
                t: L,
                state: &[L; __STATE],
                firsts: &mut [L; __FIRSTS],
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                let shape = ::dalembert::__private::modes::Shape { state: __STATE, gaps: #gaps };
                #(#begin)*
                ::core::result::Result::Ok(())
            }

            #[inline]
            fn advance<L: ::dalembert::numbers::Numbers>(
                &self,
                parameters: &[L; #parameters],
                unit: L,
                order: usize,
                firsts: &[L; __FIRSTS],
                coefficients: &mut [[L; __STATE]; ::dalembert::jet::LENGTH],
                gaps: &mut [[L; #gaps]; ::dalembert::jet::LENGTH],
                jets: &mut Self::Jets<L>,
            ) {
                #(#advance)*
            }
        }
    }
}

/// The places of the parameters in the struct of the whole.
fn places_of_parameters(whole: &Whole<'_>) -> Vec<TokenStream> {
    crate::emit::names::places(whole.model(), &quote!(self))
}

/// Gaps that have a series: all of them, or none if one of a mode has none.
fn count_of_series(whole: &Whole<'_>) -> usize {
    let have_series = whole.own().all(|context| {
        let components = context.dimension() + context.motion_dimension();
        let gaps = context.program.jet.function.outputs.len() - components;
        gaps == context.model.surfaces.len()
    });
    if have_series {
        whole.graph.surfaces.len()
    } else {
        0
    }
}

/// `impl System` and `impl Lagrangian`
pub(super) fn emit_system(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let n = whole.graph.coordinates.len();
    let types = whole.types();
    let readings = emit_readings(whole);
    let makers = emit_makers(whole);
    let lagrangian = emit_refusal(&own, &quote!(::dalembert::Fault::SeveralModes));
    quote! {
        #attributes
        impl ::dalembert::System for #own {
            type Vector = ::dalembert::__private::SVector<f64, #n>;
            type Impulse = ::dalembert::__private::SVector<f64, __IMPULSE>;

            #readings

            #makers

            fn check_parameters(&self) -> ::core::result::Result<(), ::dalembert::ParameterError> {
                #(::dalembert::System::check_parameters(&<#types as ::dalembert::Mode>::of(self))?;)*
                ::core::result::Result::Ok(())
            }
        }

        #lagrangian
    }
}

/// What is read off a state, or changed in it: its mode answers.
fn emit_readings(whole: &Whole<'_>) -> TokenStream {
    let ask = |function: TokenStream, arguments: TokenStream| {
        whole.of_state(|_, mode| quote!(::dalembert::__private::modes::#function::<#mode, _>(self, #arguments)))
    };
    let position = ask(quote!(position), quote!(state));
    let velocity = ask(quote!(velocity), quote!(t, state));
    let momentum = ask(quote!(momentum), quote!(t, state));
    let energy = whole
        .of_state(|_, mode| quote!(::dalembert::__private::modes::energy::<#mode>(self, t, state)));
    let kick = whole.of_state(|_, mode| {
        quote!(::dalembert::__private::modes::kick::<#mode>(self, state, size, direction))
    });
    let chart = whole.of_state(
        |_, mode| quote!(::dalembert::__private::modes::outside_chart::<#mode>(self, state)),
    );
    let drop = emit_rank_drop(whole);
    let carried = whole.of_state(
        |_, mode| quote!(::dalembert::__private::modes::carried::<#mode>(self, from, t, state, keep)),
    );
    let motion = whole.of_state(
        |_, mode| quote!(<<#mode as ::dalembert::System>::Vector as ::dalembert::StateVector>::CAPACITY),
    );
    let vector = quote!(::core::result::Result<Self::Vector, ::dalembert::Fault>);
    quote! {
        #[inline]
        fn position(&self, state: &Self::State) -> Self::Vector { #position }

        #[inline]
        fn velocity(&self, t: f64, state: &Self::State) -> #vector { #velocity }

        fn momentum(&self, t: f64, state: &Self::State) -> #vector { #momentum }

        #[inline]
        fn energy(&self, t: f64, state: &Self::State) -> ::core::result::Result<f64, ::dalembert::Fault> { #energy }

        #[inline]
        fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse) { #kick }

        fn carried(
            &self,
            from: &Self,
            t: f64,
            state: &Self::State,
            keep: ::dalembert::Keep,
        ) -> ::core::result::Result<Self::State, ::dalembert::StateError> {
            #carried
        }

        fn motion_start(&self, state: &Self::State) -> usize { #motion }

        #[inline]
        fn mode(&self, state: &Self::State) -> usize { ::dalembert::__private::modes::index(state) }

        #[inline]
        fn outside_chart(&self, state: &Self::State) -> ::core::option::Option<usize> { #chart }

        #drop
    }
}

/// `rank_drop`, if a mode has forms that may become dependent: the mode in which the piece of motion begins answers.
fn emit_rank_drop(whole: &Whole<'_>) -> TokenStream {
    let mut programs = whole.contexts.iter().map(|contexts| contexts[0].program);
    let mut constrained = programs.by_ref().filter_map(|own| own.constrained.as_ref());
    if !constrained.any(|own| own.can_lose_rank) {
        return TokenStream::new();
    }
    let ask = whole.of_state(
        |_, mode| quote!(::dalembert::__private::modes::rank_drop::<#mode>(self, motion, reach)),
    );
    quote! {
        #[inline(always)]
        fn can_lose_rank(&self) -> bool { true }

        fn rank_drop(
            &self,
            motion: impl ::core::ops::Fn(f64) -> (f64, Self::State),
            reach: f64,
        ) -> ::core::option::Option<::dalembert::RankDrop> {
            let state = &motion(0.0).1;
            #ask
        }
    }
}

/// What makes states, or judges what they are made of: the mode in which motion starts answers.
fn emit_makers(whole: &Whole<'_>) -> TokenStream {
    let make = |function: TokenStream, arguments: TokenStream| {
        whole.of_start(|_, mode| quote!(::dalembert::__private::modes::#function::<#mode, _>(self, #arguments)))
    };
    let unchecked = make(quote!(state_unchecked), quote!(t, q, qdot));
    let from_momenta = make(quote!(state_from_momenta), quote!(t, q, p));
    let nearest = make(quote!(state_nearest), quote!(t, q, qdot));
    let admit = make(quote!(admit), quote!(t, q, qdot));
    let place = make(quote!(complete_position), quote!(t, q, placed));
    let complete = make(quote!(complete_velocity), quote!(t, q, qdot, named));
    let fault = quote!(::core::result::Result<Self::State, ::dalembert::Fault>);
    quote! {
        fn state_unchecked(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> #fault { #unchecked }

        fn state_from_momenta(&self, t: f64, q: &Self::Vector, p: &Self::Vector) -> #fault { #from_momenta }

        fn state_nearest(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> #fault { #nearest }

        fn admit(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<(), ::dalembert::StateError> {
            #admit
        }

        fn complete_position(
            &self,
            t: f64,
            q: &Self::Vector,
            placed: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            #place
        }

        fn complete_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
            named: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            #complete
        }
    }
}

/// `impl Lagrangian` of what has no principle that can be put to work: it answers this fault.
fn emit_refusal(type_name: &impl ToTokens, fault: &TokenStream) -> TokenStream {
    let attributes = attributes();
    quote! {
        #attributes
        impl ::dalembert::Lagrangian for #type_name {
            type Reactions = ::dalembert::__private::SVector<f64, 0usize>;

            fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector {
                ::dalembert::System::zero_vector(self)
            }

            fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
                ::dalembert::System::zero_vector(self)
            }

            fn constrained_velocity(
                &self,
                t: f64,
                q: &Self::Vector,
                p: &Self::Vector,
            ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
                ::core::result::Result::Err(#fault)
            }
        }
    }
}

/// `rates_along`, where the rate may have narrow features.
fn emit_rates_along() -> TokenStream {
    quote! {
        #[inline(always)]
        fn can_be_narrow(&self) -> bool { true }

        fn rates_along(
            &self,
            t: ::dalembert::numbers::Rated,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::Rated,
            rate: &mut dyn ::core::ops::FnMut(usize, ::dalembert::numbers::Rated),
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            ::dalembert::__private::rates_along(self, t, component, rate)
        }
    }
}
