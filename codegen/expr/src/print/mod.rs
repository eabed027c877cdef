//! Expressions as people write them, in plain text and in LaTeX.
//!
//! Both forms are made from one layout (`layout.rs`) that collects quotients and pulls common factors out of sums.
//! Text follows the ordinary grammar, in which `^` associates to the right and binds more tightly than a leading
//! minus; it can be read back to an equal expression.

mod latex;
mod layout;
mod text;

use crate::node::ExprId;
use crate::pool::Pool;

impl Pool {
    /// The expression as text: `m*(dot(x)^2 + dot(y)^2)/2`.
    ///
    /// Parts that are nested deeper than 120 levels or make the text longer than about 20 000 operands are written
    /// `...`.
    pub fn text(&self, id: ExprId) -> String {
        text::render(self, &layout::layout(self, id))
    }

    /// The expression in LaTeX, with the LaTeX forms of the symbols.
    ///
    /// The limits of [`Pool::text`] apply.
    pub fn latex(&self, id: ExprId) -> String {
        latex::render(self, &layout::layout(self, id))
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn text_reads_like_a_formula() {
        for (text, expected) in [
            ("1*x", "x"),
            ("x + -y", "x - y"),
            ("-x - y", "-x - y"),
            ("1 - cos(theta)", "1 - cos(theta)"),
            ("x - 1", "x - 1"),
            ("m*g*l*(1 - cos(theta))", "m*g*l*(1 - cos(theta))"),
            ("m*(dot(x)^2 + dot(y)^2)/2", "m*(dot(x)^2 + dot(y)^2)/2"),
            (
                "1/2*m*dot(x)^2 + 1/2*m*dot(y)^2",
                "m*(dot(x)^2 + dot(y)^2)/2",
            ),
            ("l^2*m*cos(a) + l^2*m*sin(a)", "l^2*m*(cos(a) + sin(a))"),
            ("sqrt(x)", "sqrt(x)"),
            ("x^(3/2)", "x^(3/2)"),
            ("1/sqrt(x)", "1/sqrt(x)"),
            ("x^-2", "1/x^2"),
            ("a*b/(x*y^2)", "a*b/(x*y^2)"),
            ("2*x/3", "2*x/3"),
            ("-x/2", "-x/2"),
            ("-2*(x + y)", "-2*(x + y)"),
            ("(x + y)^2*z", "z*(x + y)^2"),
            ("(-x)^(1/2)", "sqrt(-x)"),
            ("-x^2", "-x^2"),
            ("sqrt(2)/2", "sqrt(2)/2"),
            ("x/2 + y/3", "(3*x + 2*y)/6"),
            ("pi*x", "pi*x"),
            ("-3/4", "-3/4"),
            ("0.1*x", "x/10"),
            ("atan2(-y, x)", "atan2(-y, x)"),
            ("x/x", "x/x"),
            ("(x/y)^(1/2)", "sqrt(x/y)"),
            ("(x^2*y)^(1/3)", "(x^2*y)^(1/3)"),
            ("-(x - y)/(a - b)", "(y - x)/(a - b)"),
            ("m*(m*x + m*y)", "m^2*(x + y)"),
            ("m*(l*a + l*b) + k*(l*a + l*b)", "l*(m + k)*(a + b)"),
            ("m*(x + y) + m*z", "m*(x + y + z)"),
            ("k*x^2/2 - k*l*x", "k*x*(x - 2*l)/2"),
        ] {
            assert_eq!(Fixture::new().echo(text), expected);
        }
    }

    #[test]
    fn text_reads_back_to_the_same_value() {
        let mut fixture = Fixture::new();
        for text in [
            "m*(dot(x)^2 + dot(y)^2)/2 - k*(x^2 - 2*l*x)/2",
            "-(x*y - y^2)^3/(2*(a - b))",
            "exp(-x^2/m)/sqrt(2*pi*m)*(1 - x^-2)",
            "((x + y)^2 + 1)^2*x/(x^3*(y - x)^2)",
            "(2*x)^(1/3) - (-y)^(3/2)",
            "-(-(x - 1)/3)^2",
            "l^2*(x*cos(a) - y*cos(a))^2/(l*x - l*y)",
        ] {
            let id = fixture.read(text);
            let printed = fixture.pool.text(id);
            let back = fixture.read(&printed);
            let value = |id| fixture.pool.eval(&[id], &|s| -0.3 - 0.1 * s.index() as f64)[0];
            let (first, second) = (value(id), value(back));
            let equal = (first - second).abs() <= 1e-13 * first.abs()
                || (first.is_nan() && second.is_nan());
            assert!(equal, "{text} was printed {printed}");
        }
    }

    #[test]
    fn latex_uses_fractions_and_the_symbols_own_forms() {
        let mut fixture = Fixture::new();
        for (text, expected) in [
            (
                "m*(dot(x)^2 + dot(y)^2)/2",
                r"\frac{m (\dot{x}^{2} + \dot{y}^{2})}{2}",
            ),
            ("m*l^2*cos(theta)^2", r"m l^{2} \cos^{2}(\theta)"),
            ("sin(x/2)", r"\sin\left(\frac{x}{2}\right)"),
            ("1/sqrt(x)", r"\frac{1}{\sqrt{x}}"),
            ("exp(-k*t)", r"e^{-k t}"),
            ("-x - y", "-x - y"),
            ("abs(x)^3", r"\left|x\right|^{3}"),
            ("(x + y)^2", "(x + y)^{2}"),
        ] {
            let id = fixture.read(text);
            assert_eq!(fixture.pool.latex(id), expected);
        }
    }

    #[test]
    fn the_same_input_prints_the_same_text() {
        let text = "sin(x*y)*(a + b)^2/m - k*theta^2/2 + ln(m)*sqrt(x + y)";
        assert_eq!(Fixture::new().echo(text), Fixture::new().echo(text));
    }

    #[test]
    fn widely_shared_expressions_are_cut() {
        let mut fixture = Fixture::new();
        let mut id = fixture.read("x + y");
        let z = fixture.read("z");
        for _ in 0..60 {
            let sine = fixture.pool.call(crate::Function::Sin, id);
            let product = fixture.pool.mul(sine, z);
            let cosine = fixture.pool.call(crate::Function::Cos, id);
            id = fixture.pool.add(product, cosine);
        }
        let text = fixture.pool.text(id);
        assert!(text.len() < 1_000_000 && text.contains("..."));
    }
}
