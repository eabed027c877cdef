//! `Kernels`: every function of a program, once, over `L: Numbers`.
//!
//! The functions of one form are associated functions of a type without fields; methods of `Kernels` call them. A function that is the
//! same as one written before, in another form or scene, is that one.

use std::collections::{BTreeMap, HashMap};

use dalembert_numbers::Kernel;
use dalembert_numbers::kernel::{First, Second};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::function::{Body, emit_body, joined, uses};
use super::{Context, doc};
use crate::program::{Form, Function, Input, Op, Value};

/// Functions that were written, by what they compute, with the path that calls them.
#[derive(Default)]
pub(super) struct Written(HashMap<Key, TokenStream>);

/// What tells functions apart.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    ops: Vec<Op>,
    outputs: Vec<Value>,
    reads: [usize; 4],
}

/// The type of the kernels of a form, and its implementation.
pub(super) fn emit_kernels(context: &Context<'_>, written: &mut Written) -> TokenStream {
    let type_name = type_name(context);
    let mut functions = TokenStream::new();
    let mut velocity = TokenStream::new();
    let (mut plain, mut of_surfaces) = (TokenStream::new(), BTreeMap::new());
    for (kernel, function) in context.program.kernels() {
        if context.model.is_nonlinear() && is_of_impulses(kernel) {
            continue;
        }
        let (name, surface) = name(kernel);
        let own = match surface {
            Some(surface) => Ident::new(&format!("{name}_{surface}"), Span::call_site()),
            None => name.clone(),
        };
        let key = key(context, kernel, function);
        let path = written.0.entry(key).or_insert_with(|| {
            functions.extend(emit_function(context, (kernel, function), &own, &velocity));
            quote!(#type_name::#own)
        });
        if kernel == Kernel::Velocity {
            velocity = path.clone();
        }
        match surface {
            None => plain.extend(emit_method(
                &name,
                &TokenStream::new(),
                &quote!(#path(at, values)),
            )),
            Some(surface) => {
                let surface = Literal::usize_unsuffixed(surface);
                let arms: &mut TokenStream = of_surfaces.entry(name).or_default();
                arms.extend(quote!(#surface => #path(at, values),));
            }
        }
    }
    let of_surfaces = of_surfaces.iter().map(|(name, arms)| {
        let body = quote! {
            match surface {
                #arms
                _ => ::core::result::Result::Err(::dalembert::Fault::NotDerived),
            }
        };
        emit_method(name, &quote!(surface: usize,), &body)
    });
    let attributes = super::attributes();
    quote! {
        /// Kernels of a form.
        #[derive(Debug, Clone, Copy)]
        pub struct #type_name;

        #attributes
        impl #type_name { #functions }

        #attributes
        impl ::dalembert::kernels::Kernels for #type_name {
            #plain
            #(#of_surfaces)*
        }
    }
}

/// A method of `Kernels`.
fn emit_method(name: &Ident, surface: &TokenStream, body: &TokenStream) -> TokenStream {
    quote! {
        #[inline(always)]
        fn #name<L: ::dalembert::numbers::Numbers>(
            &self,
            #surface
            at: ::dalembert::kernels::At<'_, L>,
            values: &mut [L],
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            #body
        }
    }
}

/// The type that has the kernels of a form.
pub(super) fn type_name(context: &Context<'_>) -> Ident {
    let name = context.names.type_name.to_string();
    let name: String = name
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == '_')
        .collect();
    Ident::new(&format!("{name}Kernels"), Span::call_site())
}

/// Whether a kernel belongs to impulses and discrete principles, which constraints that are not linear define none of.
fn is_of_impulses(kernel: Kernel) -> bool {
    matches!(
        kernel,
        Kernel::Blow(_) | Kernel::Contact(_) | Kernel::ReactionForce | Kernel::ConstrainedVelocity
    )
}

fn key(context: &Context<'_>, kernel: Kernel, function: &Function) -> Key {
    let takes_velocities = takes_velocities(kernel, function);
    let motion = match kernel.first() {
        First::State => context.motion_dimension(),
        _ => 0,
    };
    Key {
        ops: function.ops.clone(),
        outputs: function.outputs.clone(),
        reads: [
            kernel.first() as usize,
            kernel.second() as usize,
            motion,
            usize::from(takes_velocities),
        ],
    }
}

/// Whether velocities are to be computed from the state first.
fn takes_velocities(kernel: Kernel, function: &Function) -> bool {
    kernel.second() != Second::Velocities
        && uses(function, |input| matches!(input, Input::Velocity(_)))
}

/// The function of a kernel; `velocity` calls the one that gives velocities.
fn emit_function(
    context: &Context<'_>,
    (kernel, function): (Kernel, &Function),
    name: &Ident,
    velocity: &TokenStream,
) -> TokenStream {
    let documentation = documentation(context, kernel, function);
    let bindings = [
        bind_parameters(context, function),
        bind_time(function),
        bind_first(context, (kernel, function), velocity),
        bind_second(context, kernel, function),
    ];
    let Body {
        statements,
        outputs,
    } = emit_body(function, &context.names);
    let bindings = joined(bindings);
    quote! {
        #documentation
        #[inline]
        fn #name<L: ::dalembert::numbers::Numbers>(
            at: ::dalembert::kernels::At<'_, L>,
            values: &mut [L],
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            #bindings
            #statements
            *::dalembert::__private::places(values) = [#(#outputs),*];
            ::core::result::Result::Ok(())
        }
    }
}

fn bind_parameters(context: &Context<'_>, function: &Function) -> TokenStream {
    let count = context.names.parameters.len();
    match uses(function, |input| matches!(input, Input::Parameter(_))) {
        true => {
            quote!(let parameters = ::dalembert::__private::numbers::<L, #count>(at.parameters);)
        }
        false => TokenStream::new(),
    }
}

fn bind_time(function: &Function) -> TokenStream {
    match uses(function, |input| input == Input::Time) {
        true => quote!(let t = at.t;),
        false => TokenStream::new(),
    }
}

/// The locals of what stands in the first place, and velocities where they are to be computed from it.
fn bind_first(
    context: &Context<'_>,
    (kernel, function): (Kernel, &Function),
    velocity: &TokenStream,
) -> TokenStream {
    let coordinates = locals(&context.names.coordinates, function, Input::Coordinate);
    let motion = match (kernel.first(), context.program.form) {
        (First::State, Form::Global) => locals(&context.names.momenta, function, Input::Momentum),
        (First::State, Form::Reduced) => locals(&context.names.quasi, function, Input::Quasi),
        _ => Vec::new(),
    };
    let bound = bind(&[coordinates, motion].concat(), &quote!(at.first));
    if !takes_velocities(kernel, function) {
        return bound;
    }
    let n = context.dimension();
    let velocities = locals(&context.names.velocities, function, Input::Velocity);
    let velocities = bind(&velocities, &quote!(&qdot));
    quote! {
        let mut qdot = [L::ZERO; #n];
        #velocity(at, &mut qdot)?;
        #velocities
        #bound
    }
}

/// The locals of what stands in the second place.
fn bind_second(context: &Context<'_>, kernel: Kernel, function: &Function) -> TokenStream {
    match kernel.second() {
        Second::Nothing => TokenStream::new(),
        Second::Velocities => bind(
            &locals(&context.names.velocities, function, Input::Velocity),
            &quote!(at.second),
        ),
        Second::Momenta => bind(
            &locals(&context.names.momenta, function, Input::Momentum),
            &quote!(at.second),
        ),
        Second::Motion => quote!(let motion = at.second;),
        Second::Excess => quote!(let excess = at.second;),
        Second::Multipliers => quote!(let reactions = at.second;),
    }
}

/// Names for the numbers of a place, none where the function does not use one.
fn locals(names: &[Ident], function: &Function, input: fn(usize) -> Input) -> Vec<Option<Ident>> {
    let names = names.iter().enumerate();
    names
        .map(|(i, name)| uses(function, |own| own == input(i)).then(|| name.clone()))
        .collect()
}

/// `let [x, _, p_x, ..] = *numbers(source);`
fn bind(locals: &[Option<Ident>], source: &TokenStream) -> TokenStream {
    let Some(last) = locals.iter().rposition(Option::is_some) else {
        return TokenStream::new();
    };
    let used = &locals[..=last];
    let count = Literal::usize_unsuffixed(used.len());
    let names = used.iter().map(|local| match local {
        Some(name) => quote!(#name),
        None => quote!(_),
    });
    quote!(let [#(#names),*] = *::dalembert::__private::numbers::<L, #count>(#source);)
}

/// The name of a kernel's method, `gap_rates` or `contact`, and the surface that it is of.
fn name(kernel: Kernel) -> (Ident, Option<usize>) {
    let text = format!("{kernel:?}");
    let (name, surface) = match text.trim_end_matches(')').split_once('(') {
        Some((name, surface)) => (name, surface.parse().ok()),
        None => (text.as_str(), None),
    };
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    (Ident::new(&snake, Span::call_site()), surface)
}

/// The formula of a kernel and what it costs.
fn documentation(context: &Context<'_>, kernel: Kernel, function: &Function) -> TokenStream {
    match formula(context, kernel) {
        Some(formula) => doc::formula(formula, &function.cost),
        None => doc::lines(&[format!("{}.", function.cost)]),
    }
}

fn formula(context: &Context<'_>, kernel: Kernel) -> Option<&'static str> {
    let form = context.program.form;
    Some(match kernel {
        Kernel::Rate => match (form, &context.program.constrained) {
            (Form::Reduced, _) => {
                "qdot = X_0 + X u, G_D udot = X^T (f - gdot qdot - Adot - g (Xdot u + Xdot_0))"
            }
            (Form::FirstOrder, _) => "qdot = f(t, q)",
            (Form::Global, Some(_)) => "qdot = g^-1 (p - A), pdot = dL/dq + F + lambda_a eta^a",
            (Form::Global, None) => "qdot = g^-1 (p - A), pdot = dL/dq + F",
        },
        Kernel::Velocity => match form {
            Form::Global => "qdot = g^-1 (p - A)",
            Form::Reduced => "qdot = X_0 + X u",
            Form::FirstOrder => "qdot = f(t, q)",
        },
        Kernel::Momentum => "p = g (X_0 + X u) + A",
        Kernel::Motion if form == Form::Reduced => "u = alpha(qdot)",
        Kernel::Motion => "p = g qdot + A",
        Kernel::Nearest if form == Form::Reduced => "G_D u = X^T g (qdot - X_0)",
        Kernel::Nearest if context.model.is_nonlinear() => {
            "Newton's step p + mu_a eta^a, m mu = -phi, eta = dphi/dqdot"
        }
        Kernel::Nearest => "p + mu_a eta^a, m mu = -(eta(qdot) + eta_0)",
        Kernel::NearestMomenta => "G_D u = X^T (p - A - g X_0)",
        Kernel::Energy => "H = g(qdot, qdot)/2 + V",
        Kernel::Force => "dL/dq + F",
        Kernel::Multipliers => "m^ab lambda_b = -[ W^a.(f - gdot qdot - Adot) + curvature_a ]",
        Kernel::Residuals => "eta^a(qdot) + eta^a_0",
        Kernel::Restore => "p + g (change of the dependent velocities)",
        Kernel::LevelCorrection => "g^-1 nu_k eta^k, m nu = -excess",
        Kernel::ReactionForce => "lambda_a eta^a",
        Kernel::ConstrainedVelocity => {
            "g^-1 (p - A + mu_a eta^a), m mu = -(eta(g^-1 (p - A)) + eta_0)"
        }
        Kernel::Gaps | Kernel::Gap(_) => "h_s(t, q)",
        Kernel::GapRates => "dh_s(qdot) + d_t h_s",
        Kernel::GapAccelerations => "d^2 h_s/dt^2 at these rates of momenta or quasi-velocities",
        Kernel::GapResponses => "the change of dh_s(qdot) by an impulse",
        Kernel::Contact(_) => "dh(pi_D grad h), dh(grad h), pi_D^* dh",
        Kernel::Divergence => {
            "-theta(qdot) - m_ab W^b(eta_0^a) - m_ab (d_t eta^a)(W^b) + m_ab (d_t g)(W^a, W^b) \
             + tr(dF/dqdot . pi_D g^-1)"
        }
        Kernel::DensityForm => "theta = m_ab L_{W^a} eta^b",
        Kernel::LogDensity => "G",
        Kernel::LogVolume => "G + ln det g - ln |det A_dep|",
        Kernel::DensityGradient => "dG",
        Kernel::Powers => "F_a(qdot), lambda eta(qdot), -d_t L",
        _ => return None,
    })
}
