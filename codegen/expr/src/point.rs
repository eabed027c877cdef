//! An evaluation point modulo a prime: residues of symbols and atoms, angles and their multiples.

use std::collections::HashMap;

use crate::field::{Modulus, draw};
use crate::function::Function;
use crate::intern::WordHash;
use crate::node::{Assumption, SymbolId};
use crate::rational::Rational;

/// Reason why an expression has no value at a point. It may have one at another point.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum ModularFailure {
    /// A denominator is 0 at the point.
    DivisionByZero,
    /// The argument of a root or of a logarithm is not a square at the point.
    NotASquare,
    /// Roots of this degree are not unique modulo this prime.
    NoRoot,
    /// The coefficients inside sin, cos or exp have a denominator that does not divide the point's, see
    /// [`ModularPoint::with_denominator`].
    Denominator,
}

/// Residues for symbols and atoms. They follow from a modulus, a seed, and explicitly set values.
#[derive(Clone, Debug)]
pub struct ModularPoint {
    modulus: Modulus,
    seed: u64,
    denominator: i64,
    values: Vec<Option<u64>>,
    atoms: HashMap<(Atom, u64, u64), (u64, u64), WordHash>,
}

/// Kinds of atoms. Their arguments are residues.
#[derive(Copy, Clone, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Atom {
    Symbol,
    Pi,
    Circle,
    Exponential,
    Atan2,
    Call(Function),
}

impl Atom {
    fn word(self) -> u64 {
        match self {
            Self::Symbol => 1,
            Self::Pi => 2,
            Self::Circle => 3,
            Self::Exponential => 4,
            Self::Atan2 => 5,
            Self::Call(function) => 16 + function as u64,
        }
    }
}

impl ModularPoint {
    /// The point for a seed. Different seeds give independent points. Denominators of coefficients inside sin, cos and
    /// exp must divide 12.
    pub fn new(modulus: Modulus, seed: u64) -> Self {
        Self::with_denominator(modulus, seed, 12)
    }

    /// Same as [`ModularPoint::new`], for coefficients whose denominators divide `denominator`.
    pub fn with_denominator(modulus: Modulus, seed: u64, denominator: i64) -> Self {
        Self {
            modulus,
            seed,
            denominator,
            values: Vec::new(),
            atoms: HashMap::default(),
        }
    }

    /// The modulus.
    pub fn modulus(&self) -> Modulus {
        self.modulus
    }

    /// Sets the value of a symbol instead of the drawn one.
    pub fn set(&mut self, symbol: SymbolId, residue: u64) {
        if self.values.len() <= symbol.index() {
            self.values.resize(symbol.index() + 1, None);
        }
        self.values[symbol.index()] = Some(residue);
    }

    /// True if the value of a symbol was set.
    pub(crate) fn is_set(&self, symbol: SymbolId) -> bool {
        matches!(self.values.get(symbol.index()), Some(Some(_)))
    }

    /// The value of a symbol; a square if the symbol is assumed to be positive or nonnegative.
    pub fn value(&self, symbol: SymbolId, assumption: Assumption) -> u64 {
        if let Some(Some(value)) = self.values.get(symbol.index()) {
            return *value;
        }
        let value = self.draw(Atom::Symbol, symbol.index() as u64, 0);
        match assumption {
            Assumption::None | Assumption::NonZero => value,
            Assumption::Positive | Assumption::NonNegative => self.modulus.mul(value, value),
        }
    }

    /// Replaces the value `x` of a symbol by `twelfths pi/12 + x`, or by `twelfths pi/12 - x` if `is_reflected`. The
    /// sine and cosine of the new value follow from those of `x`. If the new value is `-x`, its exponential is the
    /// reciprocal.
    ///
    /// # Errors
    /// If the point's denominator does not divide `twelfths`: the shift of the base angle is then no multiple of
    /// `pi/12`.
    pub fn move_symbol(
        &mut self,
        symbol: SymbolId,
        assumption: Assumption,
        twelfths: i64,
        is_reflected: bool,
    ) -> Result<(), ModularFailure> {
        let field = self.modulus;
        let x = self.value(symbol, assumption);
        let (sine, cosine) = self.circle(x)?;
        let (up, down) = self.exponential(x)?;
        if twelfths % self.denominator != 0 {
            return Err(ModularFailure::Denominator);
        }
        let turn = twelfths_of_pi(field, twelfths / self.denominator)?;
        let sign = |value| match is_reflected {
            true => field.neg(value),
            false => value,
        };
        let twelfth = field.inv(12).ok_or(ModularFailure::DivisionByZero)?;
        let angle = field.mul(field.integer(twelfths), twelfth);
        let pi = field.mul(self.draw(Atom::Pi, 0, 0), angle);
        let image = field.add(pi, sign(x));
        let angle = add_angles(field, turn, (sign(sine), cosine));
        self.atoms.insert((Atom::Circle, image, 0), angle);
        if twelfths == 0 && is_reflected {
            self.atoms.insert((Atom::Exponential, image, 0), (down, up));
        }
        self.set(symbol, image);
        Ok(())
    }

    pub(crate) fn draw(&self, atom: Atom, first: u64, second: u64) -> u64 {
        draw(
            self.modulus,
            &[self.seed, self.modulus.prime(), atom.word(), first, second],
        )
    }

