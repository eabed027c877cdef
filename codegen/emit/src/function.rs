//! Straight-line functions as statements.
//!
//! A value becomes a local if it is used more than once, has a name, calls an elementary function, or would make a line
//! too long. All other values, and all negations, stand inside the expression that uses them. One call computes sine
//! and cosine of the same argument.

use std::collections::BTreeSet;

use proc_macro2::{Delimiter, Group, Ident, Literal, Span, TokenStream, TokenTree};
use quote::quote;

use super::names::{Names, claim, pi, rational};
use dalembert_codegen::program::{Function, Guard, Input, Op, Value};
use dalembert_expr::{Function as Elementary, Rational};

/// Number of operations from which an expression becomes a local.
const LONGEST_EXPRESSION: usize = 8;

/// Precedence of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Binding {
    Sum,
    Product,
    Unary,
    Atom,
}

/// An expression with its precedence and the number of its operations.
#[derive(Clone)]
struct Piece {
    tokens: TokenStream,
    binding: Binding,
    size: usize,
}

/// The statements of a function and the expressions of its results.
pub(super) struct Body {
    /// `let` statements and guards.
    pub statements: TokenStream,
    /// The results, in order.
    pub outputs: Vec<TokenStream>,
}

/// True if the function reads a wanted input.
pub(super) fn uses(function: &Function, wanted: impl Fn(Input) -> bool) -> bool {
    function
        .ops
        .iter()
        .any(|op| matches!(op, Op::Input(input) if wanted(*input)))
}

/// Emits a function. Inputs must be bound to the locals of `names` before the statements.
pub(super) fn emit_body(function: &Function, names: &Names) -> Body {
    let mut writer = Writer::new(function, names);
    for index in 0..function.ops.len() {
        writer.write(index);
    }
    let outputs = function
        .outputs
        .iter()
        .map(|&output| writer.pieces[output.index()].tokens.clone())
        .collect();
    Body {
        statements: writer.statements,
        outputs,
    }
}

struct Writer<'a> {
    function: &'a Function,
    names: &'a Names,
    taken: BTreeSet<String>,
    uses: Vec<usize>,
    pieces: Vec<Piece>,
    paired: Vec<Option<Ident>>,
    statements: TokenStream,
}

impl<'a> Writer<'a> {
    fn new(function: &'a Function, names: &'a Names) -> Self {
        let mut uses = vec![0; function.ops.len()];
        for op in &function.ops {
            // Weight 2 makes locals of the operands of a guard.
            let weight = if matches!(op, Op::Guard(_)) { 2 } else { 1 };
            op.operands()
                .iter()
                .for_each(|operand| uses[operand.index()] += weight);
        }
        function
            .outputs
            .iter()
            .for_each(|output| uses[output.index()] += 1);
        let paired = vec![None; function.ops.len()];
        let pieces = Vec::with_capacity(function.ops.len());
        Self {
            function,
            names,
            taken: names.taken(function),
            uses,
            pieces,
            paired,
            statements: TokenStream::new(),
        }
    }

    fn write(&mut self, index: usize) {
        let op = &self.function.ops[index];
        if let Op::Guard(guard) = op {
            self.write_guard(guard);
            self.pieces.push(atom(TokenStream::new()));
            return;
        }
        if self.was_paired(index) {
            return;
        }
        let piece = self.piece(op);
        let is_local = !op.is_leaf()
            && (self.uses[index] > 1
                || self.function.names[index].is_some()
                || piece.size >= LONGEST_EXPRESSION
                || matches!(op, Op::Call(..)));
        let piece = if is_local && !matches!(op, Op::Neg(_)) {
            self.bind(index, piece.tokens)
        } else {
            piece
        };
        self.pieces.push(piece);
    }

