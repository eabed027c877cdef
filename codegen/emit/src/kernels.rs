//! `Kernels`: every function of a program, emitted once over `L: Numbers`.
//!
//! The functions of a form are the methods of a unit struct. A form inherits the functions that are equal in its base.
//! The base of a form of a scene is the same form of the model. The base of a model's global form is its reduced form.
//! A function that equals an earlier function in another place calls that function.

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use dalembert_numbers::Kernel;
use dalembert_numbers::kernel::{First, Second};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::function::{Body, emit_body, joined, uses};
use super::{Context, doc};
use dalembert_codegen::program::{Form, Function, Input, Op, Value};

/// Largest number of operations of a method that is marked `inline(always)`.
const MOST_INLINED: usize = 1000;

/// The functions emitted so far.
#[derive(Default)]
pub(super) struct Written {
    /// Place of each emitted function.
    places: HashMap<Rc<Key>, Place>,
    /// The functions of each type by kernel, inherited ones included.
    methods: HashMap<Ident, HashMap<Kernel, Rc<Key>>>,
}

/// Identity of a function: functions with equal keys compute the same.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    ops: Vec<Op>,
    outputs: Vec<Value>,
    reads: [usize; 3],
    /// The function that computes the velocities that this function needs.
    velocity: Option<Rc<Key>>,
}

/// Place of an emitted function.
#[derive(Clone, PartialEq)]
struct Place {
    type_name: Ident,
    method: Ident,
    surface: Option<usize>,
}

