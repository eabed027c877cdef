//! Tables as constant expressions. Fields that are equal in another table refer to the constant of that table.

use dalembert_numbers::Held;
use dalembert_numbers::description::{
    Assumption, ConstraintInfo, CoordinateInfo, Description, Documentation, ModeInfo,
    ParameterInfo, Quantity, SurfaceInfo, Topology, ViewInfo,
};
use dalembert_numbers::kernel::Shape;
use dalembert_numbers::law::Law;
use dalembert_numbers::tables::{
    Beside, Chart, Condition, Dimensions, Form, Level, Mode, Passage, Surface, Tables, Transition,
    Work,
};
use proc_macro2::{Ident, Span, TokenStream};
use quote::{ToTokens, quote};

use super::function::number;

/// Values that can be written as constant expressions.
pub(super) trait Constant {
    fn tokens(&self) -> TokenStream;

    /// An expression for a copy of the value, which a constant holds at `place`.
    fn repeated(&self, place: &TokenStream) -> TokenStream {
        place.clone()
    }
}

/// A struct of the runtime, written field by field.
pub(super) trait Record: Constant {
    /// The path of the type.
    fn path() -> TokenStream;

    /// Name and expression of every field. Where `other` has an equal field, the expression refers to it in the
    /// constant `base`.
    fn fields(&self, other: Option<(&Self, &TokenStream)>) -> Vec<(&'static str, TokenStream)>;

    /// A reference to the record. Fields that are equal in `other` are taken from the constant `base`, a reference to
    /// `other`.
    fn tokens_beside(&self, other: &Self, base: &TokenStream) -> TokenStream
    where
        Self: PartialEq,
    {
        if self == other {
            return base.clone();
        }
        let fields = self.fields(Some((other, base))).into_iter();
        let fields = fields.map(|(name, value)| field(name, &value));
        let path = Self::path();
        quote!(&#path { #(#fields),* })
    }

    /// The record, with the expressions of some fields replaced by those in `others`.
    fn tokens_with(&self, others: &[(&str, TokenStream)]) -> TokenStream {
        let path = Self::path();
        let fields = self.fields(None).into_iter().map(|(name, value)| {
            let other = others.iter().find(|(other, _)| *other == name);
            field(name, other.map_or(&value, |(_, tokens)| tokens))
        });
        quote!(#path { #(#fields),* })
    }
}

fn field(name: &str, value: &TokenStream) -> TokenStream {
    let name = Ident::new(name, Span::call_site());
    quote!(#name: #value)
}

macro_rules! plain {
    ($($type:ty),*) => {$(
        impl Constant for $type {
            fn tokens(&self) -> TokenStream {
                self.to_token_stream()
            }
        }
    )*};
}
plain!(bool, usize, u32, u64, &'static str);

impl Constant for f64 {
    fn tokens(&self) -> TokenStream {
        number(*self)
    }
}

impl<T: Constant> Constant for Option<T> {
    fn tokens(&self) -> TokenStream {
        match self {
            Some(value) => {
                let value = value.tokens();
                quote!(::core::option::Option::Some(#value))
            }
            None => quote!(::core::option::Option::None),
        }
    }

    // NOTE: the value is written again, because the content need not implement `Copy`.
    fn repeated(&self, _: &TokenStream) -> TokenStream {
        self.tokens()
    }
}

impl<T: Constant> Constant for Held<[T]> {
    fn tokens(&self) -> TokenStream {
        let values = self.iter().map(Constant::tokens);
        quote!(::dalembert::erased::Held::Static(&[#(#values),*]))
    }

    fn repeated(&self, place: &TokenStream) -> TokenStream {
        quote!(#place.again())
    }
}

impl Constant for Held<str> {
    fn tokens(&self) -> TokenStream {
        let text: &str = self;
        quote!(::dalembert::erased::Held::Static(#text))
    }

    fn repeated(&self, place: &TokenStream) -> TokenStream {
        quote!(#place.again())
    }
}

impl<T: Constant, const N: usize> Constant for [T; N] {
    fn tokens(&self) -> TokenStream {
        let values = self.iter().map(Constant::tokens);
        quote!([#(#values),*])
    }
}

impl<T: Constant> Constant for Held<T> {
    fn tokens(&self) -> TokenStream {
        let value = (**self).tokens();
        quote!(::dalembert::erased::Held::Static(&#value))
    }

    fn repeated(&self, place: &TokenStream) -> TokenStream {
        quote!(#place.again())
    }
}

macro_rules! records {
    ($($module:ident::$name:ident { $($field:ident),* $(,)? })*) => {$(
        impl Record for $name {
            fn path() -> TokenStream {
                quote!(::dalembert::$module::$name)
            }

            fn fields(
                &self,
                other: Option<(&Self, &TokenStream)>,
            ) -> Vec<(&'static str, TokenStream)> {
                // NOTE: destructuring makes a new field a compile error until it is added here.
                let Self { $($field),* } = self;
                vec![$((
                    stringify!($field),
                    match other {
                        Some((other, base)) if other.$field == *$field => {
                            $field.repeated(&quote!(#base.$field))
                        }
                        _ => $field.tokens(),
                    },
                )),*]
            }
        }

        impl Constant for $name {
            fn tokens(&self) -> TokenStream {
                self.tokens_with(&[])
            }

            fn repeated(&self, place: &TokenStream) -> TokenStream {
                let Self { $($field),* } = self;
                let path = Self::path();
                $(let $field = $field.repeated(&quote!(#place.$field));)*
                quote!(#path { $($field: #$field),* })
            }
        }
    )*};
}
records! {
    describe::CoordinateInfo { name, topology }
    describe::ParameterInfo { name, assumption, default }
    describe::ConstraintInfo { name, affine, level }
    describe::ModeInfo { name, coordinates }
    describe::SurfaceInfo { name, law }
    describe::ViewInfo { labels, plane, region }
    describe::Description {
        type_name, name, documentation, source, is_first_order, coordinates, parameters, constraints, forces,
        quasi_velocities, surfaces, outputs, integrals, scenes, modes, view,
    }
    kernels::Quantity { name, shape }
    kernels::Documentation { description, inputs, placed, named, geometry }
    kernels::Dimensions { state, coordinates, motion, constraints, levels, surfaces, parameters }
    kernels::Chart { coordinate, ends }
    kernels::Condition { is_closed }
    kernels::Surface { law, coefficient, conditions, others, beside, kinks, takes, keeps_gap }
    kernels::Level { constraint, is_zero }
    kernels::Transition { enters, passage, has_no_side, opposite, meets }
    kernels::Mode {
        tables, documentation, kernels, global, coordinates, constraints, surfaces, outputs, transitions,
    }
    jet::Work { values, sums, degree }
    kernels::Tables {
        form, dimensions, parameters, charts, conserves_energy, can_be_narrow, can_lose_rank, depends_on_time, drifts,
        is_linear, varies, levels, surfaces, density_reference, modes,
    }
}

/// Enums without data.
macro_rules! choices {
    ($($module:ident::$name:ident)*) => {$(
        impl Constant for $name {
            fn tokens(&self) -> TokenStream {
                let choice = Ident::new(&format!("{self:?}"), Span::call_site());
                quote!(::dalembert::$module::$name::#choice)
            }
        }
    )*};
}
choices! { kernels::Form kernels::Beside kernels::Passage }

impl Constant for Topology {
    fn tokens(&self) -> TokenStream {
        let choice = match self {
            Self::Line => quote!(Line),
            Self::Circle => quote!(Circle),
            Self::Interval { low, high } => {
                let (low, high) = (low.tokens(), high.tokens());
                quote!(Interval { low: #low, high: #high })
            }
        };
        quote!(::dalembert::describe::Topology::#choice)
    }
}

impl Constant for Assumption {
    fn tokens(&self) -> TokenStream {
        let choice = match self {
            Self::Finite => quote!(Finite),
            Self::Positive => quote!(Positive),
            Self::NonNegative => quote!(NonNegative),
            Self::NonZero => quote!(NonZero),
            Self::Within { low, high } => {
                let (low, high) = (low.tokens(), high.tokens());
                quote!(Within { low: #low, high: #high })
            }
        };
        quote!(::dalembert::describe::Assumption::#choice)
    }
}

impl Constant for Law {
    fn tokens(&self) -> TokenStream {
        let choice = match self {
            Self::Elastic => quote!(Elastic),
            Self::Restitution(e) => {
                let e = e.tokens();
                quote!(Restitution(#e))
            }
            Self::Newton(e) => {
                let e = e.tokens();
                quote!(Newton(#e))
            }
            Self::NonholonomicPlastic => quote!(NonholonomicPlastic),
            Self::ImpactPlastic => quote!(ImpactPlastic),
            Self::TotallyPlastic => quote!(TotallyPlastic),
            Self::Stop => quote!(Stop),
            Self::Reset => quote!(Reset),
            Self::Transition => quote!(Transition),
        };
        quote!(::dalembert::law::Law::#choice)
    }
}

impl Constant for Shape {
    fn tokens(&self) -> TokenStream {
        let choice = match self {
            Self::Scalar => quote!(Scalar),
            Self::Vector(count) => quote!(Vector(#count)),
            Self::Matrix(rows, columns) => quote!(Matrix(#rows, #columns)),
        };
        quote!(::dalembert::kernels::Shape::#choice)
    }
}
