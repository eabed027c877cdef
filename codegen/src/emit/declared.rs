//! `Declared`: the types of a form's vectors, its tables, and the values of its parameters.

use dalembert_numbers::Kernel;
use proc_macro2::TokenStream;
use quote::quote;

use super::function::number;
use super::{Context, describe, kernels, variational};
use crate::model::{Beside, Condition, Law, Surface, Topology};
use crate::program::{Form, Function, Input, Op};

/// `impl Declared`, and what the form has.
pub(super) fn emit_declared(context: &Context<'_>) -> TokenStream {
    let (type_name, kernels) = (&context.names.type_name, kernels::type_name(context));
    let places = &context.names.parameters;
    let (n, k) = (context.dimension(), context.motion_dimension());
    let (m, s) = (
        context.model.constraints.len(),
        context.model.surfaces.len(),
    );
    let [size, parameters, levels, room] = [n + k, places.len(), levels(context), room(context)];
    let may_be_narrow = context.program.can_be_narrow;
    let hooks = super::constraint::emit_hooks(context);
    let parts = emit_parts(context);
    let attributes = super::attributes();
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::Declared for #type_name {
            type State = ::dalembert::__private::SVector<f64, #size>;
            type Vector = ::dalembert::__private::SVector<f64, #n>;
            type Impulse = ::dalembert::__private::SVector<f64, #k>;
            type Gaps = ::dalembert::__private::SVector<f64, #s>;
            type Multipliers = ::dalembert::__private::SVector<f64, #m>;
            type Levels = ::dalembert::__private::SVector<f64, #levels>;
            type Positions<#numbers> = [L; #n];
            type Components<#numbers> = [L; #size];
            type Arguments<#numbers> = [L; #parameters];
            type Room<#numbers> = [L; #room];
            type Values<'a> = [f64; #parameters];
            type Kernels = #kernels;

            const MAY_BE_NARROW: bool = #may_be_narrow;

            #[inline(always)]
            fn kernels(&self) -> #kernels { #kernels }

            #[inline(always)]
            fn tables(&self) -> &'static ::dalembert::kernels::Tables {
                &<Self as ::dalembert::declaration::Emitted>::TABLES
            }

            #[inline(always)]
            fn arguments(&self) -> [f64; #parameters] { [#(#places),*] }

            #hooks
        }

        #parts
    }
}

