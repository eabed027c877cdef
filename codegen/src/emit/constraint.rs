//! `Constrained`: multipliers, residuals, projections.

use proc_macro2::TokenStream;
use quote::quote;

use super::function::Body;
use super::{Context, doc};
use crate::program::{Constrained, Form};

/// `impl Constrained`, if there are constraints.
pub(super) fn emit_constrained(context: &Context<'_>) -> TokenStream {
    let Some(functions) = &context.program.constrained else {
        return TokenStream::new();
    };
    let type_name = &context.names.type_name;
    let m = context.model.constraints.len();
    let levels = functions.levels.outputs.len();
    let is_reduced = context.program.form == Form::Reduced;
    let solve = emit_multipliers(context, functions);
    let forms = match context.model.is_nonlinear() {
        true => super::nonlinear::emit_forms(context, functions),
        false => emit_forms(context, functions),
    };
    let restore = emit_restore(context, functions);
    let positions = emit_levels(context, functions);
    let declared = emit_declared_levels(context, functions);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Constrained for #type_name {
            type Multipliers = ::dalembert::__private::SVector<f64, #m>;
            type Levels = ::dalembert::__private::SVector<f64, #levels>;

            #[inline(always)]
            fn is_reduced(&self) -> bool { #is_reduced }
            #solve
            #forms
            #restore
            #positions
            #declared
        }
    }
}

