//! `derive --group xi1, xi2, ..`: reduction of a model by a group of symmetries.

use std::mem;

use dalembert_expr::{Assumption, ExprId};
use proc_macro2::{TokenStream, TokenTree};

use super::equations::Writer;
use super::request::Asked;
use super::{Item, Report, ReportError, Section, tokens};
use crate::claims::{Dynamics, Verdict, check_symmetry, keeps_lagrangian};
use crate::mechanics::reduction::{NoReduction, Reduction, derive_reduction};
use crate::model::Statement;

/// The reduction of a model. `source` is the declaration. `part` is the name of a scene or mode, or `None` for the
/// model. `fields` are written as in claims and separated by commas: `partial(x), partial(phi) - y*partial(x) +
/// x*partial(y)`.
///
/// # Errors
/// [`ReportError`]: a field that is no symmetry, with the reason, or fields that span no group.
pub fn group(source: &str, part: Option<&str>, fields: &str) -> Result<Report, ReportError> {
    Asked::check_list(fields, "partial(x), partial(y)")?;
    let claims: Vec<String> = (separated(tokens(fields)?).iter())
        .map(|field| format!("symmetry: {field}"))
        .collect();
    let mut asked = Asked::of(source, part, &claims)?;
    let written: Vec<String> = (asked.texts.iter())
        .map(|text| text.trim_start_matches("symmetry: ").to_owned())
        .collect();
    let fields: Vec<Vec<ExprId>> = (asked.statements.iter())
        .filter_map(|statement| match statement {
            Statement::Symmetry(field) => Some(field.clone()),
            _ => None,
        })
        .collect();
    refuse_others(&mut asked, &fields, &written)?;
    let reduction = derive_reduction(&mut asked.model, &asked.derivation, &fields)
        .map_err(|reason| refusal(&reason, &written))?;
    let mut writer = Group {
        writer: Writer {
            model: &mut asked.model,
            derivation: &asked.derivation,
        },
        reduction: &reduction,
    };
    let sections = vec![
        writer.fields(&fields),
        writer.locked(),
        writer.momenta(),
        writer.connection(),
        writer.curvature(),
        writer.reduced(),
        writer.impacts(),
    ];
    Ok(asked.report(sections))
}

/// The parts of a list. Commas inside parentheses do not separate.
fn separated(tokens: TokenStream) -> Vec<String> {
    let mut parts = Vec::new();
    let mut open = Vec::new();
    for token in tokens {
        match &token {
            TokenTree::Punct(punct) if punct.as_char() == ',' => {
                parts.push(mem::take(&mut open));
            }
            _ => open.push(token),
        }
    }
    parts.push(open);
    let texts = parts.into_iter();
    texts
        .map(|part| TokenStream::from_iter(part).to_string())
        .collect()
}

/// Refuses fields that are no symmetries, or that change the Lagrangian by a total time derivative.
fn refuse_others(
    asked: &mut Asked,
    fields: &[Vec<ExprId>],
    written: &[String],
) -> Result<(), ReportError> {
    if asked.model.is_first_order() || asked.model.is_nonlinear() {
        return Ok(());
    }
    let dynamics = Dynamics::of(&mut asked.model, &asked.derivation);
    for (field, written) in fields.iter().zip(written) {
        let (verdict, _) = check_symmetry(&mut asked.model, &dynamics, field, 0);
        let reason = match verdict {
            Verdict::Proved(_) if keeps_lagrangian(&mut asked.model, field, 0) => continue,
            Verdict::Proved(_) => {
                "it changes the Lagrangian by a total time derivative, and the connection needs fields that preserve it"
                    .to_owned()
            }
            Verdict::Refuted(witness) => witness.to_string(),
            Verdict::Undecided(reason) => reason,
        };
        let text = format!("`{written}` is no symmetry to reduce by: {reason}");
        return Err(Asked::refusal(text, ""));
    }
    Ok(())
}