/// What the form has besides a motion.
fn emit_parts(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let program = context.program;
    let parts = [
        (program.constrained.is_some(), quote!(HasConstraints)),
        (program.impacting.is_some(), quote!(HasSurfaces)),
        (program.density.is_some(), quote!(HasDivergence)),
    ];
    let parts = parts.iter().filter(|(has, _)| *has).map(|(_, part)| part);
    quote!(#(impl ::dalembert::kernels::#parts for #type_name {})*)
}

/// Levels of constraints.
pub(super) fn levels(context: &Context<'_>) -> usize {
    let constrained = context.program.constrained.as_ref();
    constrained.map_or(0, |own| own.levels.outputs.len())
}

/// Places for the values of every kernel that gives several things at once.
pub(super) fn room(context: &Context<'_>) -> usize {
    let kernels = context.program.kernels().into_iter();
    let several = kernels.filter(|(kernel, _)| {
        matches!(
            kernel,
            Kernel::Residuals
                | Kernel::Forms
                | Kernel::ConstrainedVelocity
                | Kernel::Conditions(_)
                | Kernel::Blow(_)
                | Kernel::Contact(_)
                | Kernel::Reset(_)
                | Kernel::Initial
                | Kernel::Entry(_)
        )
    });
    let counts = several.map(|(_, function)| function.outputs.len());
    // NOTE: blows and contacts are asked for where there are none too.
    counts
        .max()
        .unwrap_or(0)
        .max(5 + context.motion_dimension())
}

pub(super) fn emit_tables(context: &Context<'_>) -> TokenStream {
    let (model, program) = (context.model, context.program);
    let form = match program.form {
        Form::Global => quote!(Global),
        Form::Reduced => quote!(Reduced),
        Form::FirstOrder => quote!(FirstOrder),
    };
    let (n, k) = (context.dimension(), context.motion_dimension());
    let (m, s) = (model.constraints.len(), model.surfaces.len());
    let (count, levels, size) = (context.names.parameters.len(), levels(context), n + k);
    let charts = model.coordinates.iter().enumerate();
    let charts = charts.filter_map(|(i, coordinate)| {
        let Topology::Interval { low, high } = coordinate.topology else {
            return None;
        };
        let ends = model.pool.eval(&[low, high], &|_| f64::NAN);
        let ends = ends.into_iter().map(number);
        Some(quote!(::dalembert::kernels::Chart { coordinate: #i, ends: [#(#ends),*] }))
    });
    let conserves_energy = conserves_energy(context);
    let can_be_narrow = program.can_be_narrow;
    let constrained = program.constrained.as_ref();
    let can_lose_rank = constrained.is_some_and(|own| own.can_lose_rank);
    let is_linear = !model.is_nonlinear();
    let (drifts, varies) = (
        describe::drifts(context),
        variational::is_variational(context),
    );
    let declared_levels = super::constraint::emit_levels(context);
    let dimensions = quote! {
        ::dalembert::kernels::Dimensions {
            state: #size,
            coordinates: #n,
            motion: #k,
            constraints: #m,
            levels: #levels,
            surfaces: #s,
            parameters: #count,
        }
    };
    let of_program = quote! {
        form: ::dalembert::kernels::Form::#form,
        dimensions: #dimensions,
        can_be_narrow: #can_be_narrow,
        can_lose_rank: #can_lose_rank,
        drifts: #drifts,
        varies: #varies,
        levels: &[#declared_levels],
    };
    if context.is_wrapped() {
        let own = &context.names.own;
        return quote! {
            ::dalembert::kernels::Tables {
                #of_program
                ..<#own as ::dalembert::declaration::Emitted>::TABLES
            }
        };
    }
    let parameters = describe::emit_parameter_infos(model);
    let surfaces = model.surfaces.iter().enumerate();
    let surfaces = surfaces.map(|(index, surface)| emit_surface(context, index, surface));
    quote! {
        ::dalembert::kernels::Tables {
            #of_program
            parameters: &[#parameters],
            charts: &[#(#charts),*],
            conserves_energy: #conserves_energy,
            is_linear: #is_linear,
            surfaces: &[#(#surfaces),*],
            modes: &[],
        }
    }
}

/// Whether nothing but a Lagrangian without time moves a system with surfaces: its energy is kept between impacts.
fn conserves_energy(context: &Context<'_>) -> bool {
    let model = context.model;
    let lagrangian = model.lagrangian.whole;
    let is_free =
        model.forces.is_empty() && model.constraints.is_empty() && !model.is_first_order();
    let is_steady = !model.pool.depends_on(lagrangian, model.time)
        && model
            .inputs()
            .all(|(_, input)| !model.pool.depends_on(lagrangian, input.symbol));
    context.program.impacting.is_some() && is_free && is_steady
}

fn emit_surface(context: &Context<'_>, index: usize, surface: &Surface) -> TokenStream {
    let (law, has_coefficient) = match surface.law {
        Law::Elastic => (quote!(Elastic), false),
        Law::Restitution(_) => (quote!(Restitution(0.0)), true),
        Law::Newton(_) => (quote!(Newton(0.0)), true),
        Law::NonholonomicPlastic => (quote!(NonholonomicPlastic), false),
        Law::ImpactPlastic => (quote!(ImpactPlastic), false),
        Law::TotallyPlastic => (quote!(TotallyPlastic), false),
        Law::Reset => (quote!(Reset), false),
        Law::Transition => (quote!(Transition), false),
    };
    let coefficient = match has_coefficient {
        true => {
            let name = format!("restitution at {}", surface.name.display);
            quote!(::core::option::Option::Some(#name))
        }
        false => quote!(::core::option::Option::None),
    };
    let conditions = emit_conditions(&surface.conditions);
    let others = surface
        .beside
        .others()
        .iter()
        .map(|own| emit_conditions(own));
    let beside = match &surface.beside {
        Beside::Independent => quote!(Independent),
        Beside::Otherwise(_) => quote!(Otherwise),
        Beside::Last(_) => quote!(Last),
    };
    let gaps = context.program.impacting.as_ref();
    let takes = gaps.map_or(0, |own| coordinates_of(&own.gap_alone[index]));
    quote! {
        ::dalembert::kernels::Surface {
            law: ::dalembert::law::Law::#law,
            coefficient: #coefficient,
            conditions: #conditions,
            others: &[#(#others),*],
            beside: ::dalembert::kernels::Beside::#beside,
            takes: #takes,
        }
    }
}

fn emit_conditions(conditions: &[Condition]) -> TokenStream {
    let conditions = conditions.iter().map(|own| {
        let is_closed = own.is_closed;
        quote!(::dalembert::kernels::Condition { is_closed: #is_closed })
    });
    quote!(&[#(#conditions),*])
}

/// The coordinates that a function takes, by bits; all from the last bit on share it.
fn coordinates_of(function: &Function) -> u64 {
    let taken = function.ops.iter().filter_map(|op| match op {
        Op::Input(Input::Coordinate(i)) => Some(1_u64 << i.min(&63)),
        _ => None,
    });
    taken.fold(0, |all, bit| all | bit)
}
