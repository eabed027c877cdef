//! Functions of coordinates, with a differentiation that is independent of the generator.

use crate::draw::Draw;

/// A function, whose text goes into declarations.
#[derive(Debug, Clone)]
pub enum Function {
    /// A number as written.
    Number(String),
    /// A coordinate.
    Coordinate(usize),
    Sum(Vec<Function>),
    Product(Vec<Function>),
    /// A positive whole power.
    Power(Box<Function>, u32),
    /// `1/u`
    Inverse(Box<Function>),
    Sin(Box<Function>),
    Cos(Box<Function>),
    Exp(Box<Function>),
    Root(Box<Function>),
    /// `(abs(u) + u)/2`
    Ramp(Box<Function>),
    /// The derivative of a ramp: `(u/abs(u) + 1)/2`
    Step(Box<Function>),
}

use Function::{Coordinate, Cos, Exp, Inverse, Number, Power, Product, Ramp, Root, Sin, Step, Sum};

/// A number as a function.
pub fn number(text: impl Into<String>) -> Function {
    Number(text.into())
}

impl Function {
    /// The text of the function with these names of coordinates.
    pub fn text(&self, names: &[&str]) -> String {
        let text = |function: &Self| function.text(names);
        match self {
            Number(text) => format!("({text})"),
            Coordinate(i) => names[*i].to_owned(),
            Sum(terms) => format!(
                "({})",
                terms.iter().map(text).collect::<Vec<_>>().join(" + ")
            ),
            Product(factors) => factors.iter().map(text).collect::<Vec<_>>().join("*"),
            Power(base, exponent) => format!("({})^{exponent}", text(base)),
            Inverse(base) => format!("1/({})", text(base)),
            Sin(base) => format!("sin({})", text(base)),
            Cos(base) => format!("cos({})", text(base)),
            Exp(base) => format!("exp({})", text(base)),
            Root(base) => format!("sqrt({})", text(base)),
            Ramp(base) => format!("((abs({0}) + {0})/2)", text(base)),
            Step(base) => format!("(({0}/abs({0}) + 1)/2)", text(base)),
        }
    }

    /// The derivative with respect to a coordinate; `None` if it is 0.
    pub fn slope(&self, i: usize) -> Option<Self> {
        let chain = |outer: Self, inner: &Self| Some(Product(vec![outer, inner.slope(i)?]));
        match self {
            Number(_) | Step(_) => None,
            Coordinate(coordinate) => (*coordinate == i).then(|| number("1")),
            Sum(terms) => {
                let slopes: Vec<Self> = terms.iter().filter_map(|term| term.slope(i)).collect();
                (!slopes.is_empty()).then_some(Sum(slopes))
            }
            Product(factors) => {
                let mut terms = Vec::new();
                for (position, factor) in factors.iter().enumerate() {
                    if let Some(slope) = factor.slope(i) {
                        let mut product = factors.clone();
                        product[position] = slope;
                        terms.push(Product(product));
                    }
                }
                (!terms.is_empty()).then_some(Sum(terms))
            }
            Power(base, exponent) => {
                let outer = match exponent {
                    1 => number("1"),
                    _ => Product(vec![
                        number(exponent.to_string()),
                        Power(base.clone(), exponent - 1),
                    ]),
                };
                chain(outer, base)
            }
            Inverse(base) => chain(
                Product(vec![
                    number("-1"),
                    Inverse(Box::new(Power(base.clone(), 2))),
                ]),
                base,
            ),
            Sin(base) => chain(Cos(base.clone()), base),
            Cos(base) => chain(Product(vec![number("-1"), Sin(base.clone())]), base),
            Exp(base) => chain(self.clone(), base),
            Root(base) => chain(
                Product(vec![number("1/2"), Inverse(Box::new(self.clone()))]),
                base,
            ),
            Ramp(base) => chain(Step(base.clone()), base),
        }
    }
}

/// A coordinate minus a number, such as `x - 17` or `x - 1/3`.
pub fn shifted(draw: &mut Draw, i: usize) -> Function {
    let place = draw.choice(&["0", "1/3", "2", "-5", "17", "40.5", "-1000"]);
    Sum(vec![Coordinate(i), number(format!("-({place})"))])
}

/// A single-valued function of some coordinates; `is_angle` is true for those that are angles.
pub fn function(draw: &mut Draw, is_angle: &[bool], which: &[usize], depth: usize) -> Function {
    let i = which[draw.below(which.len())];
    if depth == 0 {
        return leaf(draw, is_angle, i);
    }
    let part = |draw: &mut Draw| function(draw, is_angle, which, depth - 1);
    match draw.below(6) {
        0 => Sum(vec![part(draw), part(draw)]),
        1 | 2 => Product(vec![part(draw), part(draw)]),
        3 => Exp(Box::new(Product(vec![
            number("-1/4"),
            Power(Box::new(part(draw)), 2),
        ]))),
        4 => Root(Box::new(Sum(vec![
            number("1"),
            Power(Box::new(part(draw)), 2),
        ]))),
        _ => Inverse(Box::new(Sum(vec![
            number("2"),
            Power(Box::new(part(draw)), 2),
        ]))),
    }
}

fn leaf(draw: &mut Draw, is_angle: &[bool], i: usize) -> Function {
    if is_angle[i] {
        let multiple = Product(vec![number(draw.choice(&["1", "2", "3"])), Coordinate(i)]);
        return match draw.below(2) {
            0 => Sin(Box::new(multiple)),
            _ => Cos(Box::new(multiple)),
        };
    }
    match draw.below(4) {
        0 => Coordinate(i),
        1 => Power(Box::new(shifted(draw, i)), 2),
        2 => Sin(Box::new(Coordinate(i))),
        _ => Product(vec![
            number(draw.choice(&["3", "-1/2", "0.01"])),
            shifted(draw, i),
        ]),
    }
}

/// A product of ramps that is positive inside a box and 0 outside.
pub fn bump(draw: &mut Draw, which: &[usize]) -> Function {
    let mut factors = Vec::new();
    for i in which {
        let low = draw.choice(&["5", "-12", "1/2", "100"]);
        let width = draw.choice(&["1", "1/4", "3"]);
        let up = Sum(vec![Coordinate(*i), number(format!("-({low})"))]);
        let down = Sum(vec![
            number(format!("{low} + {width}")),
            Product(vec![number("-1"), Coordinate(*i)]),
        ]);
        factors.push(Ramp(Box::new(up)));
        factors.push(Ramp(Box::new(down)));
    }
    Product(factors)
}