    /// `(sin, cos)` of the base angle `x / N`.
    pub(crate) fn circle(&mut self, x: u64) -> Result<(u64, u64), ModularFailure> {
        let key = (Atom::Circle, x, 0);
        if let Some(pair) = self.atoms.get(&key) {
            return Ok(*pair);
        }
        let field = self.modulus;
        let half_tangent = self.draw(Atom::Circle, x, 0);
        let square = field.mul(half_tangent, half_tangent);
        let inverse = field
            .inv(field.add(1, square))
            .ok_or(ModularFailure::DivisionByZero)?;
        let sine = field.mul(field.add(half_tangent, half_tangent), inverse);
        let cosine = field.mul(field.sub(1, square), inverse);
        self.atoms.insert(key, (sine, cosine));
        Ok((sine, cosine))
    }

    /// `(exp, exp^-1)` of the base exponent `x / N`; both are squares, since exponentials are positive.
    pub(crate) fn exponential(&mut self, x: u64) -> Result<(u64, u64), ModularFailure> {
        let key = (Atom::Exponential, x, 0);
        if let Some(pair) = self.atoms.get(&key) {
            return Ok(*pair);
        }
        let root = self.draw(Atom::Exponential, x, 0);
        let value = self.modulus.mul(root, root);
        let inverse = self
            .modulus
            .inv(value)
            .ok_or(ModularFailure::DivisionByZero)?;
        self.atoms.insert(key, (value, inverse));
        Ok((value, inverse))
    }

    /// An atom of an odd function. The residue is drawn for `x` or `-x`, whichever is a square.
    pub(crate) fn odd_atom(&self, function: Function, x: u64) -> u64 {
        let field = self.modulus;
        match x {
            0 => 0,
            _ if field.is_square(x) => self.draw(Atom::Call(function), x, 0),
            _ => field.neg(self.draw(Atom::Call(function), field.neg(x), 0)),
        }
    }

    /// `coefficient * N` as an integer.
    pub(crate) fn multiple(&self, coefficient: &Rational) -> Result<i64, ModularFailure> {
        let multiple = coefficient * &Rational::from(self.denominator);
        multiple.to_i64().ok_or(ModularFailure::Denominator)
    }

    pub(crate) fn power(&self, base: u64, exponent: &Rational) -> Result<u64, ModularFailure> {
        let field = self.modulus;
        let (numer, degree) = exponent.to_small().ok_or(ModularFailure::NoRoot)?;
        let (base, steps) = match (base, numer) {
            (0, ..0) => return Err(ModularFailure::DivisionByZero),
            (0, _) => return Ok(0),
            (_, 0..) => (base, numer.unsigned_abs()),
            _ => (
                field.inv(base).ok_or(ModularFailure::DivisionByZero)?,
                numer.unsigned_abs(),
            ),
        };
        if degree == 1 {
            return Ok(field.pow(base, steps));
        }
        if !field.is_square(base) {
            return Err(ModularFailure::NotASquare);
        }
        let root = field
            .root_exponent(degree.unsigned_abs())
            .ok_or(ModularFailure::NoRoot)?;
        Ok(field.pow(field.pow(base, root), steps))
    }
}

pub(crate) fn add_angles(field: Modulus, (s, c): (u64, u64), (t, d): (u64, u64)) -> (u64, u64) {
    let sine = field.add(field.mul(s, d), field.mul(c, t));
    let cosine = field.sub(field.mul(c, d), field.mul(s, t));
    (sine, cosine)
}

pub(crate) fn multiple_angle(field: Modulus, (sine, cosine): (u64, u64), steps: i64) -> (u64, u64) {
    let mut square = (if steps < 0 { field.neg(sine) } else { sine }, cosine);
    let mut rest = steps.unsigned_abs();
    let mut angle = (0, 1);
    while rest > 0 {
        if rest & 1 == 1 {
            angle = add_angles(field, angle, square);
        }
        rest >>= 1;
        if rest > 0 {
            square = add_angles(field, square, square);
        }
    }
    angle
}

/// `(sin, cos)` of `units * pi/12`, with the same roots of 2 and 3 as the values of `sqrt(2)` and `sqrt(3)`.
pub(crate) fn twelfths_of_pi(field: Modulus, units: i64) -> Result<(u64, u64), ModularFailure> {
    let root = |square| field.sqrt(square).ok_or(ModularFailure::NotASquare);
    let half = field.inv(2).ok_or(ModularFailure::DivisionByZero)?;
    let units = units.rem_euclid(24);
    let mut angle = (0, 1);
    if units % 3 != 0 {
        // cos(pi/3) = 1/2. Subtracting `units % 3` times pi/3, which is four units, leaves a multiple of three units.
        let sine = field.mul(root(3)?, half);
        angle = multiple_angle(field, (sine, half), units % 3);
    }
    let mut rest = units - 4 * (units % 3);
    if rest % 6 != 0 {
        let diagonal = field.mul(root(2)?, half);
        angle = add_angles(field, angle, (diagonal, diagonal));
        rest -= 3;
    }
    Ok(add_angles(
        field,
        angle,
        multiple_angle(field, (1, 0), rest / 6),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_fifteen_degrees_close_the_circle() {
        let field = Modulus::drawn(0)[0];
        let step = twelfths_of_pi(field, 1).unwrap();
        let mut angle = (0, 1);
        for units in 0..24 {
            assert_eq!(twelfths_of_pi(field, units).unwrap(), angle);
            angle = add_angles(field, angle, step);
        }
        assert_eq!(angle, (0, 1));
    }
}
