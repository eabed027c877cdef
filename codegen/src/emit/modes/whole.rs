//! `Declared` of the whole, its tables and series: lengths of vectors, and where each mode finds its own among what the model has.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::Whole;
use crate::emit::{Context, attributes, constraint, declared, describe, kernels};
use crate::model::{Mode, Transition};

/// `impl Declared`, and what the model has.
pub(super) fn emit_declared(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let Lengths {
        state,
        coordinates,
        motion,
        surfaces,
        constraints,
        levels,
        parameters,
        room,
    } = Lengths::of(whole);
    let list = whole.contexts.iter().flatten().rev();
    let list = list.fold(
        quote!(::dalembert::kernels::NoKernels),
        |others, context| {
            let first = kernels::type_name(context);
            quote!(::dalembert::kernels::Choice<#first, #others>)
        },
    );
    let places = crate::emit::names::places(whole.model(), &quote!(self));
    let may_be_narrow = may_be_narrow(whole);
    let hooks = emit_hooks(whole);
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    let parts = [
        (constraints > 0, quote!(HasConstraints)),
        (surfaces > 0, quote!(HasSurfaces)),
    ];
    let parts = parts.iter().filter(|(has, _)| *has).map(|(_, part)| part);
    quote! {
        #attributes
        impl ::dalembert::kernels::Declared for #own {
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
                &<Self as ::dalembert::declaration::Emitted>::TABLES
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

        #(impl ::dalembert::kernels::#parts for #own {})*
    }
}

/// Lengths of the vectors of the whole.
struct Lengths {
    state: usize,
    coordinates: usize,
    motion: usize,
    surfaces: usize,
    constraints: usize,
    levels: usize,
    parameters: usize,
    room: usize,
}

impl Lengths {
    fn of(whole: &Whole<'_>) -> Self {
        let longest = |length: &dyn Fn(&Context<'_>) -> usize| whole.own().map(length).max();
        let longest = |length| longest(length).unwrap_or(0);
        let state = longest(&|own| own.dimension() + own.motion_dimension());
        let coordinates = whole.graph.coordinates.len();
        let rooms = whole.contexts.iter().flatten().map(declared::room);
        Self {
            // The number of the mode stands behind the components.
            state: state + 1,
            coordinates,
            motion: longest(&|own| own.motion_dimension()),
            surfaces: whole.graph.surfaces.len(),
            constraints: longest(&|own| own.model.constraints.len()),
            levels: longest(&|own| declared::levels(own)),
            parameters: whole.model().parameters.len(),
            room: rooms
                .chain([2 * coordinates, whole.graph.outputs.len()])
                .max()
                .unwrap_or(0),
        }
    }
}

fn may_be_narrow(whole: &Whole<'_>) -> bool {
    whole.own().any(|own| own.program.can_be_narrow)
}

fn can_lose_rank(whole: &Whole<'_>) -> bool {
    let mut constrained = whole
        .own()
        .filter_map(|own| own.program.constrained.as_ref());
    constrained.any(|own| own.can_lose_rank)
}

/// What modes with constraints answer where others accept every state.
fn emit_hooks(whole: &Whole<'_>) -> TokenStream {
    let drop = can_lose_rank(whole).then(|| {
        let types = emit_list(whole);
        quote! {
            fn rank_drop_along(
                &self,
                motion: impl ::core::ops::Fn(f64) -> (f64, Self::State),
                reach: f64,
            ) -> ::core::option::Option<::dalembert::RankDrop> {
                ::dalembert::__private::modes::rank_drop::<Self, #types>(self, motion, reach)
            }
        }
    });
    let constrained: Vec<_> = (whole.own())
        .filter_map(|own| own.program.constrained.as_ref())
        .collect();
    let positions = constrained.iter().any(|own| own.level_scales.is_some());
    let positions = positions.then(constraint::emit_positions);
    let nearest = whole.own().any(|own| own.model.is_nonlinear());
    let nearest = nearest.then(constraint::emit_nearest);
    let velocities = (!constrained.is_empty()).then(constraint::emit_velocities);
    quote!(#drop #positions #nearest #velocities)
}

/// The types of the modes as a list: `(First, (Second, ()))`.
fn emit_list(whole: &Whole<'_>) -> TokenStream {
    let types = whole.types();
    let types = types.iter().rev();
    types.fold(quote!(()), |others, mode| quote!((#mode, #others)))
}

/// What is known of the whole.
pub(super) fn emit_tables(whole: &Whole<'_>) -> TokenStream {
    let Lengths {
        state,
        coordinates,
        motion,
        surfaces,
        constraints,
        levels,
        parameters,
        ..
    } = Lengths::of(whole);
    let form = match whole.graph.is_first_order() {
        true => quote!(FirstOrder),
        false => quote!(Global),
    };
    let infos = describe::emit_parameter_infos(whole.model());
    let can_be_narrow = may_be_narrow(whole);
    let can_lose_rank = can_lose_rank(whole);
    let drifts = whole.own().any(describe::drifts);
    let is_linear = whole.own().all(|own| !own.model.is_nonlinear());
    let types = whole.types();
    let own_surfaces = whole.graph.surfaces.iter().map(|entry| {
        let (mode, place) = (types[entry.mode], entry.place);
        quote!(<#mode as ::dalembert::declaration::Emitted>::TABLES.surfaces[#place])
    });
    let modes = emit_modes(whole);
    quote! {
        ::dalembert::kernels::Tables {
            form: ::dalembert::kernels::Form::#form,
            dimensions: ::dalembert::kernels::Dimensions {
                state: #state,
                coordinates: #coordinates,
                motion: #motion,
                constraints: #constraints,
                levels: #levels,
                surfaces: #surfaces,
                parameters: #parameters,
            },
            parameters: &[#infos],
            charts: &[],
            conserves_energy: false,
            can_be_narrow: #can_be_narrow,
            can_lose_rank: #can_lose_rank,
            drifts: #drifts,
            is_linear: #is_linear,
            varies: true,
            levels: &[],
            surfaces: &[#(#own_surfaces),*],
            modes: &[#(#modes),*],
        }
    }
}

/// The forms of the modes and their global forms, in the order of their kernels.
pub(super) fn emit_forms(whole: &Whole<'_>) -> TokenStream {
    let types = whole.contexts.iter().flatten();
    let types = types.map(|context| &context.names.type_name);
    let is_narrow = may_be_narrow(whole);
    quote!(&[#(::dalembert::declaration::of_mode::<#types, #is_narrow>()),*])
}

/// The tables of each mode, and the places of what it has.
fn emit_modes<'w>(whole: &'w Whole<'_>) -> impl Iterator<Item = TokenStream> + 'w {
    let mut kernels = 0_usize;
    let modes = whole.graph.modes.iter().zip(&whole.contexts);
    modes.map(move |(mode, contexts)| {
        let type_name = &contexts[0].names.type_name;
        let (first, global) = (kernels, kernels + contexts.len() - 1);
        kernels += contexts.len();
        let places = &mode.places;
        let [coordinates, constraints, surfaces, outputs] = [
            &places.coordinates,
            &places.constraints,
            &places.surfaces,
            &places.outputs,
        ]
        .map(|own| quote!(&[#(#own),*]));
        let transitions = emit_transitions(whole, mode);
        quote! {
            ::dalembert::kernels::Mode {
                tables: &<#type_name as ::dalembert::declaration::Emitted>::TABLES,
                documentation: &<#type_name as ::dalembert::declaration::Emitted>::DOCUMENTATION,
                kernels: #first,
                global: #global,
                coordinates: #coordinates,
                constraints: #constraints,
                surfaces: #surfaces,
                outputs: #outputs,
                transitions: &[#(#transitions),*],
            }
        }
    })
}

/// Where each surface of a mode leads.
fn emit_transitions<'m>(
    whole: &Whole<'_>,
    mode: &'m Mode,
) -> impl Iterator<Item = TokenStream> + 'm {
    let opposites: Vec<[usize; 2]> = whole.graph.opposites().collect();
    let surfaces = mode.model.surfaces.iter().zip(&mode.places.surfaces);
    surfaces.map(move |(surface, place)| {
        let Some(transition) = &surface.transition else {
            return quote!(::core::option::Option::None);
        };
        let enters = transition.enters;
        let passage = passage(transition, mode.model.is_first_order());
        let has_no_side = transition.has_no_side;
        let opposite = opposites.iter().find(|[own, _]| own == place);
        let opposite = match opposite {
            Some([_, back]) => quote!(::core::option::Option::Some(#back)),
            None => quote!(::core::option::Option::None),
        };
        quote! {
            ::core::option::Option::Some(::dalembert::kernels::Transition {
                enters: #enters,
                passage: ::dalembert::kernels::Passage::#passage,
                has_no_side: #has_no_side,
                opposite: #opposite,
            })
        }
    })
}

fn passage(transition: &Transition, is_first_order: bool) -> TokenStream {
    match (transition.map.is_some(), transition.keeps_lagrangian) {
        (true, _) => quote!(Declared),
        (false, _) if is_first_order => quote!(Kept),
        (false, true) => quote!(Focused),
        (false, false) => quote!(Refracted),
    }
}

/// `From` the whole for each mode.
pub(super) fn emit_conversions(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let modes = whole.types().into_iter().map(|mode| {
        quote! {
            #attributes
            impl ::core::convert::From<#own> for #mode {
                #[inline(always)]
                fn from(model: #own) -> Self { Self(model) }
            }
        }
    });
    quote!(#(#modes)*)
}

/// `impl TaylorField`
pub(super) fn emit_taylor(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let types = whole.types();
    let list = emit_list(whole);
    let Lengths {
        state, parameters, ..
    } = Lengths::of(whole);
    let gaps = count_of_series(whole);
    let lengths = quote!(::dalembert::__private::modes::Lengths { state: #state, gaps: #gaps });
    let modes = quote!((0, <Self as ::dalembert::declaration::Emitted>::TABLES.modes));
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        /// What is known at a moment: rates, gaps, and the rest of the mode that knows most.
        const __FIRSTS: usize = #state + #gaps + ::dalembert::__private::modes::longest(&[
            #(::dalembert::__private::modes::rest::<#types>()),*
        ]);

        #attributes
        impl ::dalembert::TaylorField for #own {
            type Parameters<#numbers> = [L; #parameters];
            type Row<#numbers> = [L; #state];
            type Gaps<#numbers> = [L; #gaps];
            type Firsts<#numbers> = [L; __FIRSTS];
            type Jets<#numbers> = <#list as ::dalembert::__private::modes::ModeList<Self>>::Jets<L>;

            fn work(&self) -> ::core::option::Option<::dalembert::jet::Work> {
                <#list as ::dalembert::__private::modes::ModeList<Self>>::work(self)
            }

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

/// Gaps that have a series: all of them, or none if one of a mode has none.
fn count_of_series(whole: &Whole<'_>) -> usize {
    let have_series = whole.own().all(|context| {
        let components = context.dimension() + context.motion_dimension();
        let gaps = context.program.jet.function.outputs.len() - components;
        gaps == context.model.surfaces.len()
    });
    match have_series {
        true => whole.graph.surfaces.len(),
        false => 0,
    }
}

/// What variations take of the whole.
pub(super) fn emit_variations(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let Lengths {
        state,
        motion,
        surfaces,
        ..
    } = Lengths::of(whole);
    let (collision, deviations) = (5 + motion, state - 1);
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::HasVariations for #own {
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

/// What chooses the mode of a number in the field `mode`; a number past the end changes nothing.
pub(super) fn emit_choice(whole: &Whole<'_>) -> TokenStream {
    let module = Ident::new(&whole.model().snake_name, Span::call_site());
    let arms = whole.graph.modes.iter().enumerate().map(|(index, mode)| {
        let variant = Ident::new(&mode.scene.type_name, Span::call_site());
        let number = Literal::usize_unsuffixed(index);
        quote!(#number => self.mode = #module::Mode::#variant,)
    });
    quote!(match mode { #(#arms)* _ => {} })
}

/// Report of the present mode.
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
