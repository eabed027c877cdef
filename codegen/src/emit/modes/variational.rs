//! `Variational` of the whole, and what its modes add over numbers: how they are entered, and their energy.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::Whole;
use super::impacting::{is_rough, passage};
use crate::emit::attributes;
use crate::model::Mode;
use crate::program::Form;

/// `impl VariationalMode` for each mode.
pub(super) fn emit_modes(whole: &Whole<'_>) -> TokenStream {
    let attributes = attributes();
    let modes = whole.own().map(|context| {
        let type_name = &context.names.type_name;
        let holds_momenta = context.program.form == Form::Global;
        quote! {
            #attributes
            impl ::dalembert::__private::modes::VariationalMode for #type_name {
                const HOLDS_MOMENTA: bool = #holds_momenta;
            }
        }
    });
    modes.collect()
}

/// `impl Variational`, where each function asks the mode of the state.
pub(super) fn emit_variational(whole: &Whole<'_>) -> TokenStream {
    let (n, count) = (whole.graph.coordinates.len(), whole.graph.surfaces.len());
    let parts = [
        emit_counts(count > 0),
        emit_counts_throughout(whole),
        emit_asked(whole),
        emit_collision(whole),
        emit_instantaneous(whole),
        emit_resets(),
        emit_passed(whole),
        emit_declared_law(whole),
    ];
    let lengths = Lengths {
        configuration: n,
        clearances: count,
        collision: quote!(5 + __IMPULSE),
        deviations: quote!(__STATE - 1),
        state: quote!(__STATE),
    };
    lengths.emit_implementation(&whole.type_name(), &parts)
}

/// What the mode of a row of numbers answers.
fn of_row(whole: &Whole<'_>, arm: impl Fn(&Mode, &TokenStream) -> TokenStream) -> TokenStream {
    let number = quote!(::dalembert::__private::modes::index_of(state));
    whole.of_number(&number, arm)
}

/// `counts_throughout`, by the surfaces of the mode, where some have conditions.
fn emit_counts_throughout(whole: &Whole<'_>) -> TokenStream {
    let functions = whole.own().filter_map(|own| own.program.impacting.as_ref());
    let mut conditions = functions.flat_map(|functions| &functions.conditions);
    if !conditions.any(Option::is_some) {
        return TokenStream::new();
    }
    let answer = of_row(
        whole,
        |_, own| quote!(::dalembert::__private::modes::counts_throughout_of::<#own>(self, parameters, surface, t, state)),
    );
    over_intervals(&answer)
}

/// The functions of parameters, time and state that give a row.
fn emit_asked(whole: &Whole<'_>) -> TokenStream {
    let asked = [
        (
            quote!(velocities),
            quote!(velocities_of),
            quote!(Configuration),
        ),
        (
            quote!(deviations),
            quote!(deviations_of),
            quote!(Deviations),
        ),
        (
            quote!(clearances),
            quote!(clearances_of),
            quote!(Clearances),
        ),
    ];
    let asked = asked.map(|(name, function, row)| {
        let answer = of_row(
            whole,
            |_, own| quote!(::dalembert::__private::modes::#function::<#own, L, _>(self, parameters, t, state)),
        );
        quote! {
            fn #name<L: ::dalembert::numbers::Numbers>(
                &self,
                parameters: &Self::Parameters<L>,
                t: L,
                state: &Self::Row<L>,
            ) -> ::core::result::Result<Self::#row<L>, ::dalembert::Fault> {
                #answer
            }
        }
    });
    quote!(#(#asked)*)
}

fn emit_collision(whole: &Whole<'_>) -> TokenStream {
    let answer = of_row(
        whole,
        |_, own| quote!(::dalembert::__private::modes::collision_of::<#own, L, _>(self, parameters, surface, t, state)),
    );
    quote! {
        fn collision<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<Self::Collision<L>, ::dalembert::Fault> {
            #answer
        }
    }
}

/// `focus` and `trace`, where a surface of some mode has instantaneous constraints.
fn emit_instantaneous(whole: &Whole<'_>) -> TokenStream {
    if !is_rough(whole) {
        return TokenStream::new();
    }
    let focus = of_row(
        whole,
        |_, own| quote!(::dalembert::__private::modes::focus_of::<#own, L, _>(self, parameters, surface, t, state)),
    );
    let trace = of_row(
        whole,
        |_, own| quote!(::dalembert::__private::modes::trace_of::<#own, L, _>(self, parameters, surface, t, state, rate)),
    );
    over_numbers(&focus, &trace)
}

/// What positions and velocities do not tell without a mode.
fn emit_resets() -> TokenStream {
    quote! {
        fn composed<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            t: L,
            q: &Self::Configuration<L>,
            qdot: &Self::Configuration<L>,
        ) -> ::core::result::Result<Self::Row<L>, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::SeveralModes)
        }

        fn landing<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<::core::option::Option<[Self::Configuration<L>; 2]>, ::dalembert::Fault> {
            ::core::result::Result::Ok(::core::option::Option::None)
        }
    }
}

/// Where each surface of a mode leads.
fn emit_passed(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    let answer = of_row(whole, |mode, own| {
        let surfaces = mode.model.surfaces.iter().zip(&mode.places.surfaces);
        let arms = surfaces
            .enumerate()
            .filter_map(|(index, (surface, place))| {
                let transition = surface.transition.as_ref()?;
                let entered = types[transition.enters];
                let passage = passage(transition, mode.model.is_first_order());
                Some(quote! {
                    #place => ::dalembert::__private::modes::passed_into::<#own, #entered, L, _>(
                        self,
                        parameters,
                        ::dalembert::__private::modes::Passage::#passage,
                        #index,
                        t,
                        state,
                    ),
                })
            });
        quote! {
            match surface {
                #(#arms)*
                _ => ::dalembert::__private::modes::passed_within::<#own, L, _>(self, parameters, surface, t, state),
            }
        }
    });
    quote! {
        fn passed<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<::core::option::Option<Self::Row<L>>, ::dalembert::Fault> {
            #answer
        }
    }
}

