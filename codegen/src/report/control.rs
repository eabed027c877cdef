//! `derive --control`: the maximum principle of a model with a cost.

use super::equations::escape;
use super::{Item, Report, ReportError, Section, Tree};
use crate::derive_control;
use crate::mechanics::control::{Extremals, Jump};
use crate::mechanics::inverse::tidy;
use crate::model::Model;
use crate::report::request::Asked;
use crate::spec::Declaration;
use crate::tables::text_of;
use dalembert_expr::ExprId;

/// The maximum principle of a model with a cost, or of one of its scenes. `source` is the declaration, `part` the name
/// of the scene; `None` stands for the model.
///
/// # Errors
/// [`ReportError`]: a declaration that is refused, or that has no maximum principle.
pub fn control(source: &str, part: Option<&str>) -> Result<Report, ReportError> {
    let spec = match super::declaration(source)?.without_claims() {
        Declaration::Model(spec) => spec,
        Declaration::Modes(_) => {
            let text = "a model with modes has no `cost`";
            let help = "declare the model of one mode by itself";
            return Err(Asked::refusal(text, help));
        }
    };
    let (model, extremals) = derive_control(&spec, part).map_err(ReportError::Declaration)?;
    let name = part.unwrap_or(&model.snake_name).to_owned();
    let mut printer = Printer {
        model,
        extremals: &extremals,
    };
    let mut sections = vec![printer.principle(), printer.field(), printer.impacts()];
    sections.push(printer.end());
    sections.retain(|section| !section.items.is_empty());
    Ok(Report {
        name,
        documentation: text_of(&printer.model.documentation),
        sections,
        findings: Vec::new(),
        certificate: Tree::Absent,
        scenes: Vec::new(),
        has_modes: false,
    })
}

struct Printer<'a> {
    model: Model,
    extremals: &'a Extremals,
}

impl Printer<'_> {
    /// The expression as text and LaTeX: simplified as emitted or multiplied out, whichever is shorter.
    fn print(&mut self, expression: ExprId) -> [String; 2] {
        let pool = &mut self.model.pool;
        pool.lift_budget();
        let emitted = pool.simplify(expression);
        let flat = tidy(pool, expression);
        let [emitted, flat] = [emitted, flat].map(|it| [pool.text(it), pool.latex(it)]);
        match flat[0].len() < emitted[0].len() {
            true => flat,
            false => emitted,
        }
    }

    fn formula(&mut self, [text, latex]: [String; 2], right: ExprId) -> Item {
        let right = self.print(right);
        Item::Formula {
            left: [text, latex],
            right,
        }
    }

    /// State and costate of each component, as text and LaTeX.
    fn letters(&mut self) -> Vec<[[String; 2]; 2]> {
        let symbols = self.extremals.components.iter();
        let symbols: Vec<_> = symbols.map(|it| [it.state, it.costate]).collect();
        let pool = &self.model.pool;
        let letter = |symbol| {
            let (text, latex) = (pool.symbol_name(symbol), pool.symbol_latex(symbol));
            [text.to_owned(), latex.to_owned()]
        };
        symbols.into_iter().map(|pair| pair.map(letter)).collect()
    }

    fn principle(&mut self) -> Section {
        let cost = self.model.cost;
        let left = |text: &str, latex: &str| [text.to_owned(), latex.to_owned()];
        let mut items = Vec::new();
        if let Some(cost) = cost {
            items.push(self.formula(left("l", r"\ell"), cost.running));
            items.push(self.formula(left("g", "g"), cost.terminal));
        }
        let inputs: Vec<_> = self.model.inputs().map(|(_, it)| it.symbol).collect();
        for (input, optimal) in inputs.into_iter().zip(self.extremals.optimal.clone()) {
            let text = self.model.pool.symbol_name(input);
            let latex = self.model.pool.symbol_latex(input);
            let names = [format!("{text}*"), format!("{{{latex}}}^*")];
            items.push(self.formula(names, optimal));
        }
        items.push(self.formula(left("H*", "H^*"), self.extremals.hamiltonian));
        Section {
            title: "Maximum principle",
            equation: [
                "J = integral of l dt + g(x(T)), H* = min_u [p.f(t, x, u) + l(t, x, u)]",
                r"J = \int_0^T \ell\,\mathrm{d}t + g(x(T)), \quad H^* = \min_u \left[p \cdot f(t, x, u) + \ell(t, x, u)\right]",
            ],
            items,
        }
    }

    fn field(&mut self) -> Section {
        let letters = self.letters();
        let mut items = Vec::new();
        let rates = self.extremals.components.clone();
        for (letters, component) in letters.iter().zip(&rates) {
            let [text, latex] = &letters[0];
            let names = [format!("dot({text})"), format!("\\dot{{{latex}}}")];
            items.push(self.formula(names, component.rate));
        }
        for (letters, component) in letters.iter().zip(&rates) {
            let [text, latex] = &letters[1];
            let names = [format!("dot({text})"), format!("\\dot{{{latex}}}")];
            items.push(self.formula(names, component.costate_rate));
        }
        Section {
            title: "Extremals",
            equation: [
                "dot(x) = dH*/dp, dot(p) = -dH*/dx",
                r"\dot x = \frac{\partial H^*}{\partial p}, \quad \dot p = -\frac{\partial H^*}{\partial x}",
            ],
            items,
        }
    }

    fn impacts(&mut self) -> Section {
        let letters = self.letters();
        let jumps = self.extremals.jumps.clone();
        let names: Vec<String> = (self.model.surfaces.iter())
            .map(|surface| surface.name.display.clone())
            .collect();
        let mut items = Vec::new();
        for (name, jump) in names.iter().zip(&jumps) {
            items.extend(self.jump(name, jump, &letters));
        }
        Section {
            title: "Impacts",
            equation: [
                "x+ = Delta(t, x), p+.Delta_* = p + eps dh, H*+ - p+.d_t Delta + eps d_t h = H*",
                r"x^+ = \Delta(t, x), \quad p^+ \cdot \Delta_* = p + \epsilon\, dh, \quad
                  {H^*}^+ - p^+ \cdot \partial_t \Delta + \epsilon\, \partial_t h = H^*",
            ],
            items,
        }
    }

    fn jump(&mut self, name: &str, jump: &Jump, letters: &[[[String; 2]; 2]]) -> Vec<Item> {
        let below = format!("_{{\\text{{{}}}}}", escape(name));
        let after = |[text, latex]: &[String; 2]| {
            [format!("{text}+[{name}]"), format!("{{{latex}}}^+{below}")]
        };
        let mut items = Vec::new();
        for ([state, _], value) in letters.iter().zip(&jump.state) {
            items.push(self.formula(after(state), *value));
        }
        for ([_, costate], value) in letters.iter().zip(&jump.costate) {
            items.push(self.formula(after(costate), *value));
        }
        let names = [format!("eps[{name}]"), format!("\\epsilon{below}")];
        items.push(self.formula(names, jump.epsilon));
        items
    }

    /// The costate at the end, for components whose final state is free.
    fn end(&mut self) -> Section {
        let letters = self.letters();
        let components = self.extremals.components.clone();
        let mut items = Vec::new();
        for ([_, [text, latex]], component) in letters.iter().zip(&components) {
            let slope = self
                .model
                .pool
                .diff(self.extremals.terminal, component.state);
            let names = [format!("{text}(T)"), format!("{latex}(T)")];
            items.push(self.formula(names, slope));
        }
        Section {
            title: "Free end",
            equation: ["p(T) = dg", r"p(T) = \mathrm{d}g"],
            items,
        }
    }
}