fn refusal(reason: &NoReduction, written: &[String]) -> ReportError {
    match reason {
        NoReduction::NoBracket(reason) => Asked::refusal(reason.text(), ""),
        NoReduction::Dependent => Asked::refusal(
            "the fields are dependent at all configurations",
            "leave out those that are combinations of others",
        ),
        NoReduction::NotClosed(a, b) => Asked::refusal(
            format!(
                "[{}, {}] is no combination of the fields with constant factors: they span no group",
                written[*a], written[*b]
            ),
            "add it to the list",
        ),
        NoReduction::Undecided(a, b) => Asked::refusal(
            format!(
                "[{}, {}] may or may not be a combination of the fields with constant factors: this is undecided",
                written[*a], written[*b]
            ),
            "write the fields without functions that have kinks and without terms that cancel",
        ),
        NoReduction::UndecidedRank => Asked::refusal(
            "the fields, or the constraints on them, are not known to be independent, nor to depend on each other",
            "write them without functions that have kinks and without terms that cancel",
        ),
        NoReduction::TooLarge => Asked::refusal(
            "the inertia of the group couples more than four fields: it is not written out",
            "leave some of them out",
        ),
    }
}

/// Prints a reduction.
struct Group<'g> {
    writer: Writer<'g>,
    reduction: &'g Reduction,
}