fn emit_declared_law(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    let arms = whole.graph.surfaces.iter().enumerate().map(|(place, entry)| {
        let (own, surface) = (types[entry.mode], entry.place);
        quote!(#place => ::dalembert::__private::modes::declared_law_of::<#own, L>(self, parameters, #surface),)
    });
    quote! {
        fn declared_law<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
        ) -> (::dalembert::law::Law, L) {
            match surface {
                #(#arms)*
                _ => (::dalembert::law::Law::Elastic, L::ZERO),
            }
        }
    }
}

/// Lengths of the vectors of `Variational`.
struct Lengths {
    configuration: usize,
    clearances: usize,
    collision: TokenStream,
    deviations: TokenStream,
    state: TokenStream,
}

impl Lengths {
    /// `impl Variational` with these functions.
    fn emit_implementation(
        &self,
        type_name: &impl ToTokens,
        functions: &[TokenStream],
    ) -> TokenStream {
        let Self {
            configuration,
            clearances,
            collision,
            deviations,
            state,
        } = self;
        let attributes = attributes();
        quote! {
            #attributes
            impl ::dalembert::Variational for #type_name {
                type Configuration<L: ::dalembert::numbers::Numbers> = [L; #configuration];
                type Clearances<L: ::dalembert::numbers::Numbers> = [L; #clearances];
                type Collision<L: ::dalembert::numbers::Numbers> = [L; #collision];
                type Deviations<L: ::dalembert::numbers::Numbers> = [L; #deviations];
                type Columns = [Self::State; #state];

                fn columns() -> Self::Columns {
                    [<Self::State as ::dalembert::StateVector>::zeros(#state); #state]
                }

                type Tangents = [::dalembert::Tangent<Self>; #state];

                fn tangents() -> Self::Tangents {
                    [::dalembert::Tangent::zero(); #state]
                }

                #(#functions)*
            }
        }
    }
}

/// `counts`, of a system with or without surfaces.
fn emit_counts(has_surfaces: bool) -> TokenStream {
    let counts = match has_surfaces {
        true => quote!(<Self as ::dalembert::Impacting>::surface_active(
            self, surface, t, state
        )),
        false => quote!(true),
    };
    quote! {
        #[inline]
        fn counts(&self, surface: usize, t: f64, state: &Self::State) -> bool { #counts }
    }
}

/// `counts_throughout` with this body.
fn over_intervals(body: &TokenStream) -> TokenStream {
    quote! {
        fn counts_throughout(
            &self,
            parameters: &Self::Parameters<::dalembert::numbers::Interval>,
            surface: usize,
            t: ::dalembert::numbers::Interval,
            state: &Self::Row<::dalembert::numbers::Interval>,
        ) -> ::core::option::Option<bool> {
            #body
        }
    }
}

/// Both functions of `Variational`, with these bodies.
fn over_numbers(focus: &TokenStream, trace: &TokenStream) -> TokenStream {
    let result = quote! {
        ::core::result::Result<::core::option::Option<Self::Row<L>>, ::dalembert::Fault>
    };
    quote! {
        fn focus<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> #result {
            #focus
        }

        fn trace<L: ::dalembert::numbers::Numbers>(
            &self,
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
            rate: &Self::Row<L>,
        ) -> #result {
            #trace
        }
    }
}
