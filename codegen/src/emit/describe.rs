//! `Described` and `Scene`: what the model says of itself, and the effects it comes with.

use dalembert_expr::ExprId;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::function::number;
use super::{Context, doc, parameters, scene};
use crate::model::{Assumption, Constraint, Coordinate, Model, Topology};
use crate::program::Form;
use crate::program::recipes::geometry::Shape;

/// `impl Described`
pub(super) fn emit_described(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let (own, global_name) = (&context.names.own, &context.names.global);
    let description = match context.is_wrapped() {
        true => quote!(<#own as ::dalembert::Described>::DESCRIPTION),
        false => emit_description(context),
    };
    let defaults = match &context.names.held {
        Some(held) => quote!(Self(<#held as ::dalembert::Described>::with_defaults())),
        None => parameters::with_defaults(context.model),
    };
    let (global_type, global) = match context.program.form {
        Form::Global | Form::FirstOrder => (quote!(Self), quote!(*self)),
        Form::Reduced => (quote!(#global_name), quote!(#global_name(*self))),
    };
    let access = emit_parameter_access(context);
    let inputs = super::actuation::emit_names(context);
    let initial = emit_initial(context);
    let declared = emit_declared(context);
    let inspect = emit_inspect(context);
    let scenes = scene::emit_visit(context);
    let variational = super::variational::emit_visit(context);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Described for #type_name {
            const DESCRIPTION: ::dalembert::describe::Description = #description;

            type Global = #global_type;

            #[inline]
            fn global(&self) -> Self::Global { #global }

            fn with_defaults() -> Self { #defaults }

            #access
            #inputs
            #initial
            #declared
            #inspect
            #scenes
            #variational
        }
    }
}

fn emit_description(context: &Context<'_>) -> TokenStream {
    let model = context.model;
    let (type_name, name) = (&model.name, &model.snake_name);
    let documentation = doc::text(&model.documentation);
    let source = &model.source;
    let is_first_order = model.is_first_order();
    let coordinates = model
        .coordinates
        .iter()
        .map(|own| emit_coordinate_info(model, own));
    let parameters = emit_parameter_infos(model);
    let constraints = emit_constraint_infos(model);
    let forces = model.forces.iter().map(|force| &force.name.display);
    let surfaces = (0..model.surfaces.len()).map(|s| emit_surface_info(model, s));
    let quasi = match context.program.form {
        Form::Global | Form::FirstOrder => Vec::new(),
        Form::Reduced => context.quasi_names(),
    };
    let outputs = model.outputs.iter().map(|output| &output.name.display);
    let places: Vec<usize> = (0..model.coordinates.len()).collect();
    let view = emit_view_info(model, &places);
    let scenes = scene::emit_infos(context);
    quote! {
        ::dalembert::describe::Description {
            type_name: #type_name,
            name: #name,
            documentation: #documentation,
            source: #source,
            is_first_order: #is_first_order,
            coordinates: &[#(#coordinates)*],
            parameters: &[#parameters],
            constraints: &[#constraints],
            forces: &[#(#forces),*],
            quasi_velocities: &[#(#quasi),*],
            surfaces: &[#(#surfaces)*],
            outputs: &[#(#outputs),*],
            scenes: &[#scenes],
            modes: &[],
            view: #view,
        }
    }
}

/// What is said of a coordinate, and a comma.
pub(super) fn emit_coordinate_info(model: &Model, coordinate: &Coordinate) -> TokenStream {
    let name = &coordinate.name.display;
    let topology = match coordinate.topology {
        Topology::Line => quote!(Line),
        Topology::Angle => quote!(Circle),
        Topology::Interval { low, high } => {
            let ends = model.pool.eval(&[low, high], &|_| f64::NAN);
            let (low, high) = (number(ends[0]), number(ends[1]));
            quote!(Interval { low: #low, high: #high })
        }
    };
    quote! {
        ::dalembert::describe::CoordinateInfo {
            name: #name,
            topology: ::dalembert::describe::Topology::#topology,
        },
    }
}

/// What is said of all parameters.
pub(super) fn emit_parameter_infos(model: &Model) -> TokenStream {
    let declared = model.parameters.iter().filter(|own| !own.is_input);
    let infos = declared.map(|parameter| {
        let name = &parameter.name.display;
        let assumption = match &parameter.assumption {
            Assumption::Finite => quote!(Finite),
            Assumption::Positive => quote!(Positive),
            Assumption::NonNegative => quote!(NonNegative),
            Assumption::NonZero => quote!(NonZero),
            Assumption::Within { low, high } => {
                let (low, high) = (number(low.to_f64()), number(high.to_f64()));
                quote!(Within { low: #low, high: #high })
            }
        };
        let default = match parameters::default_value(model, parameter) {
            Some(value) => {
                let value = number(value);
                quote!(::core::option::Option::Some(#value))
            }
            None => quote!(::core::option::Option::None),
        };
        quote! {
            ::dalembert::describe::ParameterInfo {
                name: #name,
                assumption: ::dalembert::describe::Assumption::#assumption,
                default: #default,
            },
        }
    });
    quote!(#(#infos)*)
}

fn emit_constraint_infos(model: &Model) -> TokenStream {
    let mut levels = 0_usize;
    let infos = model.constraints.iter().map(|constraint| {
        let level = constraint.level.map(|_| levels);
        levels += usize::from(level.is_some());
        emit_constraint_info(model, constraint, level)
    });
    quote!(#(#infos)*)
}

/// What is said of a constraint, with the index of its level, and a comma.
pub(super) fn emit_constraint_info(
    model: &Model,
    constraint: &Constraint,
    level: Option<usize>,
) -> TokenStream {
    let name = &constraint.name.display;
    let affine = !model.pool.is_syntactic_zero(constraint.affine);
    let level = match level {
        Some(index) => quote!(::core::option::Option::Some(#index)),
        None => quote!(::core::option::Option::None),
    };
    quote!(::dalembert::describe::ConstraintInfo { name: #name, affine: #affine, level: #level },)
}

/// What is said of a surface, and a comma.
pub(super) fn emit_surface_info(model: &Model, surface: usize) -> TokenStream {
    let (name, law) = (
        &model.surfaces[surface].name.display,
        model.law_text(surface),
    );
    quote!(::dalembert::describe::SurfaceInfo { name: #name, law: #law },)
}

/// What is said of the view; `places` are those of the coordinates.
pub(super) fn emit_view_info(model: &Model, places: &[usize]) -> TokenStream {
    let Some(view) = &model.view else {
        return quote!(::core::option::Option::None);
    };
    let labels = &view.labels;
    let plane = match view.plane {
        Some(plane) => {
            let [i, j] = plane.map(|own| places[own]);
            quote!(::core::option::Option::Some([#i, #j]))
        }
        None => quote!(::core::option::Option::None),
    };
    let region = view.region.is_some();
    quote! {
        ::core::option::Option::Some(::dalembert::describe::ViewInfo {
            labels: [#(#labels),*],
            plane: #plane,
            region: #region,
        })
    }
}

/// `parameter` and `set_parameter`.
fn emit_parameter_access(context: &Context<'_>) -> TokenStream {
    emit_access(&context.names.parameters)
}

/// `parameter` and `set_parameter`, of parameters at these places.
pub(super) fn emit_access(places: &[TokenStream]) -> TokenStream {
    let get = places
        .iter()
        .enumerate()
        .map(|(k, place)| quote!(#k => #place,));
    let set = places
        .iter()
        .enumerate()
        .map(|(k, place)| quote!(#k => #place = value,));
    quote! {
        fn parameter(&self, index: usize) -> f64 {
            match index {
                #(#get)*
                _ => ::core::f64::NAN,
            }
        }

        fn set_parameter(&mut self, index: usize, value: f64) {
            match index {
                #(#set)*
                _ => {}
            }
        }
    }
}

fn emit_initial(context: &Context<'_>) -> TokenStream {
    let (model, program) = (context.model, context.program);
    let declared = |values: &[Option<ExprId>]| -> Vec<_> {
        let marks = values
            .iter()
            .map(|value| f64::from(u8::from(value.is_some())));
        marks.map(number).collect()
    };
    let (placed, named) = (declared(&model.initial.q), declared(&model.initial.qdot));
    let kernels = quote!(::dalembert::kernels::Kernels);
    let until = match &program.until {
        Some(_) => {
            quote!(::dalembert::__private::number(self, #kernels::until, 0.0, [&[], &[]]).ok())
        }
        None => quote!(::core::option::Option::None),
    };
    quote! {
        fn initial(&self) -> ::dalembert::describe::Initial<Self::Vector> {
            let declared = ::dalembert::__private::pair(self, #kernels::initial, 0.0, [&[], &[]]);
            let [q, qdot] = declared.unwrap_or([::dalembert::System::zero_vector(self); 2]);
            ::dalembert::describe::Initial {
                q,
                qdot,
                placed: ::dalembert::__private::vector([#(#placed),*]),
                named: ::dalembert::__private::vector([#(#named),*]),
                until: #until,
            }
        }
    }
}

/// Outputs and view.
fn emit_declared(context: &Context<'_>) -> TokenStream {
    let program = context.program;
    let kernels = quote!(::dalembert::kernels::Kernels);
    let state = quote!([::dalembert::StateVector::as_slice(state), &[]]);
    let outputs = match &program.outputs {
        Some(_) => {
            quote!(::dalembert::__private::write(self, #kernels::outputs, t, #state, values))
        }
        None => quote!(::core::result::Result::Ok(())),
    };
    let path = match &program.view_path {
        Some(_) => quote! {
            let mut point = [0.0; 2];
            ::dalembert::__private::write(self, #kernels::view_path, t, #state, &mut point).ok()?;
            ::core::option::Option::Some(point)
        },
        None => quote!(::core::option::Option::None),
    };
    let region = match &program.view_region {
        Some(_) => quote! {
            let q = [::dalembert::StateVector::as_slice(q), &[]];
            ::dalembert::__private::number(self, #kernels::view_region, t, q).ok()
        },
        None => quote!(::core::option::Option::None),
    };
    quote! {
        fn outputs(
            &self,
            t: f64,
            state: &Self::State,
            values: &mut [f64],
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            #outputs
        }

        fn view_path(&self, t: f64, state: &Self::State) -> ::core::option::Option<[f64; 2]> { #path }

        fn view_region(&self, t: f64, q: &Self::Vector) -> ::core::option::Option<f64> { #region }
    }
}

fn emit_inspect(context: &Context<'_>) -> TokenStream {
    let geometry = &context.program.geometry;
    let n = context.dimension();
    let count = geometry.function.outputs.len();
    let statements = quote! {
        let mut values = [0.0; #count];
        let place = [::dalembert::StateVector::as_slice(state), &[]];
        ::dalembert::__private::write(self, ::dalembert::kernels::Kernels::geometry, t, place, &mut values)?;
    };
    let mut next = 0;
    let reports = geometry.groups.iter().map(|group| {
        let first = next;
        next += group.shape.count();
        let (name, last) = (&group.name, next);
        match group.shape {
            Shape::Scalar => quote!(report.scalar(#name, values[#first]);),
            Shape::Vector(_) => quote!(report.vector(#name, &values[#first..#last]);),
            Shape::Matrix(rows, columns) => {
                quote!(report.matrix(#name, #rows, #columns, &values[#first..#last]);)
            }
        }
    });
    let reports: Vec<TokenStream> = reports.collect();
    if context.program.form == Form::Reduced {
        return emit_reduced_inspect(&statements, &reports);
    }
    let volume = context.program.volume.as_ref();
    let integral = volume.is_some_and(|own| own.gradient.is_some()).then(|| {
        quote! {
            let density = ::dalembert::InvariantVolume::log_density(self, t, &::dalembert::System::position(self, state))?;
            report.scalar("log_density", density);
        }
    });
    let end = Literal::usize_unsuffixed(n);
    let p = Ident::new("p", Span::mixed_site());
    let momenta = (!context.is_first_order()).then(|| quote!(report.vector("p", #p);));
    quote! {
        fn inspect(
            &self,
            t: f64,
            state: &Self::State,
            report: &mut dyn ::dalembert::describe::Report,
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            let (q, #p) = ::dalembert::StateVector::as_slice(state).split_at(#end);
            report.vector("q", q);
            #momenta
            #statements
            #(#reports)*
            #integral
            ::core::result::Result::Ok(())
        }
    }
}

/// What is derived on D after what the global form derives.
fn emit_reduced_inspect(statements: &TokenStream, reports: &[TokenStream]) -> TokenStream {
    quote! {
        fn inspect(
            &self,
            t: f64,
            state: &Self::State,
            report: &mut dyn ::dalembert::describe::Report,
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            ::dalembert::__private::inspect_globally(self, t, state, report)?;
            ::dalembert::Described::inspect_frame(self, t, state, report)
        }

        fn inspect_frame(
            &self,
            t: f64,
            state: &Self::State,
            report: &mut dyn ::dalembert::describe::Report,
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            #statements
            #(#reports)*
            ::core::result::Result::Ok(())
        }
    }
}

/// Whether states drift off constraints that they are to be brought back to. A state reduced to D has nothing to be
/// brought back to but the positions of integrable constraints.
pub(super) fn drifts(context: &Context<'_>) -> bool {
    let constrained = context.program.constrained.as_ref();
    let drifts = constrained
        .is_some_and(|own| context.program.form == Form::Global || !own.levels.outputs.is_empty());
    drifts && context.model.extras.projection
}

/// `impl Scene`: the effects of everything that is used.
pub(super) fn emit_scene(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let (mut types, mut values) = (Vec::new(), Vec::new());
    if drifts(context) {
        types.push(quote!(::dalembert::Projection<Self>));
        values.push(quote!(::dalembert::Projection::new()));
    }
    if context.program.impacting.is_some() {
        types.push(quote!(::dalembert::Impacts<Self>));
        values.push(quote!(::dalembert::Impacts::declared(self)));
    }
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Scene for #type_name {
            type Effects = (#(#types,)*);

            fn effects(&self) -> Self::Effects { (#(#values,)*) }
        }
    }
}
