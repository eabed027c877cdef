//! `VectorField` and `System`: the motion of the state `(q, p)`.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::function::{Body, emit_body, joined, uses};
use super::{Context, doc};
use crate::model::Topology;
use crate::program::{Form, Function, Input};

impl Context<'_> {
    /// Number of coordinates.
    pub(super) fn dimension(&self) -> usize {
        self.model.coordinates.len()
    }

    /// Number of components of the state beside the positions.
    pub(super) fn motion_dimension(&self) -> usize {
        match self.program.form {
            Form::Global => self.dimension(),
            Form::Reduced => self.names.quasi.len(),
            Form::FirstOrder => 0,
        }
    }

    /// The names of the quasi-velocities.
    pub(super) fn quasi_names(&self) -> Vec<String> {
        let quasi = self.frame.iter().flat_map(|frame| &frame.quasi);
        quasi.map(|own| own.name.clone()).collect()
    }

    /// `let [x, y, _] = components(q);` with the coordinates that the function uses.
    pub(super) fn bind_coordinates(&self, function: &Function) -> TokenStream {
        let pattern = pattern(&self.names.coordinates, |i| {
            uses(function, |input| input == Input::Coordinate(i))
        });
        bind(&[pattern], &quote!(q))
    }

    /// `let [x, _, p_x, p_y] = components(state);` with what the function uses.
    pub(super) fn bind_state(&self, function: &Function) -> TokenStream {
        bind(&self.state_patterns(function), &quote!(state))
    }

    /// `let [x, _, p_x, p_y] = *state;` with what the function uses.
    pub(super) fn bind_row(&self, function: &Function) -> TokenStream {
        let patterns = self.state_patterns(function);
        if !patterns.iter().any(|(_, any)| *any) {
            return TokenStream::new();
        }
        let parts = patterns.iter().map(|(tokens, _)| tokens);
        quote!(let [#(#parts),*] = *state;)
    }

    /// `let [x, _] = *source;` with those of some locals that the function uses, from an array called `q` or `qdot`.
    pub(super) fn bind_row_of(
        &self,
        function: &Function,
        locals: &[Ident],
        input: fn(usize) -> Input,
    ) -> TokenStream {
        let (pattern, any) = pattern(locals, |i| uses(function, |own| own == input(i)));
        let source = match input(0) {
            Input::Coordinate(_) => quote!(q),
            _ => quote!(qdot),
        };
        match any {
            true => quote!(let [#pattern, ..] = *#source;),
            false => TokenStream::new(),
        }
    }

    fn state_patterns(&self, function: &Function) -> [(TokenStream, bool); 2] {
        let coordinates = pattern(&self.names.coordinates, |i| {
            uses(function, |input| input == Input::Coordinate(i))
        });
        let motion = match self.program.form {
            Form::Global => self.momentum_pattern(function),
            Form::Reduced => pattern(&self.names.quasi, |i| {
                uses(function, |input| input == Input::Quasi(i))
            }),
            Form::FirstOrder => (TokenStream::new(), false),
        };
        [coordinates, motion]
    }

    fn momentum_pattern(&self, function: &Function) -> (TokenStream, bool) {
        pattern(&self.names.momenta, |i| {
            uses(function, |input| input == Input::Momentum(i))
        })
    }

    /// `let [p_x, _] = components(p);` with what the function uses.
    pub(super) fn bind_momenta(&self, function: &Function) -> TokenStream {
        bind(&[self.momentum_pattern(function)], &quote!(p))
    }

    /// `let [x_dot, _] = components(qdot);` with the velocities that the function uses.
    pub(super) fn bind_velocities(&self, function: &Function) -> TokenStream {
        let velocities = pattern(&self.names.velocities, |i| {
            uses(function, |input| input == Input::Velocity(i))
        });
        bind(&[velocities], &quote!(qdot))
    }

    /// The statements of a function of `(t, q, p)` and its results; where it takes velocities too, they are computed
    /// first.
    pub(super) fn state_body(&self, function: &Function) -> Body {
        let state = self.bind_state(function);
        if !uses(function, |input| matches!(input, Input::Velocity(_))) {
            return self.body(state, function);
        }
        let velocities = self.bind_velocities(function);
        let compute = quote!(let qdot = &<Self as ::dalembert::System>::velocity(self, t, state)?;);
        self.body(quote!(#compute #velocities #state), function)
    }

    /// The statements of a function of `(t, q, qdot)` and its results.
    pub(super) fn velocity_body(&self, function: &Function) -> Body {
        let bindings = [
            self.bind_coordinates(function),
            self.bind_velocities(function),
        ];
        self.body(quote!(#(#bindings)*), function)
    }

    /// The statements of a function of `(t, q)` and its results.
    pub(super) fn position_body(&self, function: &Function) -> Body {
        self.body(self.bind_coordinates(function), function)
    }

    /// The statements of a function of `(t, q)` over numbers that enclose, and its results; `component` gives positions.
    pub(super) fn enclosed_body(&self, function: &Function) -> Body {
        let names = self.names.enclosed();
        let coordinates = names.coordinates.iter().enumerate();
        let used = coordinates.filter(|(i, _)| uses(function, |own| own == Input::Coordinate(*i)));
        let bindings = used.map(|(i, name)| quote!(let #name = component(#i);));
        let bindings = quote!(#(#bindings)*);
        let Body {
            statements,
            outputs,
        } = emit_body(function, &names);
        Body {
            statements: joined([bindings, statements]),
            outputs,
        }
    }

    /// The statements of a function after what binds its arguments.
    pub(super) fn body(&self, bindings: TokenStream, function: &Function) -> Body {
        let Body {
            statements,
            outputs,
        } = emit_body(function, &self.names);
        Body {
            statements: joined([bindings, statements]),
            outputs,
        }
    }
}

/// A pattern of locals, `_` where nothing is used; and whether anything is.
fn pattern(locals: &[Ident], used: impl Fn(usize) -> bool) -> (TokenStream, bool) {
    let mut any = false;
    let parts = locals.iter().enumerate().map(|(i, local)| match used(i) {
        true => {
            any = true;
            quote!(#local)
        }
        false => quote!(_),
    });
    let parts: Vec<TokenStream> = parts.collect();
    (quote!(#(#parts),*), any)
}

fn bind(patterns: &[(TokenStream, bool)], source: &TokenStream) -> TokenStream {
    if !patterns.iter().any(|(_, any)| *any) {
        return TokenStream::new();
    }
    let parts = patterns.iter().map(|(tokens, _)| tokens);
    quote!(let [#(#parts),*] = ::dalembert::__private::components(#source);)
}

/// `impl VectorField`
pub(super) fn emit_field(context: &Context<'_>) -> TokenStream {
    let (type_name, n) = (&context.names.type_name, context.dimension());
    let program = context.program;
    let size = n + context.motion_dimension();
    let formula = match (program.form, &program.constrained) {
        (Form::Reduced, _) => {
            "qdot = X_0 + X u, G_D udot = X^T (f - gdot qdot - Adot - g (Xdot u + Xdot_0))"
        }
        (Form::FirstOrder, _) => "qdot = f(t, q)",
        (_, Some(_)) => "qdot = g^-1 (p - A), pdot = dL/dq + F + lambda_a eta^a",
        (_, None) => "qdot = g^-1 (p - A), pdot = dL/dq + F",
    };
    let documentation = doc::formula(formula, &program.rate.cost);
    let order = doc::lines(&[
        String::new(),
        format!("State: `{}`.", doc::state_order(context)),
    ]);
    let Body {
        statements,
        outputs,
    } = context.state_body(&program.rate);
    let along = program.can_be_narrow.then(emit_rates_along);
    let scale = context.position_body(&program.scale);
    let scale_doc = match program.form {
        Form::Global => {
            "1 for a coordinate, `g_ii` for its momentum: what a unit of velocity makes of it."
        }
        Form::FirstOrder => "1.",
        Form::Reduced => {
            "The norm of its form for a quasi-velocity; for a coordinate what unit quasi-velocities make of its velocity, 1 \
             where that depends on the configuration."
        }
    };
    let scale_doc = doc::lines(&[scale_doc]);
    let (scale_statements, units) = (scale.statements, scale.outputs);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::VectorField for #type_name {
            type State = ::dalembert::__private::SVector<f64, #size>;

            #documentation
            #order
            #[inline]
            fn rate(
                &self,
                t: f64,
                state: &Self::State,
                rate: &mut Self::State,
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #statements
                *rate = ::dalembert::__private::vector([#(#outputs),*]);
                ::core::result::Result::Ok(())
            }

            #scale_doc
            #[inline]
            fn scale(&self, t: f64, state: &Self::State) -> Self::State {
                let q = &<Self as ::dalembert::System>::position(self, state);
                #scale_statements
                ::dalembert::__private::vector([#(#units),*])
            }

            #along
        }
    }
}

/// `rates_along`, where the rate may have narrow features.
pub(super) fn emit_rates_along() -> TokenStream {
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

/// `impl System`
pub(super) fn emit_system(context: &Context<'_>) -> TokenStream {
    let (type_name, n) = (&context.names.type_name, context.dimension());
    let k = context.motion_dimension();
    let states = match &context.program.reduced {
        _ if context.is_first_order() => super::first_order::emit_state_functions(),
        Some(functions) => super::reduced::emit_state_functions(context, functions),
        None => emit_momentum_functions(context),
    };
    let derived = emit_derived_functions(context);
    let chart = emit_chart(context);
    let conserves = emit_conserves_energy(context);
    let coefficients = super::impact::emit_coefficient_checks(context);
    let constrained = match context.program.constrained {
        Some(_) => super::constraint::emit_system_hooks(context),
        None => TokenStream::new(),
    };
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::System for #type_name {
            type Vector = ::dalembert::__private::SVector<f64, #n>;
            type Impulse = ::dalembert::__private::SVector<f64, #k>;

            #[inline]
            fn position(&self, state: &Self::State) -> Self::Vector {
                ::dalembert::__private::part::<0, _, _>(state)
            }

            #states

            #[inline]
            fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse) {
                for i in 0..#k {
                    state[#n + i] += size * direction[i];
                }
            }

            #derived

            fn check_parameters(&self) -> ::core::result::Result<(), ::dalembert::ParameterError> {
                ::dalembert::__private::check_parameters(self)?;
                #coefficients
                ::core::result::Result::Ok(())
            }

            #conserves
            #chart
            #constrained
        }
    }
}

/// The hook that says that the energy is kept between impacts: where nothing but a Lagrangian without time moves the system.
fn emit_conserves_energy(context: &Context<'_>) -> TokenStream {
    let model = context.model;
    let lagrangian = model.lagrangian.whole;
    let is_free =
        model.forces.is_empty() && model.constraints.is_empty() && !model.is_first_order();
    let is_steady = !model.pool.depends_on(lagrangian, model.time)
        && model
            .inputs()
            .all(|(_, input)| !model.pool.depends_on(lagrangian, input.symbol));
    if context.program.impacting.is_none() || !(is_free && is_steady) {
        return TokenStream::new();
    }
    quote! {
        #[inline]
        fn conserves_energy(&self) -> bool {
            true
        }
    }
}

/// States from velocities or momenta, and impulses.
fn emit_momentum_functions(context: &Context<'_>) -> TokenStream {
    let n = context.dimension();
    let function = &context.program.momentum;
    let documentation = doc::formula("p = g qdot + A", &function.cost);
    let Body {
        statements,
        outputs,
    } = context.velocity_body(function);
    let nearest = super::constraint::emit_nearest(context);
    quote! {
        #[inline]
        fn momentum(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::Fault> {
            ::core::result::Result::Ok(::dalembert::__private::part::<#n, _, _>(state))
        }

        #documentation
        #[inline]
        fn state_unchecked(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            #statements
            let p = ::dalembert::__private::vector([#(#outputs),*]);
            ::core::result::Result::Ok(::dalembert::__private::join(q, &p))
        }

        #[inline]
        fn state_from_momenta(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            ::core::result::Result::Ok(::dalembert::__private::join(q, p))
        }

        #nearest
    }
}

/// Velocity and energy.
fn emit_derived_functions(context: &Context<'_>) -> TokenStream {
    let program = context.program;
    let velocity = context.state_body(&program.velocity);
    let formula = match program.form {
        Form::Global => "qdot = g^-1 (p - A)",
        Form::Reduced => "qdot = X_0 + X u",
        Form::FirstOrder => "qdot = f(t, q)",
    };
    let velocity_doc = doc::formula(formula, &program.velocity.cost);
    let (velocity_statements, qdot) = (velocity.statements, velocity.outputs);
    let energy = match context.is_first_order() {
        true => super::first_order::emit_energy(),
        false => emit_energy(context),
    };
    quote! {
        #velocity_doc
        #[inline]
        fn velocity(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::Fault> {
            #velocity_statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#qdot),*]))
        }

        #energy
    }
}

fn emit_energy(context: &Context<'_>) -> TokenStream {
    let function = &context.program.energy;
    let documentation = doc::formula("H = g(qdot, qdot)/2 + V", &function.cost);
    let Body {
        statements,
        outputs,
    } = context.state_body(function);
    let value = &outputs[0];
    quote! {
        #documentation
        #[inline]
        fn energy(&self, t: f64, state: &Self::State) -> ::core::result::Result<f64, ::dalembert::Fault> {
            #statements
            ::core::result::Result::Ok(#value)
        }
    }
}

/// `outside_chart` for coordinates in open intervals.
fn emit_chart(context: &Context<'_>) -> TokenStream {
    let checks: Vec<TokenStream> = context
        .model
        .coordinates
        .iter()
        .enumerate()
        .filter_map(|(i, coordinate)| {
            let Topology::Interval { low, high } = coordinate.topology else {
                return None;
            };
            let ends = context.model.pool.eval(&[low, high], &|_| f64::NAN);
            let (low, high) = (
                super::function::number(ends[0]),
                super::function::number(ends[1]),
            );
            Some(quote! {
                if !(#low < state[#i] && state[#i] < #high) {
                    return ::core::option::Option::Some(#i);
                }
            })
        })
        .collect();
    if checks.is_empty() {
        return TokenStream::new();
    }
    quote! {
        #[inline]
        fn outside_chart(&self, state: &Self::State) -> ::core::option::Option<usize> {
            #(#checks)*
            ::core::option::Option::None
        }
    }
}
