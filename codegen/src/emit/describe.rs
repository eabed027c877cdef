//! `Documented` and `Scene`: what the model says of itself, and the effects it comes with.

use dalembert_expr::ExprId;
use proc_macro2::TokenStream;
use quote::quote;

use super::function::number;
use super::{Context, declared, doc, parameters, scene};
use crate::model::{Assumption, Constraint, Coordinate, Model, Topology};
use crate::program::Form;
use crate::program::recipes::geometry::Shape;

/// `impl Documented`, and `impl Emitted` with all that is constant of the form.
pub(super) fn emit_documented(context: &Context<'_>) -> TokenStream {
    let (type_name, global_name) = (&context.names.type_name, &context.names.global);
    let model = context.model;
    let defaults = match &context.names.held {
        Some(held) => quote!(Self(<#held as ::dalembert::Described>::with_defaults())),
        None => parameters::with_defaults(model),
    };
    let (global_type, global) = match context.program.form {
        Form::Global | Form::FirstOrder => (quote!(Self), quote!(*self)),
        Form::Reduced => (quote!(#global_name), quote!(#global_name(*self))),
    };
    let set = match &context.names.held {
        Some(held) => {
            quote!(<#held as ::dalembert::describe::Instance>::set_parameter(&mut self.0, index, value);)
        }
        None => emit_set(&context.names.parameters),
    };
    let tables = declared::emit_tables(context);
    let documentation = emit_documentation(context);
    let numbers = context.program.geometry.function.outputs.len();
    let density = emit_integrated_density(context);
    let scenes = scene::emit_visit(context);
    let variational = super::variational::emit_visit(context);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::kernels::Documented for #type_name {
            type Geometry = [f64; #numbers];
            type Global = #global_type;

            #[inline]
            fn documentation(&self) -> &'static ::dalembert::kernels::Documentation {
                &<Self as ::dalembert::declaration::Emitted>::DOCUMENTATION
            }

            #[inline]
            fn globally(&self) -> Self::Global { #global }

            fn set_argument(&mut self, index: usize, value: f64) { #set }

            #density
            #variational
        }

        #attributes
        impl ::dalembert::declaration::Emitted for #type_name {
            const TABLES: ::dalembert::kernels::Tables = #tables;
            const DOCUMENTATION: ::dalembert::kernels::Documentation = #documentation;

            fn declared() -> Self { #defaults }

            #scenes
        }
    }
}

/// The self-description of a form. That of a global form differs from that of its model in the geometry only.
fn emit_documentation(context: &Context<'_>) -> TokenStream {
    let geometry = emit_geometry(context);
    if context.is_wrapped() {
        let own = &context.names.own;
        return quote! {
            ::dalembert::kernels::Documentation {
                geometry: &[#geometry],
                ..<#own as ::dalembert::declaration::Emitted>::DOCUMENTATION
            }
        };
    }
    let model = context.model;
    let description = emit_description(context);
    let inputs = super::actuation::names(context);
    let [placed, named] = [&model.initial.q, &model.initial.qdot].map(|own| emit_marks(own));
    quote! {
        ::dalembert::kernels::Documentation {
            description: #description,
            inputs: &[#(#inputs),*],
            placed: #placed,
            named: #named,
            geometry: &[#geometry],
        }
    }
}

/// Which values were declared.
fn emit_marks(values: &[Option<ExprId>]) -> TokenStream {
    let marks = values.iter().map(Option::is_some);
    quote!(&[#(#marks),*])
}

/// The quantities of the geometry at a state.
fn emit_geometry(context: &Context<'_>) -> TokenStream {
    let quantities = context.program.geometry.groups.iter().map(|group| {
        let name = &group.name;
        let shape = match group.shape {
            Shape::Scalar => quote!(Scalar),
            Shape::Vector(count) => quote!(Vector(#count)),
            Shape::Matrix(rows, columns) => quote!(Matrix(#rows, #columns)),
        };
        quote!(::dalembert::kernels::Quantity { name: #name, shape: ::dalembert::kernels::Shape::#shape })
    });
    quote!(#(#quantities),*)
}

/// The density of an invariant volume that takes an integral.
fn emit_integrated_density(context: &Context<'_>) -> TokenStream {
    let volume = context.program.volume.as_ref();
    let is_global = context.program.form != Form::Reduced;
    if !is_global || volume.is_none_or(|volume| volume.gradient.is_none()) {
        return TokenStream::new();
    }
    quote! {
        fn integrated_density(
            &self,
            t: f64,
            q: &Self::Vector,
        ) -> ::core::option::Option<::core::result::Result<f64, ::dalembert::Fault>> {
            ::core::option::Option::Some(::dalembert::InvariantVolume::log_density(self, t, q))
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
            parameters: <Self as ::dalembert::declaration::Emitted>::TABLES.parameters,
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

/// The statement that sets one of the parameters at these places.
pub(super) fn emit_set(places: &[TokenStream]) -> TokenStream {
    let set = places
        .iter()
        .enumerate()
        .map(|(k, place)| quote!(#k => #place = value,));
    quote! {
        match index {
            #(#set)*
            _ => {}
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
