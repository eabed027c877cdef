//! The contract of the whole: each trait asks the mode of the state.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Whole;
use crate::emit::attributes;
use crate::emit::function::Body;
use crate::model::{Law, Mode, Transition};

/// Lengths of the vectors of the whole, from those of its modes.
pub(super) fn emit_sizes(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    quote! {
        /// Components of a state: those of the longest mode, and the number of the mode.
        const __STATE: usize = 1 + ::dalembert::__private::modes::longest(&[
            #(<<#types as ::dalembert::VectorField>::State as ::dalembert::StateVector>::LEN),*
        ]);
        /// Components of an impulse.
        const __IMPULSE: usize = ::dalembert::__private::modes::longest(&[
            #(<<#types as ::dalembert::System>::Impulse as ::dalembert::StateVector>::LEN),*
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
        let entries = context
            .program
            .impacting
            .iter()
            .flat_map(|own| &own.entries);
        let arms = entries.enumerate().filter_map(|(surface, function)| {
            let function = function.as_ref()?;
            let count = mode.model.surfaces[surface]
                .transition
                .as_ref()?
                .map
                .as_ref()?
                .q
                .len();
            let Body {
                statements,
                outputs,
            } = context.state_body(function);
            let (q_after, qdot_after) = outputs.split_at(count);
            Some(quote! {
                #surface => {
                    #statements
                    ::dalembert::__private::modes::write(after_q, &[#(#q_after),*]);
                    ::dalembert::__private::modes::write(after_qdot, &[#(#qdot_after),*]);
                }
            })
        });
        let arms: Vec<TokenStream> = arms.collect();
        let entry = (!arms.is_empty()).then(|| {
            quote! {
                fn entry(
                    &self,
                    surface: usize,
                    t: f64,
                    state: &Self::State,
                    after_q: &mut [f64],
                    after_qdot: &mut [f64],
                ) -> ::core::result::Result<(), ::dalembert::Fault> {
                    match surface {
                        #(#arms)*
                        _ => {}
                    }
                    ::core::result::Result::Ok(())
                }
            }
        });
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

/// `impl VectorField`
pub(super) fn emit_field(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let rate = whole.of_state(
        |_, mode| quote!(::dalembert::__private::modes::rate::<#mode>(self, t, state, rate)),
    );
    let scale = whole
        .of_state(|_, mode| quote!(::dalembert::__private::modes::scale::<#mode>(self, t, state)));
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
        quote!(::dalembert::__private::modes::begin::<#mode, L>(shape, parameters, t, state, firsts)?;)
    });
    let advance = types.iter().enumerate().map(|(index, mode)| {
        let rest = (0..index).map(|_| quote!(.1));
        quote! {
            ::dalembert::__private::modes::advance::<#mode, L, __STATE, #gaps>(
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

            const WORK: ::core::option::Option<::dalembert::jet::Work> =
                ::dalembert::__private::modes::work(&[#(<#types as ::dalembert::TaylorField>::WORK),*]);

            #[inline]
            fn parameters(&self) -> [f64; #parameters] { [#(#places),*] }

            #[inline]
            fn begin<L: ::dalembert::numbers::Numbers>(
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
    let ask = |function: TokenStream, arguments: TokenStream| {
        whole.of_state(|_, mode| quote!(::dalembert::__private::modes::#function::<#mode, _>(self, #arguments)))
    };
    let make = |function: TokenStream, arguments: TokenStream| {
        whole.of_start(|_, mode| quote!(::dalembert::__private::modes::#function::<#mode, _>(self, #arguments)))
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
    let motion = whole.of_state(
        |_, mode| quote!(<<#mode as ::dalembert::System>::Vector as ::dalembert::StateVector>::LEN),
    );
    let unchecked = make(quote!(state_unchecked), quote!(t, q, qdot));
    let from_momenta = make(quote!(state_from_momenta), quote!(t, q, p));
    let nearest = make(quote!(state_nearest), quote!(t, q, qdot));
    let admit = make(quote!(admit), quote!(t, q, qdot));
    let complete = make(quote!(complete_velocity), quote!(t, q, qdot, named));
    let fault = quote!(::core::result::Result<Self::State, ::dalembert::Fault>);
    let vector = quote!(::core::result::Result<Self::Vector, ::dalembert::Fault>);
    quote! {
        #attributes
        impl ::dalembert::System for #own {
            type Vector = ::dalembert::__private::SVector<f64, #n>;
            type Impulse = ::dalembert::__private::SVector<f64, __IMPULSE>;

            #[inline]
            fn position(&self, state: &Self::State) -> Self::Vector { #position }

            #[inline]
            fn velocity(&self, t: f64, state: &Self::State) -> #vector { #velocity }

            fn momentum(&self, t: f64, state: &Self::State) -> #vector { #momentum }

            fn state_unchecked(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> #fault { #unchecked }

            fn state_from_momenta(&self, t: f64, q: &Self::Vector, p: &Self::Vector) -> #fault { #from_momenta }

            #[inline]
            fn energy(&self, t: f64, state: &Self::State) -> ::core::result::Result<f64, ::dalembert::Fault> { #energy }

            #[inline]
            fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse) { #kick }

            fn check_parameters(&self) -> ::core::result::Result<(), ::dalembert::ParameterError> {
                #(::dalembert::System::check_parameters(&<#types as ::dalembert::Mode>::of(self))?;)*
                ::core::result::Result::Ok(())
            }

            fn motion_start(&self, state: &Self::State) -> usize { #motion }

            #[inline]
            fn mode(&self, state: &Self::State) -> usize { ::dalembert::__private::modes::index(state) }

            #[inline]
            fn outside_chart(&self, state: &Self::State) -> ::core::option::Option<usize> { #chart }

            fn admit(
                &self,
                t: f64,
                q: &Self::Vector,
                qdot: &Self::Vector,
            ) -> ::core::result::Result<(), ::dalembert::StateError> {
                #admit
            }

            fn state_nearest(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> #fault { #nearest }

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

        #attributes
        impl ::dalembert::Lagrangian for #own {
            type Reactions = ::dalembert::__private::SVector<f64, 0usize>;

            fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector {
                <Self::Vector as ::dalembert::StateVector>::zeros()
            }

            fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
                <Self::Vector as ::dalembert::StateVector>::zeros()
            }

            fn constrained_velocity(
                &self,
                t: f64,
                q: &Self::Vector,
                p: &Self::Vector,
            ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
                ::core::result::Result::Err(::dalembert::Fault::SeveralModes)
            }
        }
    }
}

/// `impl Impacting`, if there are surfaces or transitions.
pub(super) fn emit_impacting(whole: &Whole<'_>) -> TokenStream {
    if whole.graph.surfaces.is_empty() {
        return TokenStream::new();
    }
    let own = whole.type_name();
    let attributes = attributes();
    let count = whole.graph.surfaces.len();
    let ask = |function: TokenStream, arguments: TokenStream, without: TokenStream| {
        whole.of_state(|mode, own| match mode.model.surfaces.is_empty() {
            true => without.clone(),
            false => quote!(::dalembert::__private::modes::#function::<#own, _>(self, #arguments)),
        })
    };
    let zeros = quote!(<Self::Gaps as ::dalembert::StateVector>::zeros());
    let no_surface = quote!(::core::result::Result::Err(
        ::dalembert::Fault::SingularSurface { surface }
    ));
    let gaps = ask(
        quote!(gaps),
        quote!(t, state),
        quote!(::dalembert::__private::modes::no_gaps()),
    );
    let rates = ask(
        quote!(gap_rates),
        quote!(t, state),
        quote!(::core::result::Result::Ok(#zeros)),
    );
    let none = quote!(::core::result::Result::Ok(::core::option::Option::None));
    let accelerations = whole.of_state(|mode, own| match mode.model.surfaces.is_empty() {
        true => none.clone(),
        false => quote!(::dalembert::__private::modes::gap_accelerations::<#own, _>(self, t, state, motion)),
    });
    let responses = whole.of_state(|mode, own| match mode.model.surfaces.is_empty() {
        true => none.clone(),
        false => {
            quote!(::dalembert::__private::modes::gap_responses::<#own, _>(self, t, state, motion))
        }
    });
    let active = whole.of_state(|mode, own| match mode.model.surfaces.is_empty() {
        true => quote!(false),
        false => {
            quote!(::dalembert::__private::modes::surface_active::<#own>(self, surface, t, state))
        }
    });
    let blow = ask(quote!(blow), quote!(surface, t, state), no_surface.clone());
    let contact = ask(quote!(contact), quote!(surface, t, state), no_surface);
    let landing = whole.of_state(|mode, own| emit_landing(whole, mode, own));
    let instantaneous = emit_instantaneous(whole);
    let laws = whole.graph.surfaces.iter().enumerate().map(|(place, entry)| {
        let own = whole.types()[entry.mode];
        let surface = entry.place;
        quote!(#place => ::dalembert::Impacting::law(&<#own as ::dalembert::Mode>::of(self), #surface),)
    });
    let passable = whole
        .graph
        .surfaces
        .iter()
        .enumerate()
        .filter(|(_, entry)| {
            let surface = &whole.graph.modes[entry.mode].model.surfaces[entry.place];
            surface.law == Law::Reset
                || surface
                    .transition
                    .as_ref()
                    .is_some_and(|own| own.has_no_side)
        });
    let passable = passable.map(|(place, _)| Literal::usize_unsuffixed(place));
    let passable: Vec<Literal> = passable.collect();
    let passable = match passable.is_empty() {
        true => quote!(false),
        false => quote!(::core::matches!(surface, #(#passable)|*)),
    };
    let opposite = emit_opposites(whole);
    let result = |of: TokenStream| quote!(::core::result::Result<#of, ::dalembert::Fault>);
    let [optional, rated] = [
        quote!(::core::option::Option<Self::Gaps>),
        quote!(Self::Gaps),
    ]
    .map(result);
    let [blown, touched] = [
        quote!(::dalembert::impacts::law::Blow<Self::Impulse>),
        quote!(::dalembert::impacts::law::Contact<Self::Impulse>),
    ]
    .map(result);
    quote! {
        #attributes
        impl ::dalembert::Impacting for #own {
            type Gaps = ::dalembert::__private::SVector<f64, #count>;

            #[inline]
            fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps { #gaps }

            #[inline]
            fn gap_rates(&self, t: f64, state: &Self::State) -> #rated { #rates }

            fn gap_accelerations(&self, t: f64, state: &Self::State, motion: &Self::Impulse) -> #optional { #accelerations }

            fn gap_responses(&self, t: f64, state: &Self::State, motion: &Self::Impulse) -> #optional { #responses }

            #[inline]
            fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool { #active }

            fn law(&self, surface: usize) -> ::dalembert::impacts::law::Law {
                match surface {
                    #(#laws)*
                    _ => ::dalembert::impacts::law::Law::Elastic,
                }
            }

            fn is_passable(&self, surface: usize) -> bool { #passable }

            #opposite

            fn landing(
                &self,
                surface: usize,
                t: f64,
                state: &Self::State,
            ) -> ::core::result::Result<::dalembert::impacts::law::Landing<Self::State>, ::dalembert::Outcome> {
                #landing
            }

            #[inline]
            fn blow(&self, surface: usize, t: f64, state: &Self::State) -> #blown { #blow }

            fn contact(&self, surface: usize, t: f64, state: &Self::State) -> #touched { #contact }

            #instantaneous
        }
    }
}

/// `focus` and `trace`, where a surface of some mode has instantaneous constraints.
fn emit_instantaneous(whole: &Whole<'_>) -> TokenStream {
    let is_rough = |entry: &Mode| {
        let mut surfaces = entry.model.surfaces.iter();
        surfaces.any(|own| !own.instantaneous.is_empty())
    };
    if !whole.graph.modes.iter().any(is_rough) {
        return TokenStream::new();
    }
    let ask = |function: TokenStream, arguments: TokenStream| {
        whole.of_state(|mode, own| match mode.model.surfaces.is_empty() {
            true => quote!(::core::result::Result::Ok(::core::option::Option::None)),
            false => quote!(::dalembert::__private::modes::#function::<#own, _>(self, #arguments)),
        })
    };
    let focus = ask(quote!(focus), quote!(surface, t, state));
    let trace = ask(quote!(trace), quote!(surface, t, state, motion));
    let result = quote! {
        ::core::result::Result<::core::option::Option<Self::Impulse>, ::dalembert::Fault>
    };
    quote! {
        fn focus(&self, surface: usize, t: f64, state: &Self::State) -> #result { #focus }

        fn trace(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
            motion: &Self::Impulse,
        ) -> #result {
            #trace
        }
    }
}

/// The transition that leads back from each, between first-order modes.
fn emit_opposites(whole: &Whole<'_>) -> TokenStream {
    let opposites: Vec<[usize; 2]> = whole.graph.opposites().collect();
    if opposites.is_empty() {
        return TokenStream::new();
    }
    let arms = opposites
        .iter()
        .map(|[surface, back]| quote!(#surface => ::core::option::Option::Some(#back),));
    quote! {
        fn opposite(&self, surface: usize) -> ::core::option::Option<usize> {
            match surface {
                #(#arms)*
                _ => ::core::option::Option::None,
            }
        }
    }
}

/// Where each surface of a mode leads.
fn emit_landing(whole: &Whole<'_>, mode: &Mode, own: &TokenStream) -> TokenStream {
    if mode.model.surfaces.is_empty() {
        return quote!(::core::result::Result::Err(::dalembert::Outcome::NoReset {
            surface
        }));
    }
    let types = whole.types();
    let surfaces = mode
        .model
        .surfaces
        .iter()
        .zip(&mode.places.surfaces)
        .enumerate();
    let arms = surfaces.filter_map(|(index, (surface, place))| {
        let transition = surface.transition.as_ref()?;
        let entered = types[transition.enters];
        let passage = passage(transition, mode.model.is_first_order());
        Some(quote! {
            #place => ::dalembert::__private::modes::passage::<#own, #entered>(
                self,
                ::dalembert::__private::modes::Passage::#passage,
                [#index, #place],
                t,
                state,
            ),
        })
    });
    quote! {
        match surface {
            #(#arms)*
            _ => ::dalembert::__private::modes::landing::<#own>(self, surface, t, state),
        }
    }
}

pub(super) fn passage(transition: &Transition, is_first_order: bool) -> TokenStream {
    match (transition.map.is_some(), transition.keeps_lagrangian) {
        (true, _) => quote!(Declared),
        (false, _) if is_first_order => quote!(Kept),
        (false, true) => quote!(Focused),
        (false, false) => quote!(Refracted),
    }
}