impl Group<'_> {
    /// `sum of v_k of(k)` over components `v_k`, with symbols `before(name)` for the coordinates.
    fn combination(&mut self, components: &[ExprId], before: &str, latex: &str) -> ExprId {
        let names: Vec<(String, String)> = (0..components.len())
            .map(|k| {
                let [name, symbol] = self.writer.coordinate(k);
                (format!("{before}({name})"), latex.replace('#', &symbol))
            })
            .collect();
        let pool = &mut self.writer.model.pool;
        let mut terms = Vec::new();
        for (component, (name, latex)) in components.iter().zip(&names) {
            if !pool.is_syntactic_zero(*component) {
                let symbol = pool.symbol(name, latex, Assumption::None);
                let symbol = pool.variable(symbol);
                terms.push(pool.mul(*component, symbol));
            }
        }
        pool.sum(&terms)
    }

    fn field(&mut self, name: &str, latex: &str, components: &[ExprId]) -> Item {
        let value = self.combination(components, "partial", "\\partial_{#}");
        self.as_written(name, latex, value)
    }

    /// A formula printed without simplification.
    fn as_written(&mut self, text: &str, latex: &str, value: ExprId) -> Item {
        let pool = &self.writer.model.pool;
        Item::Formula {
            left: [text.to_owned(), latex.to_owned()],
            right: [pool.text(value), pool.latex(value)],
        }
    }

    fn matrix(&mut self, left: [&str; 2], rows: &[Vec<ExprId>]) -> Item {
        let rows = rows.iter().map(|row| {
            let entries = row.iter().map(|entry| self.writer.print(*entry));
            entries.collect()
        });
        Item::Matrix {
            rows: rows.collect(),
            left: left.map(str::to_owned),
        }
    }

    fn fields(&mut self, fields: &[Vec<ExprId>]) -> Section {
        let mut items = Vec::new();
        for (a, field) in fields.iter().enumerate() {
            let (name, latex) = (format!("xi_{}", a + 1), format!("\\xi_{{{}}}", a + 1));
            items.push(self.field(&name, &latex, field));
        }
        let count = fields.len();
        let mut is_abelian = true;
        for a in 0..count {
            for b in a + 1..count {
                let factors = &self.reduction.structure[a][b];
                if factors.iter().all(|factor| self.writer.is_zero(*factor)) {
                    continue;
                }
                is_abelian = false;
                let pool = &mut self.writer.model.pool;
                let mut terms = Vec::new();
                for (c, factor) in factors.iter().enumerate() {
                    let (name, latex) = (format!("xi_{}", c + 1), format!("\\xi_{{{}}}", c + 1));
                    let symbol = pool.symbol(&name, &latex, Assumption::None);
                    let symbol = pool.variable(symbol);
                    if !pool.is_syntactic_zero(*factor) {
                        terms.push(pool.mul(*factor, symbol));
                    }
                }
                let sum = pool.sum(&terms);
                let text = format!("[xi_{}, xi_{}]", a + 1, b + 1);
                let latex = format!("[\\xi_{{{}}}, \\xi_{{{}}}]", a + 1, b + 1);
                items.push(self.as_written(&text, &latex, sum));
            }
        }
        if is_abelian {
            items.push(Item::Words("the fields commute".to_owned()));
        }
        Section::plain("Group", items)
    }

    fn locked(&mut self) -> Section {
        let locked = &self.reduction.locked;
        Section {
            title: "Locked inertia",
            equation: ["I_ab = g(xi_a, xi_b)", r"I_{ab} = g(\xi_a, \xi_b)"],
            items: vec![self.matrix(["I", "I"], locked)],
        }
    }

    fn momenta(&mut self) -> Section {
        let mut items = Vec::new();
        for (a, momentum) in self.reduction.momenta.iter().enumerate() {
            let index = a + 1;
            items.push(self.writer.formula(
                format!("J_{index}"),
                format!("J_{{{index}}}"),
                *momentum,
            ));
        }
        let is_free = self.writer.model.constraints.is_empty();
        if !is_free {
            items.extend(self.sections());
        }
        let names = match is_free {
            true => ["J", "J"],
            false => ["JD", "J^D"],
        };
        match &self.reduction.rates {
            Some(rates) => {
                for (i, rate) in rates.iter().enumerate() {
                    let [text, latex] = names;
                    let text = format!("d/dt {text}_{}", i + 1);
                    let latex = format!("\\dot{{{latex}}}_{{{}}}", i + 1);
                    items.push(self.writer.formula(text, latex, *rate));
                }
            }
            None => items.push(Item::Words(
                "the rates are not written out with affine constraints or a dependence on time"
                    .to_owned(),
            )),
        }
        Section {
            title: "Momentum map",
            equation: ["J_a = <p, xi_a>", r"J_a = \langle p, \xi_a \rangle"],
            items,
        }
    }

    /// The fields along the orbits in D, with their momenta and inertia.
    fn sections(&mut self) -> Vec<Item> {
        let reduction = self.reduction;
        if reduction.sections.is_empty() {
            let text = "the constraints allow no motion along the group";
            return vec![Item::Words(text.to_owned())];
        }
        let mut items = Vec::new();
        for (i, section) in reduction.sections.iter().enumerate() {
            let index = i + 1;
            items.push(self.field(&format!("e_{index}"), &format!("e_{{{index}}}"), section));
        }
        for (i, momentum) in reduction.momenta_on_d.iter().enumerate() {
            let index = i + 1;
            items.push(self.writer.formula(
                format!("JD_{index}"),
                format!("J^D_{{{index}}}"),
                *momentum,
            ));
        }
        items.push(self.matrix(["ID", "I^D"], &reduction.constrained));
        items
    }

    fn connection(&mut self) -> Section {
        let reduction = self.reduction;
        let is_free = self.writer.model.constraints.is_empty();
        let mut items = Vec::new();
        match &reduction.connection {
            Some(forms) => {
                for (a, form) in forms.iter().enumerate() {
                    let value = self.combination(form, "d", "\\mathrm{d}#");
                    let index = a + 1;
                    items.push(self.as_written(
                        &format!("A_{index}"),
                        &format!("A^{{{index}}}"),
                        value,
                    ));
                }
            }
            None => items.push(Item::Words(
                "the orbits and D do not span all directions: there is no connection".to_owned(),
            )),
        }
        let (title, equation) = match is_free {
            true => (
                "Mechanical connection",
                ["A_a = I^ab g(xi_b, .)", r"A^a = I^{ab} g(\xi_b, \cdot)"],
            ),
            false => (
                "Nonholonomic connection",
                [
                    "A_a(xi_b) = delta_ab, eta(X - xi_a A_a(X)) = 0, g(e_i, X - xi_a A_a(X)) = 0",
                    r"A^a(\xi_b) = \delta^a_b, \quad \eta(X - \xi_a A^a(X)) = 0, \quad g(e_i, X - \xi_a A^a(X)) = 0",
                ],
            ),
        };
        Section {
            title,
            equation,
            items,
        }
    }

    fn curvature(&mut self) -> Section {
        let n = self.writer.model.coordinates.len();
        let names: Vec<[String; 2]> = (0..n).map(|k| self.writer.coordinate(k)).collect();
        let mut items = Vec::new();
        for (a, entries) in self.reduction.curvature.iter().enumerate() {
            for k in 0..n {
                for l in k + 1..n {
                    if self.writer.is_zero(entries[k][l]) {
                        continue;
                    }
                    let [[x, of_x], [y, of_y]] = [&names[k], &names[l]];
                    let index = a + 1;
                    items.push(self.writer.formula(
                        format!("B_{index}({x}, {y})"),
                        format!("B^{{{index}}}_{{{of_x} {of_y}}}"),
                        entries[k][l],
                    ));
                }
            }
        }
        if items.is_empty() && self.reduction.connection.is_some() {
            items.push(Item::Words("0: the connection is flat".to_owned()));
        }
        Section {
            title: "Curvature",
            equation: [
                "B_a = dA_a + 1/2 C_bc^a A_b ^ A_c",
                r"B^a = \mathrm{d}A^a + \tfrac12 C_{bc}^a A^b \wedge A^c",
            ],
            items,
        }
    }

    fn reduced(&mut self) -> Section {
        let Some(reduced) = &self.reduction.reduced else {
            let text = "not written out: the quasi-velocities in which the motion is derived, or their rates, are not shown to be invariant";
            return Section::plain("Reduced equations", vec![Item::Words(text.to_owned())]);
        };
        let mut items = Vec::new();
        for (symbol, of, _) in &reduced.quasi {
            let pool = &mut self.writer.model.pool;
            let (name, latex) = (
                pool.symbol_name(*symbol).to_owned(),
                pool.symbol_latex(*symbol).to_owned(),
            );
            if pool.variable(*symbol) != *of {
                items.push(self.writer.formula(name, latex, *of));
            }
        }
        for (symbol, _, rate) in &reduced.quasi {
            let pool = &self.writer.model.pool;
            let (name, latex) = (pool.symbol_name(*symbol), pool.symbol_latex(*symbol));
            let left = (format!("d/dt {name}"), format!("\\frac{{d}}{{dt}} {latex}"));
            items.push(self.writer.formula(left.0, left.1, *rate));
        }
        for (k, rate) in reduced.shape.iter().chain(&reduced.group) {
            let [name, latex] = self.writer.coordinate(*k);
            items.push(self.writer.formula(
                format!("d/dt {name}"),
                format!("\\frac{{d}}{{dt}} {latex}"),
                *rate,
            ));
        }
        let names: Vec<&str> = (reduced.shape.iter())
            .map(|(k, _)| self.writer.model.coordinates[*k].name.display.as_str())
            .collect();
        let text = match names.is_empty() {
            true => {
                "the group moves every coordinate: the equations of the quasi-velocities are a closed system"
                    .to_owned()
            }
            false => format!(
                "the equations of {} and the quasi-velocities are a closed system",
                names.join(", ")
            ),
        };
        items.push(Item::Words(text));
        Section::plain("Reduced equations", items)
    }

    fn impacts(&mut self) -> Section {
        let mut items = Vec::new();
        let is_free = self.writer.model.constraints.is_empty();
        let name = match is_free {
            true => ["J", "J"],
            false => ["JD", "J^D"],
        };
        // Impulses lie in the span of `pi_D^* dh`: they keep nothing but the momenta along D, and D has none here.
        let is_empty = !is_free && self.reduction.sections.is_empty();
        if is_empty && !self.reduction.impacts.is_empty() {
            let text = "the constraints leave no momentum along the group; impacts may change J";
            items.push(Item::Words(text.to_owned()));
        }
        let impacts = self.reduction.impacts.iter().filter(|_| !is_empty);
        for (s, jump) in impacts.enumerate() {
            let surface = self.writer.model.surfaces[s].name.display.clone();
            let law = self.writer.model.law_text(s);
            let Some(jump) = jump else {
                items.push(Item::Words(format!(
                    "surface {surface}: {law}, not shown to give an impulse along dh alone"
                )));
                continue;
            };
            if jump.slopes.iter().all(|slope| self.writer.is_zero(*slope)) {
                items.push(Item::Words(format!(
                    "surface {surface}: {law}, keeps {}",
                    name[0]
                )));
                continue;
            }
            items.push(Item::Words(format!("surface {surface}: {law}")));
            if let Some(impulse) = jump.impulse {
                items.push(self.writer.formula("eps", "\\epsilon", impulse));
            }
            for (i, slope) in jump.slopes.iter().enumerate() {
                let [text, latex] = name;
                let index = i + 1;
                items.push(self.writer.formula(
                    format!("({text}_{index}+ - {text}_{index})/eps"),
                    format!("({latex}_{{{index}}}{{}}^+ - {latex}_{{{index}}})/\\epsilon"),
                    *slope,
                ));
            }
        }
        Section {
            title: "Impacts on the momenta",
            equation: match is_free {
                true => [
                    "J_a+ = J_a + eps dh(xi_a)",
                    r"J_a^+ = J_a + \epsilon\, \mathrm{d}h(\xi_a)",
                ],
                false => [
                    "JD_a+ = JD_a + eps dh(e_a)",
                    r"{J^D_a}^+ = J^D_a + \epsilon\, \mathrm{d}h(e_a)",
                ],
            },
            items,
        }
    }
}
