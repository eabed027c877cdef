//! `impl Impacting` of the whole: surfaces and transitions are those of the present mode.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, quote};

use super::Whole;
use crate::emit::attributes;
use crate::model::{Law, Mode, Transition};

/// `impl Impacting`, if there are surfaces or transitions.
pub(super) fn emit_impacting(whole: &Whole<'_>) -> TokenStream {
    if whole.graph.surfaces.is_empty() {
        return TokenStream::new();
    }
    let own = whole.type_name();
    let attributes = attributes();
    let count = whole.graph.surfaces.len();
    let gaps = emit_gaps(whole);
    let laws = emit_laws(whole);
    let impacts = emit_impacts(whole);
    let instantaneous = emit_instantaneous(whole);
    let types = whole.types();
    let alone = whole.graph.surfaces.iter().map(|entry| {
        let (mode, surface) = (types[entry.mode], entry.place);
        quote!(::dalembert::__private::modes::gap_over::<#mode, L>(self, #surface, t, component))
    });
    let over_numbers = emit_over_numbers(&own, alone);
    quote! {
        #over_numbers

        #attributes
        impl ::dalembert::Impacting for #own {
            type Gaps = ::dalembert::__private::SVector<f64, #count>;

            #gaps

            #laws

            #impacts

            #instantaneous
        }
    }
}