impl Place {
    /// A call of the function from a method of the type `caller`.
    fn call(&self, caller: &Ident, values: &TokenStream) -> TokenStream {
        let (type_name, method) = (&self.type_name, &self.method);
        let kernels = match type_name == caller {
            true => quote!(self),
            false => quote!(&#type_name),
        };
        let surface = self.surface.map(Literal::usize_unsuffixed);
        let surface = surface.iter();
        quote!(::dalembert::kernels::Kernels::#method(#kernels, #(#surface,)* at, #values))
    }
}

/// The kernel type of a form with its implementation. `base` is the form whose functions it inherits.
pub(super) fn emit_kernels(
    context: &Context<'_>,
    base: Option<&Context<'_>>,
    written: &mut Written,
) -> TokenStream {
    let type_name = type_name(context);
    let base = base.map(self::type_name);
    let kernels = kernels(context);
    let inherited = base.as_ref().and_then(|base| written.methods.get(base));
    let mut methods = inherited.cloned().unwrap_or_default();
    let count = context.form.model.surfaces.len();
    let mut new_methods = differing(&kernels, &methods, count);
    let velocity = kernels.first().map(|velocity| &velocity.key);
    for kernel in &kernels {
        if let Some(method) = new_methods.get_mut(&kernel.method) {
            method.add(context, kernel, velocity, written);
        }
    }
    let emitted = new_methods
        .iter()
        .map(|(name, method)| method.emit(context, name));
    let base = match &base {
        Some(base) => quote!(#base),
        None => quote!(::dalembert::kernels::NoKernels),
    };
    let attributes = super::attributes();
    let names = new_methods.keys();
    let items = quote! {
        /// Kernels of a form.
        #[derive(Debug, Clone, Copy)]
        pub struct #type_name;

        #attributes
        impl ::dalembert::kernels::Kernels for #type_name {
            type Base = #base;
            const BASE: #base = #base;
            const OWN: ::dalembert::kernels::KernelSet =
                ::dalembert::kernels::KernelSet::NONE #(.#names())*;

            #(#emitted)*
        }

        impl ::dalembert::kernels::Given for #type_name {
            const GIVEN: #type_name = #type_name;
        }
    };
    methods.retain(|kernel, _| name(*kernel).1.is_none());
    methods.extend(
        kernels
            .into_iter()
            .map(|written| (written.kernel, written.key)),
    );
    written.methods.insert(type_name, methods);
    items
}

/// The methods of a form with `surfaces` surfaces that differ from those of its base, without statements.
fn differing(
    kernels: &[KernelFunction<'_>],
    inherited: &HashMap<Kernel, Rc<Key>>,
    surfaces: usize,
) -> BTreeMap<Ident, Method> {
    let keys = kernels.iter();
    let keys: HashMap<Kernel, &Rc<Key>> = keys.map(|added| (added.kernel, &added.key)).collect();
    // NOTE: a function that the base has for a surface, and this form does not have, must not be inherited: in the base
    // it belongs to another surface with the same index. An empty method replaces it.
    let missing = inherited.keys().filter(|kernel| {
        let (_, surface) = name(**kernel);
        surface.is_some_and(|surface| surface < surfaces) && !keys.contains_key(kernel)
    });
    let changed = keys.iter();
    let changed = changed.filter(|(kernel, key)| inherited.get(kernel) != Some(key));
    let changed = changed.map(|(kernel, _)| kernel);
    let methods = missing.chain(changed).map(|kernel| {
        let (method, surface) = name(*kernel);
        let is_of_surface = surface.is_some();
        let empty = Method {
            is_of_surface,
            ..Method::default()
        };
        (method, empty)
    });
    methods.collect()
}

/// A method of `Kernels`.
#[derive(Default)]
struct Method {
    is_of_surface: bool,
    operations: usize,
    takes_parameters: bool,
    documentation: TokenStream,
    /// Statements of a kernel without a surface argument.
    plain: TokenStream,
    /// Statements of a kernel with a surface argument, each with the indices of its surfaces.
    arms: Vec<(Vec<usize>, TokenStream)>,
}

impl Method {
    /// Adds a function, or a call if an equal function was emitted before.
    fn add(
        &mut self,
        context: &Context<'_>,
        added: &KernelFunction<'_>,
        velocity: Option<&Rc<Key>>,
        written: &mut Written,
    ) {
        let here = Place {
            type_name: type_name(context),
            method: added.method.clone(),
            surface: added.surface,
        };
        let place = written.places.entry(added.key.clone());
        let place = place.or_insert_with(|| here.clone()).clone();
        self.operations += added.function.ops.len();
        let body = if place == here {
            self.takes_parameters |= takes_parameters(added.function);
            let velocity = velocity.and_then(|key| written.places.get(key));
            emit_statements(context, (added.kernel, added.function), velocity)
        } else {
            place.call(&here.type_name, &quote!(values))
        };
        let Some(surface) = added.surface else {
            self.documentation = documentation(context, added.kernel, added.function);
            self.plain = body;
            return;
        };
        let is_beside = place.type_name == here.type_name && place.method == here.method;
        let arm = self.arms.iter_mut().find(|(surfaces, _)| {
            is_beside && place.surface.is_some_and(|first| surfaces.contains(&first))
        });
        match arm {
            Some((surfaces, _)) => surfaces.push(surface),
            None => self.arms.push((vec![surface], body)),
        }
    }

    fn emit(&self, context: &Context<'_>, name: &Ident) -> TokenStream {
        let (documentation, plain) = (&self.documentation, &self.plain);
        let parameters = self.takes_parameters.then(|| bind_parameters(context));
        let surface = self.is_of_surface.then(|| quote!(surface: usize,));
        // A kernel has one call site per type of system. Sharing a kernel between types must not prevent inlining at
        // these sites.
        let inline = match self.operations <= MOST_INLINED {
            true => quote!(#[inline(always)]),
            false => quote!(#[inline]),
        };
        let choice = surface.as_ref().map(|_| self.emit_choice());
        quote! {
            #documentation
            #inline
            fn #name<L: ::dalembert::numbers::Numbers>(
                &self,
                #surface
                at: ::dalembert::kernels::At<'_, L>,
                values: &mut [L],
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #parameters
                #plain
                #choice
            }
        }
    }

    fn emit_choice(&self) -> TokenStream {
        let arms = self.arms.iter().map(|(surfaces, body)| {
            let surfaces = surfaces
                .iter()
                .map(|surface| Literal::usize_unsuffixed(*surface));
            quote!(#(#surfaces)|* => { #body })
        });
        quote! {
            match surface {
                #(#arms)*
                _ => ::core::result::Result::Err(::dalembert::Fault::NotDerived),
            }
        }
    }
}

/// A function of a form, with its kernel and its method.
struct KernelFunction<'a> {
    kernel: Kernel,
    function: &'a Function,
    method: Ident,
    surface: Option<usize>,
    key: Rc<Key>,
}

/// All functions of a form that are emitted. The function of velocities comes first.
fn kernels<'a>(context: &'a Context<'_>) -> Vec<KernelFunction<'a>> {
    let mut kernels: Vec<KernelFunction<'a>> = Vec::new();
    for (kernel, function) in context.form.kernels() {
        let (method, surface) = name(kernel);
        let velocity = kernels.first().map(|first| first.key.clone());
        kernels.push(KernelFunction {
            kernel,
            function,
            method,
            surface,
            key: Rc::new(key(context, (kernel, function), velocity)),
        });
    }
    kernels
}

/// Name of the kernel type of a form.
pub(super) fn type_name(context: &Context<'_>) -> Ident {
    let name = context.names.type_name.to_string();
    let name: String = name
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == '_')
        .collect();
    Ident::new(&format!("{name}Kernels"), Span::call_site())
}

fn key(
    context: &Context<'_>,
    (kernel, function): (Kernel, &Function),
    velocity: Option<Rc<Key>>,
) -> Key {
    let motion = match kernel.first() {
        First::State => context.form.motion_dimension(),
        _ => 0,
    };
    Key {
        ops: function.ops.clone(),
        outputs: function.outputs.clone(),
        reads: [kernel.first() as usize, kernel.second() as usize, motion],
        velocity: velocity.filter(|_| takes_velocities(kernel, function)),
    }
}

/// True if the function needs velocities that must first be computed from the state.
fn takes_velocities(kernel: Kernel, function: &Function) -> bool {
    kernel.second() != Second::Velocities
        && uses(function, |input| matches!(input, Input::Velocity(_)))
}

/// The statements of a kernel. `velocity` is the place of the function that computes velocities.
fn emit_statements(
    context: &Context<'_>,
    (kernel, function): (Kernel, &Function),
    velocity: Option<&Place>,
) -> TokenStream {
    let bindings = [
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
        #bindings
        #statements
        *::dalembert::__private::places(values) = [#(#outputs),*];
        ::core::result::Result::Ok(())
    }
}

fn takes_parameters(function: &Function) -> bool {
    uses(function, |input| matches!(input, Input::Parameter(_)))
}

fn bind_parameters(context: &Context<'_>) -> TokenStream {
    let count = Literal::usize_unsuffixed(context.names.parameters.len());
    quote!(let parameters: &[L; #count] = ::dalembert::__private::numbers(at.parameters);)
}

fn bind_time(function: &Function) -> TokenStream {
    match uses(function, |input| input == Input::Time) {
        true => quote!(let t = at.t;),
        false => TokenStream::new(),
    }
}

/// Locals for the first argument, and for velocities if they are computed from it.
fn bind_first(
    context: &Context<'_>,
    (kernel, function): (Kernel, &Function),
    velocity: Option<&Place>,
) -> TokenStream {
    let coordinates = locals(&context.names.coordinates, function, Input::Coordinate);
    let motion = match (kernel.first(), context.form.program.form) {
        (First::State, Form::Global) => locals(&context.names.momenta, function, Input::Momentum),
        (First::State, Form::Reduced) => locals(&context.names.quasi, function, Input::Quasi),
        _ => Vec::new(),
    };
    let bound = bind(&[coordinates, motion].concat(), &quote!(at.first));
    if !takes_velocities(kernel, function) {
        return bound;
    }
    let n = context.form.dimension();
    let velocities = locals(&context.names.velocities, function, Input::Velocity);
    let velocities = bind(&velocities, &quote!(&qdot));
    let velocity = velocity.map(|place| place.call(&type_name(context), &quote!(&mut qdot)));
    quote! {
        let mut qdot = [L::ZERO; #n];
        #velocity?;
        #velocities
        #bound
    }
}

/// Locals for the second argument.
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

/// Names for the numbers of an argument; `None` for numbers that the function does not use.
fn locals(names: &[Ident], function: &Function, input: fn(usize) -> Input) -> Vec<Option<Ident>> {
    let names = names.iter().enumerate();
    names
        .map(|(i, name)| uses(function, |used| used == input(i)).then(|| name.clone()))
        .collect()
}

/// `let [x, _, p_x, ..] = *numbers(source);`
fn bind(locals: &[Option<Ident>], source: &TokenStream) -> TokenStream {
    let Some(last) = locals.iter().rposition(Option::is_some) else {
        return TokenStream::new();
    };
    let used = &locals[..=last];
    let names = used.iter().map(|local| match local {
        Some(name) => quote!(#name),
        None => quote!(_),
    });
    quote!(let [#(#names),*] = *::dalembert::__private::numbers(#source);)
}

/// Name of a kernel's method, such as `gap_rates` or `contact`, and the surface that it belongs to.
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

/// Documentation of a kernel: its formula and operation count.
fn documentation(context: &Context<'_>, kernel: Kernel, function: &Function) -> TokenStream {
    match formula(context, kernel) {
        Some(formula) => doc::formula(formula, &function.cost),
        None => doc::lines(&[format!("{}.", function.cost)]),
    }
}

fn formula(context: &Context<'_>, kernel: Kernel) -> Option<&'static str> {
    let form = context.form.program.form;
    Some(match kernel {
        Kernel::Rate => match (form, &context.form.program.constrained) {
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
        Kernel::Nearest if context.form.model.is_nonlinear() => {
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