fn emit_multipliers(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let m = context.model.constraints.len();
    let multipliers = context.state_body(&functions.multipliers);
    let formula = "m^ab lambda_b = -[ W^a.(f - gdot qdot - Adot) + curvature_a ]";
    let documentation = doc::formula(formula, &functions.multipliers.cost);
    let (statements, values) = (multipliers.statements, multipliers.outputs);
    let residuals = context.velocity_body(&functions.residuals);
    let residuals_doc = doc::formula("eta^a(qdot) + eta^a_0", &functions.residuals.cost);
    let (residual_statements, both) = (residuals.statements, residuals.outputs);
    let (left, right) = both.split_at(m);
    quote! {
        #documentation
        #[inline]
        fn multipliers(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Multipliers, ::dalembert::Fault> {
            #statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#values),*]))
        }

        #residuals_doc
        #[inline]
        fn residuals(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> (Self::Multipliers, Self::Multipliers) {
            #residual_statements
            (
                ::dalembert::__private::vector([#(#left),*]),
                ::dalembert::__private::vector([#(#right),*]),
            )
        }
    }
}

fn emit_forms(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let (n, m) = (context.dimension(), context.model.constraints.len());
    let Body {
        statements,
        outputs,
    } = context.position_body(&functions.forms);
    let (forms, affine) = outputs.split_at(n * m);
    quote! {
        #[inline]
        fn constraint_forms(&self, t: f64, q: &Self::Vector, forms: &mut [f64], affine: &mut Self::Multipliers) {
            #statements
            for (entry, value) in forms.iter_mut().zip([#(#forms),*]) {
                *entry = value;
            }
            *affine = ::dalembert::__private::vector([#(#affine),*]);
        }
    }
}

fn emit_restore(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let Some(back) = &functions.return_to_constraints else {
        return quote! {
            #[inline]
            fn restore(&self, t: f64, state: &mut Self::State) -> ::core::result::Result<(), ::dalembert::Fault> {
                ::core::result::Result::Ok(())
            }
        };
    };
    let documentation = doc::formula(
        "p + g (change of the dependent velocities)",
        &back.restore.cost,
    );
    let Body {
        statements,
        outputs,
    } = context.state_body(&back.restore);
    quote! {
        #documentation
        #[inline]
        fn restore(&self, t: f64, state: &mut Self::State) -> ::core::result::Result<(), ::dalembert::Fault> {
            #statements
            let p = ::dalembert::__private::vector([#(#outputs),*]);
            *state = ::dalembert::__private::join(&<Self as ::dalembert::System>::position(self, state), &p);
            ::core::result::Result::Ok(())
        }
    }
}

fn emit_levels(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let levels = context.position_body(&functions.levels);
    let (level_statements, values) = (levels.statements, levels.outputs);
    let correction = context.position_body(&functions.level_correction);
    let documentation = doc::formula(
        "g^-1 nu_k eta^k, m nu = -excess",
        &functions.level_correction.cost,
    );
    let (correction_statements, change) = (correction.statements, correction.outputs);
    quote! {
        #[inline]
        fn levels(&self, t: f64, q: &Self::Vector) -> Self::Levels {
            #level_statements
            ::dalembert::__private::vector([#(#values),*])
        }

        #documentation
        #[inline]
        fn level_correction(
            &self,
            t: f64,
            q: &Self::Vector,
            excess: &Self::Levels,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::Fault> {
            #correction_statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#change),*]))
        }
    }
}

/// Which constraint each level belongs to, and the sizes of those that are declared to be 0.
fn emit_declared_levels(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let Some(scales) = &functions.level_scales else {
        return TokenStream::new();
    };
    let constraints = context.model.constraints.iter().enumerate();
    let levels = constraints
        .filter(|(_, own)| own.level.is_some())
        .map(|(constraint, own)| {
            let is_zero = own.is_of_positions;
            quote!(::dalembert::Level { constraint: #constraint, is_zero: #is_zero })
        });
    let Body {
        statements,
        outputs,
    } = context.position_body(scales);
    quote! {
        #[inline(always)]
        fn declared_levels(&self) -> &'static [::dalembert::Level] { &[#(#levels),*] }

        #[inline]
        fn level_scales(&self, t: f64, q: &Self::Vector) -> Self::Levels {
            #statements
            ::dalembert::__private::vector([#(#outputs),*])
        }
    }
}

/// `state_nearest` in global form, if there are constraints.
pub(super) fn emit_nearest(context: &Context<'_>) -> TokenStream {
    let constrained = context.program.constrained.as_ref();
    let Some(back) = constrained.and_then(|own| own.return_to_constraints.as_ref()) else {
        return TokenStream::new();
    };
    if context.model.is_nonlinear() {
        return super::nonlinear::emit_nearest(context, back);
    }
    let documentation = doc::formula(
        "p + mu_a eta^a, m mu = -(eta(qdot) + eta_0)",
        &back.nearest.cost,
    );
    let Body {
        statements,
        outputs,
    } = context.velocity_body(&back.nearest);
    quote! {
        #documentation
        #[inline]
        fn state_nearest(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            #statements
            let p = ::dalembert::__private::vector([#(#outputs),*]);
            ::core::result::Result::Ok(::dalembert::__private::join(q, &p))
        }
    }
}

/// What a system with constraints answers where others accept every state.
pub(super) fn emit_system_hooks(context: &Context<'_>) -> TokenStream {
    let Some(functions) = &context.program.constrained else {
        return TokenStream::new();
    };
    let drop = functions.can_lose_rank.then(|| emit_rank_drop(context));
    let positions = functions.level_scales.is_some().then(|| {
        quote! {
            fn complete_position(
                &self,
                t: f64,
                q: &Self::Vector,
                placed: &Self::Vector,
            ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
                ::dalembert::__private::complete_positions(self, t, q, placed)
            }
        }
    });
    quote! {
        #drop
        #positions

        fn admit(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<(), ::dalembert::StateError> {
            ::dalembert::__private::admit(self, t, q, qdot)
        }

        fn complete_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
            named: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            ::dalembert::__private::complete_velocities(self, t, q, qdot, named)
        }
    }
}

/// `rank_drop` of a system whose forms may become dependent.
fn emit_rank_drop(context: &Context<'_>) -> TokenStream {
    let (m, n) = (context.model.constraints.len(), context.dimension());
    quote! {
        #[inline(always)]
        fn can_lose_rank(&self) -> bool { true }

        fn rank_drop(
            &self,
            motion: impl ::core::ops::Fn(f64) -> (f64, Self::State),
            reach: f64,
        ) -> ::core::option::Option<::dalembert::RankDrop> {
            ::dalembert::__private::rank_drop::<Self, #m, #n>(self, motion, reach)
        }
    }
}
