//! `Variational`: states, gaps and transitions over `L: Numbers`, where variations are asked for.
//!
//! The functions are those that are emitted over `f64`, written once more over numbers with their parameters as arguments.
//! They are generic: a program that varies nothing compiles none of them.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::Context;
use super::function::{Body, emit_body, joined, uses};
use crate::program::{Form, Function, Input};

/// What variations take of a form, where they are asked for. A type that holds a reduced model in its global form has none.
pub(super) fn emit_variations(context: &Context<'_>) -> TokenStream {
    if !is_variational(context) {
        return TokenStream::new();
    }
    let type_name = &context.names.type_name;
    let (n, k) = (context.dimension(), context.motion_dimension());
    let (surfaces, collision) = (context.model.surfaces.len(), 5 + k);
    let off = off_constraints(context) + levels(context);
    let state = n + k;
    let attributes = super::attributes();
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::HasVariations for #type_name {
            type Clearances<#numbers> = [L; #surfaces];
            type Collision<#numbers> = [L; #collision];
            type Deviations<#numbers> = [L; #off];
            type Columns = [::dalembert::__private::SVector<f64, #state>; #state];
            type Tangents = [::dalembert::Tangent<Self>; #state];

            fn columns() -> Self::Columns {
                [::dalembert::StateVector::zeros(#state); #state]
            }

            fn tangents() -> Self::Tangents { [::dalembert::Tangent::zero(); #state] }
        }
    }
}

/// Lengths of the vectors of `Variational`.
pub(super) struct Lengths {
    pub configuration: usize,
    pub clearances: usize,
    pub collision: TokenStream,
    pub deviations: TokenStream,
    pub state: TokenStream,
}

impl Lengths {
    /// `impl Variational` with these functions.
    pub(super) fn emit_implementation(
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
        let attributes = super::attributes();
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

/// `visit_variational`, of what is.
pub(super) fn emit_visit(context: &Context<'_>) -> TokenStream {
    if !is_variational(context) {
        return TokenStream::new();
    }
    quote! {
        fn visit_variational<Visitor: ::dalembert::describe::VariationalVisitor>(
            &self,
            visitor: Visitor,
        ) -> ::core::option::Option<Visitor::Output> {
            ::core::option::Option::Some(visitor.visit(self))
        }
    }
}

fn is_variational(context: &Context<'_>) -> bool {
    context.model.extras.variations && !context.is_wrapped()
}

/// Constraints that a state may be off.
fn off_constraints(context: &Context<'_>) -> usize {
    match (context.program.form, &context.program.constrained) {
        (Form::Global, Some(_)) => context.model.constraints.len(),
        _ => 0,
    }
}

/// Constraints with a position level.
fn levels(context: &Context<'_>) -> usize {
    let functions = context.program.constrained.as_ref();
    functions.map_or(0, |functions| functions.levels.outputs.len())
}

impl Context<'_> {
    /// The statements of a function of `(t, s)` over numbers, and its results; where it takes velocities too, they are
    /// computed first.
    pub(super) fn varied_body(&self, function: &Function) -> Body {
        let state = self.bind_row(function);
        let has_velocities = uses(function, |input| matches!(input, Input::Velocity(_)));
        let velocities = match has_velocities {
            true => {
                let bound = self.bind_row_of(function, &self.names.velocities, Input::Velocity);
                quote! {
                    let qdot = <Self as ::dalembert::Variational>::velocities(parameters, t, state)?;
                    let qdot = &qdot;
                    #bound
                }
            }
            false => TokenStream::new(),
        };
        self.written(joined([velocities, state]), function)
    }

    fn written(&self, bindings: TokenStream, function: &Function) -> Body {
        let Body {
            statements,
            outputs,
        } = emit_body(function, &self.names.side_by_side());
        Body {
            statements: joined([bindings, statements]),
            outputs,
        }
    }
}

/// `counts`, of a system with or without surfaces.
pub(super) fn emit_counts(has_surfaces: bool) -> TokenStream {
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
pub(super) fn over_intervals(body: &TokenStream) -> TokenStream {
    quote! {
        fn counts_throughout(
            parameters: &Self::Parameters<::dalembert::numbers::Interval>,
            surface: usize,
            t: ::dalembert::numbers::Interval,
            state: &Self::Row<::dalembert::numbers::Interval>,
        ) -> ::core::option::Option<bool> {
            #body
        }
    }
}