    /// True if the operation is the sine or cosine of an argument whose cosine or sine is computed too. One call binds
    /// both, at the first of the two.
    fn was_paired(&mut self, index: usize) -> bool {
        if let Some(local) = self.paired[index].take() {
            self.pieces.push(atom(quote!(#local)));
            return true;
        }
        let Op::Call(function @ (Elementary::Sin | Elementary::Cos), argument) =
            self.function.ops[index]
        else {
            return false;
        };
        let partner = if function == Elementary::Sin {
            Elementary::Cos
        } else {
            Elementary::Sin
        };
        let wanted = Op::Call(partner, argument);
        let Some(other) = self.function.ops.iter().position(|op| *op == wanted) else {
            return false;
        };
        let (first, second) = (self.local(index), self.local(other));
        let (sine, cosine) = if function == Elementary::Sin {
            (&first, &second)
        } else {
            (&second, &first)
        };
        let argument = &self.pieces[argument.index()].tokens;
        self.statements
            .extend(quote!(let (#sine, #cosine) = L::sin_cos(#argument);));
        self.pieces.push(atom(quote!(#first)));
        self.paired[other] = Some(second);
        true
    }

    /// A fresh local for a value, named after it.
    fn local(&mut self, index: usize) -> Ident {
        let wished = self.function.names[index]
            .clone()
            .unwrap_or_else(|| format!("v{index}"));
        Ident::new(&claim(&mut self.taken, &wished), Span::mixed_site())
    }

    fn bind(&mut self, index: usize, tokens: TokenStream) -> Piece {
        let local = self.local(index);
        let statement = joined([quote!(let #local =), tokens, quote!(;)]);
        self.statements.extend(statement);
        atom(quote!(#local))
    }

    fn write_guard(&mut self, guard: &Guard) {
        let at = |value: &Value| self.pieces[value.index()].tokens.clone();
        let guards = quote!(::dalembert::__private::lanes);
        let zero = || quote!(L::ZERO);
        let statement = match guard {
            Guard::Pivot { pivot, value } => {
                let value = at(value);
                quote!(#guards::positive_pivot(#pivot, #value)?;)
            }
            Guard::Constraint {
                constraint,
                squared,
                reference,
            } => {
                let squared = at(squared);
                let reference = match reference {
                    Some(reference) => at(reference),
                    None => zero(),
                };
                quote!(#guards::independent_constraint(#constraint, #squared, #reference)?;)
            }
            Guard::Mass {
                constraint,
                pivot,
                diagonal,
            } => {
                let (pivot, diagonal) = (at(pivot), at(diagonal));
                quote!(#guards::regular_mass(#constraint, #pivot, #diagonal)?;)
            }
            Guard::Frame {
                quasi,
                squared,
                reference,
            } => {
                let squared = at(squared);
                let reference = match reference {
                    Some(reference) => at(reference),
                    None => zero(),
                };
                quote!(#guards::independent_form(#quasi, #squared, #reference)?;)
            }
            Guard::Surface {
                surface,
                squared,
                reference,
            } => {
                let squared = at(squared);
                match reference {
                    None => quote!(#guards::regular_surface(#surface, #squared)?;),
                    Some(reference) => {
                        let reference = at(reference);
                        quote!(#guards::independent_at(#surface, #squared, #reference)?;)
                    }
                }
            }
        };
        self.statements.extend(statement);
    }

    /// The tokens of a value. Tokens with a single reader are moved: clones would dominate the run time for long
    /// functions.
    fn tokens_of(&mut self, value: Value) -> TokenStream {
        let tokens = &mut self.pieces[value.index()].tokens;
        match self.uses[value.index()] {
            1 => std::mem::take(tokens),
            _ => tokens.clone(),
        }
    }

    fn operand(&mut self, value: Value, least: Binding) -> (TokenStream, usize) {
        let piece = &self.pieces[value.index()];
        let (binding, size) = (piece.binding, piece.size);
        let tokens = self.tokens_of(value);
        let tokens = if binding < least {
            TokenTree::from(Group::new(Delimiter::Parenthesis, tokens)).into()
        } else {
            tokens
        };
        (tokens, size)
    }

    fn binary(&mut self, a: Value, b: Value, operator: TokenStream, binding: Binding) -> Piece {
        let tighter = if binding == Binding::Sum {
            Binding::Product
        } else {
            Binding::Unary
        };
        let ((left, m), (right, n)) = (self.operand(a, binding), self.operand(b, tighter));
        Piece {
            tokens: joined([left, operator, right]),
            binding,
            size: m + n + 1,
        }
    }

    fn call(&mut self, name: &str, arguments: &[Value]) -> Piece {
        let name = Ident::new(name, Span::call_site());
        let arguments = arguments.iter().map(|&value| self.tokens_of(value));
        atom(quote!(L::#name(#(#arguments),*)))
    }

    fn piece(&mut self, op: &Op) -> Piece {
        match op {
            Op::Input(input) => atom(self.input(*input)),
            Op::Number(number) => atom(rational(number)),
            Op::Pi => atom(pi()),
            Op::Neg(a) => {
                let binding = self.pieces[a.index()].binding;
                let (tokens, size) = self.operand(*a, Binding::Product);
                Piece {
                    tokens: joined([quote!(-), tokens]),
                    // A negated product is written without parentheses, so the result binds like a product.
                    binding: match binding {
                        Binding::Product => Binding::Product,
                        _ => Binding::Unary,
                    },
                    size: size + 1,
                }
            }
            Op::Add(a, b) => self.binary(*a, *b, quote!(+), Binding::Sum),
            Op::Sub(a, b) => self.binary(*a, *b, quote!(-), Binding::Sum),
            // The square of an interval has no negative numbers; the product with itself may have some.
            Op::Mul(a, b) if a == b => self.call("square", &[*a]),
            Op::Mul(a, b) => self.binary(*a, *b, quote!(*), Binding::Product),
            Op::Div(a, b) => self.binary(*a, *b, quote!(/), Binding::Product),
            Op::Sqrt(a) => self.call("sqrt", &[*a]),
            Op::Power(a, exponent) => self.power(*a, exponent),
            Op::Call(function, a) => self.call(function.name(), &[*a]),
            Op::Atan2(y, x) => self.call("atan2", &[*y, *x]),
            Op::Guard(_) => atom(TokenStream::new()),
        }
    }

    fn power(&mut self, base: Value, exponent: &Rational) -> Piece {
        let base = self.tokens_of(base);
        if exponent.to_parts()[1] != 0.0 {
            let exponent = rational(exponent);
            return atom(quote!(L::power(#base, #exponent)));
        }
        let exponent = literal(exponent.to_f64()).tokens;
        atom(quote!(L::powf(#base, #exponent)))
    }

    fn input(&self, input: Input) -> TokenStream {
        let local = |ident: &Ident| quote!(#ident);
        match input {
            Input::Time => quote!(t),
            Input::Coordinate(i) => local(&self.names.coordinates[i]),
            Input::Velocity(i) => local(&self.names.velocities[i]),
            Input::Momentum(i) => local(&self.names.momenta[i]),
            Input::Quasi(i) => local(&self.names.quasi[i]),
            Input::Parameter(k) => {
                let index = Literal::usize_unsuffixed(k);
                quote!(parameters[#index])
            }
            Input::MotionRate(i) => {
                let index = Literal::usize_unsuffixed(i);
                quote!(motion[#index])
            }
            Input::Excess(k) => {
                let index = Literal::usize_unsuffixed(k);
                quote!(excess[#index])
            }
            Input::Multiplier(a) => {
                let index = Literal::usize_unsuffixed(a);
                quote!(reactions[#index])
            }
        }
    }
}

/// The tokens one after the other, moved.
pub(super) fn joined<const N: usize>(parts: [TokenStream; N]) -> TokenStream {
    let mut parts = parts.into_iter();
    let mut tokens = parts.next().unwrap_or_default();
    parts.for_each(|part| tokens.extend(part));
    tokens
}

fn atom(tokens: TokenStream) -> Piece {
    Piece {
        tokens,
        binding: Binding::Atom,
        size: 0,
    }
}

/// A double as a literal. The check of the model refuses values too large for `f64`; a number that rounds to infinity
/// is written as infinity.
fn literal(number: f64) -> Piece {
    if !number.is_finite() {
        return atom(quote!(::core::f64::INFINITY));
    }
    let size = Literal::f64_unsuffixed(number.abs());
    match number.is_sign_negative() && number != 0.0 {
        true => Piece {
            tokens: quote!(-#size),
            binding: Binding::Unary,
            size: 0,
        },
        false => atom(quote!(#size)),
    }
}

/// A double as an expression, NaN and infinities included.
pub(super) fn number(value: f64) -> TokenStream {
    if value.is_nan() {
        return quote!(::core::f64::NAN);
    }
    if value.is_infinite() {
        return if value > 0.0 {
            quote!(::core::f64::INFINITY)
        } else {
            quote!(::core::f64::NEG_INFINITY)
        };
    }
    literal(value).tokens
}

#[cfg(test)]
mod tests {
    use dalembert_codegen::program::Input;
    use dalembert_codegen::program::builder::Builder;

    use super::*;

    /// The expression of the only result of a function of x, y and z.
    fn emitted(build: impl FnOnce(&mut Builder, [Value; 3]) -> Value) -> String {
        let ident = |name: &str| Ident::new(name, Span::call_site());
        let names = Names {
            type_name: quote!(Sample),
            model_type: quote!(Sample),
            global: None,
            held: None,
            coordinates: ["x", "y", "z"].map(ident).to_vec(),
            momenta: Vec::new(),
            velocities: Vec::new(),
            quasi: Vec::new(),
            parameters: Vec::new(),
        };
        let mut builder = Builder::new();
        let inputs = [0, 1, 2].map(|k| builder.input(Input::Coordinate(k)));
        let output = build(&mut builder, inputs);
        let body = emit_body(&builder.finish(vec![output]), &names);
        assert!(body.statements.is_empty(), "{}", body.statements);
        body.outputs[0].to_string().replace(' ', "")
    }

    #[test]
    fn negated_products_keep_their_place() {
        let quotient = emitted(|builder, [x, y, z]| {
            let product = builder.mul(y, z);
            let negative = builder.neg(product);
            builder.div(x, negative)
        });
        assert_eq!(quotient, "x/(-y*z)");
        let quotient = emitted(|builder, [x, y, z]| {
            let product = builder.mul(y, z);
            let negative = builder.neg(product);
            builder.div(negative, x)
        });
        assert_eq!(quotient, "-(y*z/x)".replace(['(', ')'], ""));
        let difference = emitted(|builder, [x, y, z]| {
            let sum = builder.add(y, z);
            let negative = builder.neg(sum);
            builder.div(x, negative)
        });
        assert_eq!(difference, "x/-(y+z)");
    }
}