/// Gaps and their derivatives, and which of them are limits of the motion.
fn emit_gaps(whole: &Whole<'_>) -> TokenStream {
    let zeros = quote!(::dalembert::Impacting::zero_gaps(self));
    let none = quote!(::core::result::Result::Ok(::core::option::Option::None));
    let gaps = whole.of_surfaces(
        &quote!(::dalembert::__private::modes::no_gaps()),
        |own| quote!(::dalembert::__private::modes::gaps::<#own, _>(self, t, state)),
    );
    let rates = whole.of_surfaces(
        &quote!(::core::result::Result::Ok(#zeros)),
        |own| quote!(::dalembert::__private::modes::gap_rates::<#own, _>(self, t, state)),
    );
    let accelerations = whole.of_surfaces(
        &none,
        |own| quote!(::dalembert::__private::modes::gap_accelerations::<#own, _>(self, t, state, motion)),
    );
    let responses = whole.of_surfaces(
        &none,
        |own| quote!(::dalembert::__private::modes::gap_responses::<#own, _>(self, t, state, motion)),
    );
    let active = whole.of_surfaces(
        &quote!(false),
        |own| quote!(::dalembert::__private::modes::surface_active::<#own>(self, surface, t, state)),
    );
    let gap_along = emit_gap_along();
    let rated = fallible(&quote!(Self::Gaps));
    let optional = fallible(&quote!(::core::option::Option<Self::Gaps>));
    quote! {
        #[inline]
        fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps { #gaps }

        #[inline]
        fn gap_rates(&self, t: f64, state: &Self::State) -> #rated { #rates }

        #gap_along

        fn gap_accelerations(&self, t: f64, state: &Self::State, motion: &Self::Impulse) -> #optional { #accelerations }

        fn gap_responses(&self, t: f64, state: &Self::State, motion: &Self::Impulse) -> #optional { #responses }

        #[inline]
        fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool { #active }
    }
}

/// What is said of a surface wherever the state is: its law, whether it may be passed, and the one that leads back.
fn emit_laws(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    let surfaces = || whole.graph.surfaces.iter().enumerate();
    let laws = surfaces().map(|(place, entry)| {
        let own = types[entry.mode];
        let surface = entry.place;
        quote!(#place => ::dalembert::Impacting::law(&<#own as ::dalembert::Mode>::of(self), #surface),)
    });
    let has_no_side = |transition: &Transition| transition.has_no_side;
    let passable = surfaces().filter(|(_, entry)| {
        let surface = &whole.graph.modes[entry.mode].model.surfaces[entry.place];
        surface.law == Law::Reset || surface.transition.as_ref().is_some_and(has_no_side)
    });
    let passable = passable.map(|(place, _)| Literal::usize_unsuffixed(place));
    let passable: Vec<Literal> = passable.collect();
    let passable = match passable.is_empty() {
        true => quote!(false),
        false => quote!(::core::matches!(surface, #(#passable)|*)),
    };
    let opposite = emit_opposites(whole);
    quote! {
        fn law(&self, surface: usize) -> ::dalembert::law::Law {
            match surface {
                #(#laws)*
                _ => ::dalembert::law::Law::Elastic,
            }
        }

        fn is_passable(&self, surface: usize) -> bool { #passable }

        #opposite
    }
}

/// What happens at a surface: where a transition leads, the impulse, the contact.
fn emit_impacts(whole: &Whole<'_>) -> TokenStream {
    let no_surface = quote! {
        ::core::result::Result::Err(::dalembert::Fault::SingularSurface { surface })
    };
    let landing = whole.of_state(|mode, own| emit_landing(whole, mode, own));
    let blow = whole.of_surfaces(
        &no_surface,
        |own| quote!(::dalembert::__private::modes::blow::<#own, _>(self, surface, t, state)),
    );
    let contact = whole.of_surfaces(
        &no_surface,
        |own| quote!(::dalembert::__private::modes::contact::<#own, _>(self, surface, t, state)),
    );
    let blown = fallible(&quote!(::dalembert::law::Blow<Self::Impulse>));
    let touched = fallible(&quote!(::dalembert::law::Contact<Self::Impulse>));
    quote! {
        fn landing(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<::dalembert::law::Landing<Self::State>, ::dalembert::Outcome> {
            #landing
        }

        #[inline]
        fn blow(&self, surface: usize, t: f64, state: &Self::State) -> #blown { #blow }

        fn contact(&self, surface: usize, t: f64, state: &Self::State) -> #touched { #contact }
    }
}

fn fallible(of: &TokenStream) -> TokenStream {
    quote!(::core::result::Result<#of, ::dalembert::Fault>)
}

/// Whether a surface of some mode has instantaneous constraints.
pub(super) fn is_rough(whole: &Whole<'_>) -> bool {
    let mut surfaces = whole
        .graph
        .modes
        .iter()
        .flat_map(|mode| &mode.model.surfaces);
    surfaces.any(|own| !own.instantaneous.is_empty())
}

/// `focus` and `trace`, where a surface of some mode has instantaneous constraints.
fn emit_instantaneous(whole: &Whole<'_>) -> TokenStream {
    if !is_rough(whole) {
        return TokenStream::new();
    }
    let none = quote!(::core::result::Result::Ok(::core::option::Option::None));
    let focus = whole.of_surfaces(
        &none,
        |own| quote!(::dalembert::__private::modes::focus::<#own, _>(self, surface, t, state)),
    );
    let trace = whole.of_surfaces(
        &none,
        |own| quote!(::dalembert::__private::modes::trace::<#own, _>(self, surface, t, state, motion)),
    );
    let result = fallible(&quote!(::core::option::Option<Self::Impulse>));
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

/// The gaps along stretches of motion and in boxes, which [`emit_over_numbers`] writes once.
fn emit_gap_along() -> TokenStream {
    quote! {
        fn gap_along(
            &self,
            surface: usize,
            t: ::dalembert::numbers::TaylorModel,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::TaylorModel,
        ) -> ::dalembert::numbers::TaylorModel {
            ::dalembert::__private::OverNumbers::gap_over(self, surface, t, component)
        }

        fn gap_about(
            &self,
            surface: usize,
            t: ::dalembert::numbers::Bent,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::Bent,
        ) -> ::dalembert::numbers::Bent {
            ::dalembert::__private::OverNumbers::gap_over(self, surface, t, component)
        }
    }
}

/// Every gap by itself, over any kind of number. `gaps` gives it with numbers of the kind `L`.
fn emit_over_numbers(
    type_name: &impl ToTokens,
    gaps: impl Iterator<Item = TokenStream>,
) -> TokenStream {
    let arms = gaps
        .enumerate()
        .map(|(surface, gap)| quote!(#surface => #gap,));
    let attributes = attributes();
    quote! {
        #attributes
        impl ::dalembert::__private::OverNumbers for #type_name {
            fn gap_over<L: ::dalembert::numbers::Numbers>(
                &self,
                surface: usize,
                t: L,
                component: &dyn ::core::ops::Fn(usize) -> L,
            ) -> L {
                match surface {
                    #(#arms)*
                    _ => ::dalembert::__private::modes::no_gap(),
                }
            }
        }
    }
}
