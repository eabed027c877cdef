//! `Impacting`: gaps, gap rates, conditions, laws and contacts.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::function::{Body, emit_body, joined};
use super::{Context, doc};
use crate::model::{Beside, Condition, Law};
use crate::program::{Function, Impacting};

/// `impl Impacting`, if there are surfaces.
pub(super) fn emit_impacting(context: &Context<'_>) -> TokenStream {
    let Some(functions) = &context.program.impacting else {
        return TokenStream::new();
    };
    let type_name = &context.names.type_name;
    let s = context.model.surfaces.len();
    let gaps = emit_gaps(context, functions);
    let alone = functions.gap_alone.iter().map(|function| {
        let Body {
            statements,
            outputs,
        } = context.enclosed_body(function);
        quote!({ #statements #(#outputs)* })
    });
    let over_numbers = emit_over_numbers(type_name, alone);
    let gap_along = emit_gap_along();
    let responses = match context.is_first_order() {
        true => TokenStream::new(),
        false => emit_responses(context, functions),
    };
    let conditions = emit_conditions(context, functions);
    let laws = emit_laws(context, functions);
    let contacts = match context.is_first_order() {
        true => super::first_order::emit_contacts(),
        false if context.model.is_nonlinear() => super::nonlinear::emit_contacts(),
        false => joined([
            emit_blows(context, functions),
            emit_contacts(context, functions),
        ]),
    };
    let resets = emit_resets(context, functions);
    let instantaneous = super::instantaneous::emit_instantaneous(context, functions);
    let attributes = super::attributes();
    quote! {
        #over_numbers

        #attributes
        impl ::dalembert::Impacting for #type_name {
            type Gaps = ::dalembert::__private::SVector<f64, #s>;
            #gaps
            #gap_along
            #responses
            #conditions
            #laws
            #contacts
            #resets
            #instantaneous
        }
    }
}

fn emit_gaps(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    let gaps = context.state_body(&functions.gaps);
    let gaps_doc = doc::formula("h_s(t, q)", &functions.gaps.cost);
    let (gap_statements, gap_values) = (gaps.statements, gaps.outputs);
    let rates = context.state_body(&functions.gap_rates);
    let rates_doc = doc::formula("dh_s(qdot) + d_t h_s", &functions.gap_rates.cost);
    let (rate_statements, rate_values) = (rates.statements, rates.outputs);
    quote! {
        #gaps_doc
        #[inline]
        fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps {
            #gap_statements
            ::dalembert::__private::vector([#(#gap_values),*])
        }

        #rates_doc
        #[inline]
        fn gap_rates(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Gaps, ::dalembert::Fault> {
            #rate_statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#rate_values),*]))
        }
    }
}

/// The gaps along stretches of motion and in boxes, which [`emit_over_numbers`] writes once.
pub(super) fn emit_gap_along() -> TokenStream {
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
pub(super) fn emit_over_numbers(
    type_name: &impl ToTokens,
    gaps: impl Iterator<Item = TokenStream>,
) -> TokenStream {
    let arms = gaps
        .enumerate()
        .map(|(surface, gap)| quote!(#surface => #gap,));
    let attributes = super::attributes();
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

/// What the surfaces feel of forces and of impulses: for motion along them.
fn emit_responses(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    let accelerations = context.state_body(&functions.gap_accelerations);
    let accelerations_doc = doc::formula(
        "d^2 h_s/dt^2 at these rates of momenta or quasi-velocities",
        &functions.gap_accelerations.cost,
    );
    let (acceleration_statements, acceleration_values) =
        (accelerations.statements, accelerations.outputs);
    let responses = context.state_body(&functions.gap_responses);
    let responses_doc = doc::formula(
        "the change of dh_s(qdot) by an impulse",
        &functions.gap_responses.cost,
    );
    let (response_statements, response_values) = (responses.statements, responses.outputs);
    quote! {
        #accelerations_doc
        #[inline]
        fn gap_accelerations(
            &self,
            t: f64,
            state: &Self::State,
            motion: &Self::Impulse,
        ) -> ::core::result::Result<::core::option::Option<Self::Gaps>, ::dalembert::Fault> {
            #acceleration_statements
            ::core::result::Result::Ok(::core::option::Option::Some(
                ::dalembert::__private::vector([#(#acceleration_values),*])
            ))
        }

        #responses_doc
        #[inline]
        fn gap_responses(
            &self,
            t: f64,
            state: &Self::State,
            motion: &Self::Impulse,
        ) -> ::core::result::Result<::core::option::Option<Self::Gaps>, ::dalembert::Fault> {
            #response_statements
            ::core::result::Result::Ok(::core::option::Option::Some(
                ::dalembert::__private::vector([#(#response_values),*])
            ))
        }
    }
}

fn emit_conditions(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    if functions.conditions.iter().all(Option::is_none) {
        return TokenStream::new();
    }
    let (mut counts, mut takes) = (Vec::new(), Vec::new());
    for (s, function) in functions.conditions.iter().enumerate() {
        let Some(function) = function else {
            continue;
        };
        let Body {
            statements,
            outputs,
        } = context.state_body(function);
        let surface = &context.model.surfaces[s];
        let mut margins = outputs.iter();
        let holds = all_hold(&surface.conditions, &mut margins);
        let others = surface.beside.others().iter();
        let others: Vec<_> = others.map(|own| all_hold(own, &mut margins)).collect();
        let counts_here = match &surface.beside {
            Beside::Independent => holds.clone(),
            Beside::Otherwise(_) => quote!(!(#((#others))||*)),
            Beside::Last(_) => quote!((#holds) || !(#((#others))||*)),
        };
        counts.push(quote!(#s => { #statements #counts_here }));
        if matches!(surface.beside, Beside::Last(_)) {
            takes.push(quote!(#s => { #statements #holds }));
        }
    }
    let takes = (!takes.is_empty()).then(|| {
        quote! {
            #[inline]
            fn takes(&self, surface: usize, t: f64, state: &Self::State) -> bool {
                match surface {
                    #(#takes)*
                    _ => true,
                }
            }
        }
    });
    quote! {
        #[inline]
        fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool {
            match surface {
                #(#counts)*
                _ => true,
            }
        }

        #takes
    }
}

/// The test that every condition of a list holds, of which the margins come next.
fn all_hold<'a>(
    conditions: &[Condition],
    margins: &mut impl Iterator<Item = &'a TokenStream>,
) -> TokenStream {
    let holds = conditions.iter().zip(margins);
    let holds = holds.map(|(own, margin)| match own.is_closed {
        true => quote!(#margin >= 0.0),
        false => quote!(#margin > 0.0),
    });
    quote!(#(#holds)&&*)
}

fn emit_laws(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    let arms = context
        .model
        .surfaces
        .iter()
        .zip(&functions.coefficients)
        .enumerate()
        .map(|(s, (surface, coefficient))| {
            let law = match surface.law {
                Law::Elastic => quote!(Elastic),
                Law::Restitution(_) => quote!(Restitution),
                Law::Newton(_) => quote!(Newton),
                Law::NonholonomicPlastic => quote!(NonholonomicPlastic),
                Law::ImpactPlastic => quote!(ImpactPlastic),
                Law::TotallyPlastic => quote!(TotallyPlastic),
                Law::Reset => quote!(Reset),
                Law::Transition => quote!(Transition),
            };
            match coefficient {
                Some(function) => {
                    let Body {
                        statements,
                        outputs,
                    } = emit_body(function, &context.names);
                    quote!(#s => { #statements ::dalembert::impacts::law::Law::#law(#(#outputs)*) })
                }
                None => quote!(#s => ::dalembert::impacts::law::Law::#law,),
            }
        });
    quote! {
        #[inline]
        fn law(&self, surface: usize) -> ::dalembert::impacts::law::Law {
            match surface {
                #(#arms)*
                _ => ::dalembert::impacts::law::Law::Elastic,
            }
        }
    }
}

/// Coefficients of restitution against \[0, 1\]: an expression of the parameters shows its value only then.
pub(super) fn emit_coefficient_checks(context: &Context<'_>) -> TokenStream {
    let Some(functions) = &context.program.impacting else {
        return TokenStream::new();
    };
    let coefficients = context.model.surfaces.iter().zip(&functions.coefficients);
    let checks = coefficients.filter_map(|(surface, coefficient)| {
        let Body { statements, outputs } = emit_body(coefficient.as_ref()?, &context.names);
        let name = format!("restitution at {}", surface.name.display);
        Some(quote!({ #statements ::dalembert::__private::check_coefficient(#name, #(#outputs)*)?; }))
    });
    quote!(#(#checks)*)
}

/// What the declared law does, and nothing that other laws would need.
fn emit_blows(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    let arms = functions
        .blows
        .iter()
        .enumerate()
        .filter_map(|(s, function)| {
            let Body {
                statements,
                outputs,
            } = context.state_body(function.as_ref()?);
            let [size, share, direction @ ..] = outputs.as_slice() else {
                return None;
            };
            Some(quote! {
                #s => {
                    #statements
                    ::core::result::Result::Ok(::dalembert::impacts::law::Blow {
                        size: #size,
                        share: #share,
                        direction: ::dalembert::__private::vector([#(#direction),*]),
                    })
                }
            })
        });
    let documentation = laws(
        context,
        "The impulse by the declared law.",
        &functions.blows,
    );
    quote! {
        #documentation
        #[inline]
        fn blow(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<::dalembert::impacts::law::Blow<Self::Impulse>, ::dalembert::Fault> {
            match surface {
                #(#arms)*
                _ => ::core::result::Result::Err(::dalembert::Fault::SingularSurface { surface }),
            }
        }
    }
}

/// What a function does, and by which law on each surface that it is made for.
fn laws(context: &Context<'_>, title: &str, functions: &[Option<Function>]) -> TokenStream {
    let mut lines = vec![title.to_owned(), String::new()];
    for (s, function) in functions.iter().enumerate() {
        if let Some(function) = function {
            let (name, law) = (
                &context.model.surfaces[s].name.display,
                context.model.law_text(s),
            );
            lines.push(format!("* `{name}`: `{law}`, {}.", function.cost));
        }
    }
    doc::lines(&lines)
}

fn emit_contacts(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    let arms = functions.contacts.iter().enumerate().map(|(s, function)| {
        let Body {
            statements,
            outputs,
        } = context.state_body(function);
        let [
            gap_rate,
            constrained_rate,
            surface_rate,
            constrained_compliance,
            free_compliance,
            direction @ ..,
        ] = outputs.as_slice()
        else {
            return TokenStream::new();
        };
        quote! {
            #s => {
                #statements
                ::core::result::Result::Ok(::dalembert::impacts::law::Contact {
                    gap_rate: #gap_rate,
                    constrained_rate: #constrained_rate,
                    surface_rate: #surface_rate,
                    constrained_compliance: #constrained_compliance,
                    free_compliance: #free_compliance,
                    direction: ::dalembert::__private::vector([#(#direction),*]),
                })
            }
        }
    });
    let mut lines = vec![
        "`dh(pi_D grad h)`, `dh(grad h)` and the impulse's direction `pi_D^* dh`.".to_string(),
        String::new(),
    ];
    for (surface, function) in context.model.surfaces.iter().zip(&functions.contacts) {
        lines.push(format!("* `{}`: {}.", surface.name.display, function.cost));
    }
    let documentation = doc::lines(&lines);
    quote! {
        #documentation
        #[inline]
        fn contact(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<::dalembert::impacts::law::Contact<Self::Impulse>, ::dalembert::Fault> {
            match surface {
                #(#arms)*
                _ => ::core::result::Result::Err(::dalembert::Fault::SingularSurface { surface }),
            }
        }
    }
}

/// What the declared resets make of positions and velocities.
fn emit_resets(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    if functions.resets.iter().all(Option::is_none) {
        return TokenStream::new();
    }
    let n = context.dimension();
    let arms = functions
        .resets
        .iter()
        .enumerate()
        .filter_map(|(s, function)| {
            let Body {
                statements,
                outputs,
            } = context.state_body(function.as_ref()?);
            let (q, qdot) = outputs.split_at(n);
            Some(quote! {
                #s => {
                    #statements
                    ::dalembert::impacts::law::Jump {
                        position: ::dalembert::__private::vector([#(#q),*]),
                        velocity: ::dalembert::__private::vector([#(#qdot),*]),
                    }
                }
            })
        });
    let documentation = laws(
        context,
        "Positions and velocities after the declared reset, as functions of those before it.",
        &functions.resets,
    );
    quote! {
        #documentation
        #[inline]
        fn reset(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<
            ::core::option::Option<::dalembert::impacts::law::Jump<Self::Vector>>,
            ::dalembert::Fault,
        > {
            let jump = match surface {
                #(#arms)*
                _ => return ::core::result::Result::Ok(::core::option::Option::None),
            };
            ::core::result::Result::Ok(::core::option::Option::Some(jump))
        }
    }
}
