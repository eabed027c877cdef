//! The section on the motion reduced to D: its quasi-velocities and the equations of the velocities, or the reason for
//! which the motion is not reduced.

use dalembert_expr::ExprId;

use super::equations::{Writer, escape};
use super::{Item, Section};
use crate::mechanics::Unreduced;
use crate::mechanics::frame::{Block, Row, Solve};

const EQUATION: [&str; 2] = [
    "qdot = X_0 + X_i u^i, G_D udot = X^T (f - drift - g (Xdot u + Xdot_0)), G_D = X^T g X",
    r"\dot q = X_0 + X_i u^i, \quad
      G_D \dot u = X^T \left( f - \dot g \dot q - \dot A - g (\dot X u + \dot X_0) \right), \quad G_D = X^T g X",
];

impl Writer<'_> {
    /// The motion on D.
    pub(super) fn frame(&mut self) -> Section {
        let mut items = Vec::new();
        let derivation = self.derivation;
        match &derivation.frame {
            Err(Unreduced::Free) => {
                return Section::plain("Motion on D", items);
            }
            Err(Unreduced::NoRegularFrame(constraints)) => {
                let names = self.names_of(constraints);
                items.push(Item::Words(format!(
                    "solved in global form: no velocity follows from {names} at every configuration, and no frame is declared"
                )));
                return Section::plain("Motion on D", items);
            }
            Err(Unreduced::Nonlinear(constraints)) => {
                let names = self.names_of(constraints);
                items.push(Item::Words(format!(
                    "solved in global form, because of constraints that are not linear in the velocities: {names}"
                )));
                return Section::plain("Motion on D", items);
            }
            Ok(frame) => {
                for quasi in &frame.quasi {
                    let form = quasi.form.clone();
                    let velocity = self.contraction(&form);
                    let latex = format!("\\text{{{}}}", escape(&quasi.name));
                    items.push(self.formula(quasi.name.clone(), latex, velocity));
                }
                for block in &frame.blocks {
                    items.extend(self.block(block));
                }
            }
        }
        Section {
            title: "Motion on D",
            equation: EQUATION,
            items,
        }
    }

    fn names_of(&self, constraints: &[usize]) -> String {
        let names = constraints.iter();
        let names: Vec<&str> = names
            .map(|&a| self.model.constraints[a].name.display.as_str())
            .collect();
        names.join(", ")
    }

    /// `alpha(qdot)`
    fn contraction(&mut self, form: &[ExprId]) -> ExprId {
        let terms: Vec<ExprId> = (0..form.len())
            .map(|i| {
                let symbol = self.model.coordinates[i].qdot;
                let velocity = self.model.pool.variable(symbol);
                self.model.pool.mul(form[i], velocity)
            })
            .collect();
        self.model.pool.sum(&terms)
    }

    /// Equation for the velocities of a block; `None` for a velocity that is a quasi-velocity itself.
    fn block(&mut self, block: &Block) -> Option<Item> {
        let velocities: Vec<String> = block
            .columns
            .iter()
            .map(|&i| self.model.coordinates[i].name.velocity())
            .collect();
        let rows: Vec<String> = block.rows.iter().map(|&row| self.row_name(row)).collect();
        let how = match &block.solve {
            Solve::Entry => match block.rows[0] {
                Row::Quasi(i) if self.is_coordinate(i) => return None,
                _ => "by division",
            },
            Solve::Rows(_) => "by orthogonal rows",
            Solve::Columns(_) => "by orthogonal columns",
            Solve::General => "by orthogonalisation",
        };
        Some(Item::Words(format!(
            "{} from {}, {how}",
            velocities.join(", "),
            rows.join(", ")
        )))
    }

    fn is_coordinate(&self, quasi: usize) -> bool {
        let frame = self.derivation.frame.as_ref().ok();
        frame.is_some_and(|frame| frame.quasi[quasi].coordinate.is_some())
    }

    fn row_name(&self, row: Row) -> String {
        match (row, &self.derivation.frame) {
            (Row::Quasi(i), Ok(frame)) => frame.quasi[i].name.clone(),
            (Row::Quasi(i), Err(_)) => format!("u_{i}"),
            (Row::Constraint(a), _) => self.model.constraints[a].name.display.clone(),
        }
    }
}
