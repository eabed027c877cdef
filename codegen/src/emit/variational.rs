//! `Variational`: states, gaps and transitions over `L: Numbers`, where variations are asked for.
//!
//! The functions are those that are emitted over `f64`, written once more over numbers with their parameters as arguments.
//! They are generic: a program that varies nothing compiles none of them.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::Context;
use super::function::{Body, emit_body, joined, uses};
use super::instantaneous::emit_varied;
use crate::model::{Beside, Condition, Law};
use crate::program::{Form, Function, Input};

/// `impl Variational`, where variations are asked for. A type that holds a reduced model in its global form has none.
pub(super) fn emit_variational(context: &Context<'_>) -> TokenStream {
    if !is_variational(context) {
        return TokenStream::new();
    }
    let type_name = &context.names.type_name;
    let (n, k) = (context.dimension(), context.motion_dimension());
    let parts = [
        emit_counts(context.program.impacting.is_some()),
        emit_counts_throughout(context),
        emit_velocities(context),
        emit_composed(context),
        emit_deviations(context),
        emit_clearances(context),
        emit_collision(context),
        emit_varied(context),
        emit_landing(context),
        emit_declared_law(context),
    ];
    let off = off_constraints(context) + levels(context);
    let lengths = Lengths {
        configuration: n,
        clearances: context.model.surfaces.len(),
        collision: (5 + k).to_token_stream(),
        deviations: off.to_token_stream(),
        state: (n + k).to_token_stream(),
    };
    lengths.emit_implementation(type_name, &parts)
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

    /// The statements of a function of `(t, q, qdot)` over numbers, and its results.
    pub(super) fn varied_velocity_body(&self, function: &Function) -> Body {
        let q = self.bind_row_of(function, &self.names.coordinates, Input::Coordinate);
        let qdot = self.bind_row_of(function, &self.names.velocities, Input::Velocity);
        self.written(joined([q, qdot]), function)
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

/// `counts_throughout`, where surfaces have conditions.
fn emit_counts_throughout(context: &Context<'_>) -> TokenStream {
    let functions = context.program.impacting.iter();
    let conditions = functions.flat_map(|functions| &functions.conditions);
    let certain = quote!(::dalembert::__private::certain);
    let arms = conditions.enumerate().filter_map(|(s, function)| {
        let Body {
            statements,
            outputs,
        } = context.varied_body(function.as_ref()?);
        let surface = &context.model.surfaces[s];
        let mut margins = outputs.iter();
        let holds = all_certain(&surface.conditions, &mut margins);
        let others = surface.beside.others().iter();
        let others: Vec<_> = others.map(|own| all_certain(own, &mut margins)).collect();
        let counts = match &surface.beside {
            Beside::Independent => holds,
            Beside::Otherwise(_) => quote!(#certain::none(&[#(#others),*])),
            Beside::Last(_) => quote!(#certain::last(#holds, &[#(#others),*])),
        };
        Some(quote!(#s => { #statements #counts }))
    });
    let arms: Vec<TokenStream> = arms.collect();
    if arms.is_empty() {
        return TokenStream::new();
    }
    over_intervals(&quote! {
        #[allow(unused_imports)]
        use ::dalembert::numbers::Numbers as _;
        type L = ::dalembert::numbers::Interval;
        let counts = || -> ::core::result::Result<_, ::dalembert::Fault> {
            ::core::result::Result::Ok(match surface {
                #(#arms)*
                _ => ::core::option::Option::Some(true),
            })
        };
        counts().ok().flatten()
    })
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

/// Code that tells if every condition of a list holds, from the margins of all conditions in order.
fn all_certain<'a>(
    conditions: &[Condition],
    margins: &mut impl Iterator<Item = &'a TokenStream>,
) -> TokenStream {
    let certain = quote!(::dalembert::__private::certain);
    let holds = conditions.iter().zip(margins).map(|(condition, margin)| {
        let is_closed = condition.is_closed;
        quote!(#certain::holds(#margin, #is_closed))
    });
    quote!(#certain::all(&[#(#holds),*]))
}

fn emit_velocities(context: &Context<'_>) -> TokenStream {
    let Body {
        statements,
        outputs,
    } = context.varied_body(&context.program.velocity);
    quote! {
        fn velocities<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<Self::Configuration<L>, ::dalembert::Fault> {
            #statements
            ::core::result::Result::Ok([#(#outputs),*])
        }
    }
}

fn emit_composed(context: &Context<'_>) -> TokenStream {
    let program = context.program;
    let function = match (&program.reduced, program.form) {
        (_, Form::FirstOrder) => None,
        (Some(reduced), _) => Some(&reduced.quasi),
        (None, _) => Some(&program.momentum),
    };
    let (statements, motion) = match function {
        Some(function) => {
            let body = context.varied_velocity_body(function);
            (body.statements, body.outputs)
        }
        None => (TokenStream::new(), Vec::new()),
    };
    let positions = 0..context.dimension();
    quote! {
        fn composed<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            t: L,
            q: &Self::Configuration<L>,
            qdot: &Self::Configuration<L>,
        ) -> ::core::result::Result<Self::Row<L>, ::dalembert::Fault> {
            #statements
            ::core::result::Result::Ok([#(q[#positions],)* #(#motion),*])
        }
    }
}

fn emit_deviations(context: &Context<'_>) -> TokenStream {
    let off = off_constraints(context);
    let functions = context.program.constrained.as_ref();
    let residuals = functions.filter(|_| off > 0).map(|functions| {
        // The residuals come first; their natural scales after them are not asked for.
        let body = context.varied_velocity_body(&functions.residuals);
        let (statements, values) = (body.statements, &body.outputs[..off]);
        quote! {
            {
                let qdot = <Self as ::dalembert::Variational>::velocities(parameters, t, state)?;
                let (q, qdot) = (state, &qdot);
                #statements
                values[..#off].copy_from_slice(&[#(#values),*]);
            }
        }
    });
    let with_levels = functions.filter(|_| levels(context) > 0).map(|functions| {
        let body = context.varied_body(&functions.levels);
        let (statements, values) = (body.statements, body.outputs);
        quote!({ #statements values[#off..].copy_from_slice(&[#(#values),*]); })
    });
    let values = quote!(<Self::Deviations<L> as ::dalembert::numbers::Row<L>>::zeros(0));
    let body = match off + levels(context) {
        0 => quote!(::core::result::Result::Ok(#values)),
        _ => quote! {
            let mut values = #values;
            #residuals
            #with_levels
            ::core::result::Result::Ok(values)
        },
    };
    quote! {
        fn deviations<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<Self::Deviations<L>, ::dalembert::Fault> {
            #body
        }
    }
}

fn emit_clearances(context: &Context<'_>) -> TokenStream {
    let (statements, gaps) = match &context.program.impacting {
        Some(functions) => {
            let body = context.varied_body(&functions.gaps);
            (body.statements, body.outputs)
        }
        None => (TokenStream::new(), Vec::new()),
    };
    quote! {
        fn clearances<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<Self::Clearances<L>, ::dalembert::Fault> {
            #statements
            ::core::result::Result::Ok([#(#gaps),*])
        }
    }
}

fn emit_collision(context: &Context<'_>) -> TokenStream {
    let functions = context.program.impacting.iter();
    let contacts = functions.flat_map(|functions| &functions.contacts);
    let arms = contacts.enumerate().map(|(s, function)| {
        let Body {
            statements,
            outputs,
        } = context.varied_body(function);
        quote!(#s => { #statements ::core::result::Result::Ok([#(#outputs),*]) })
    });
    let otherwise = match context.is_first_order() {
        true => quote!(::dalembert::Fault::FirstOrder),
        false => quote!(::dalembert::Fault::SingularSurface { surface }),
    };
    quote! {
        fn collision<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<Self::Collision<L>, ::dalembert::Fault> {
            match surface {
                #(#arms)*
                _ => ::core::result::Result::Err(#otherwise),
            }
        }
    }
}

fn emit_landing(context: &Context<'_>) -> TokenStream {
    let n = context.dimension();
    let functions = context.program.impacting.iter();
    let resets = functions.flat_map(|functions| &functions.resets);
    let arms = resets.enumerate().filter_map(|(s, function)| {
        let Body {
            statements,
            outputs,
        } = context.varied_body(function.as_ref()?);
        let (q, qdot) = outputs.split_at(n);
        Some(quote!(#s => { #statements [[#(#q),*], [#(#qdot),*]] }))
    });
    let arms: Vec<TokenStream> = arms.collect();
    let body = match arms.is_empty() {
        true => quote!(::core::result::Result::Ok(::core::option::Option::None)),
        false => quote! {
            let landing = match surface {
                #(#arms)*
                _ => return ::core::result::Result::Ok(::core::option::Option::None),
            };
            ::core::result::Result::Ok(::core::option::Option::Some(landing))
        },
    };
    quote! {
        fn landing<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> ::core::result::Result<::core::option::Option<[Self::Configuration<L>; 2]>, ::dalembert::Fault> {
            #body
        }
    }
}

fn emit_declared_law(context: &Context<'_>) -> TokenStream {
    let functions = context.program.impacting.iter();
    let coefficients = functions.flat_map(|functions| &functions.coefficients);
    let surfaces = context.model.surfaces.iter().zip(coefficients).enumerate();
    let law = quote!(::dalembert::impacts::law::Law);
    let arms = surfaces.map(|(s, (surface, coefficient))| {
        let without = |name: TokenStream| quote!(#s => (#law::#name, L::ZERO),);
        let with = |name: TokenStream| match coefficient {
            Some(function) => {
                let Body {
                    statements,
                    outputs,
                } = context.written(TokenStream::new(), function);
                quote! {
                    #s => {
                        #statements
                        let coefficient: L = #(#outputs)*;
                        (#law::#name(coefficient.lane(0)), coefficient)
                    }
                }
            }
            None => TokenStream::new(),
        };
        match surface.law {
            Law::Elastic => without(quote!(Elastic)),
            Law::Restitution(_) => with(quote!(Restitution)),
            Law::Newton(_) => with(quote!(Newton)),
            Law::NonholonomicPlastic => without(quote!(NonholonomicPlastic)),
            Law::ImpactPlastic => without(quote!(ImpactPlastic)),
            Law::TotallyPlastic => without(quote!(TotallyPlastic)),
            Law::Reset => without(quote!(Reset)),
            Law::Transition => without(quote!(Transition)),
        }
    });
    quote! {
        fn declared_law<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            surface: usize,
        ) -> (#law, L) {
            match surface {
                #(#arms)*
                _ => (#law::Elastic, L::ZERO),
            }
        }
    }
}
