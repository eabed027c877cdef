//! The map of an impulse on series of velocities: the equations of [`super::wall`] and [`super::focusing`].

use dalembert_expr::{Arithmetic, Jets, Series};

use super::linear::{Matrix, dot, solve};
use crate::model::Law;

/// Parts of the map of an impulse.
pub(super) struct Parts<A: Arithmetic> {
    pub(super) metric: Matrix<A>,
    /// `eta`, then `psi`.
    pub(super) forms: Matrix<A>,
    /// `dh`
    pub(super) slope: Vec<Series<A>>,
    /// `psi_0`
    pub(super) affine: Vec<Series<A>>,
    /// `d_t h`
    pub(super) rate: Series<A>,
    pub(super) coefficient: Series<A>,
}

impl<A: Arithmetic> Parts<A> {
    /// `dh(qdot) + d_t h`
    pub(super) fn gap_rate(&self, jets: &Jets<'_, A>, velocity: &[Series<A>]) -> Series<A> {
        jets.add(&dot(jets, &self.slope, velocity), &self.rate)
    }

    /// The velocity on which the law acts: `velocity`, projected onto the instantaneous constraints.
    pub(super) fn focused(
        &self,
        jets: &Jets<'_, A>,
        velocity: &[Series<A>],
    ) -> Option<Vec<Series<A>>> {
        if self.affine.is_empty() {
            return Some(velocity.to_vec());
        }
        let declared = self.forms.len() - self.affine.len();
        let mut lost = vec![jets.constant(jets.field.integer(0)); declared];
        for (form, affine) in self.forms[declared..].iter().zip(&self.affine) {
            lost.push(jets.add(&dot(jets, form, velocity), affine));
        }
        projected(jets, &self.metric, &self.forms, &lost, velocity)
    }

    /// The velocities after an impulse of a law; `None` if the law has no impulse.
    pub(super) fn struck(
        &self,
        jets: &Jets<'_, A>,
        law: Law,
        velocity: &[Series<A>],
    ) -> Option<Vec<Series<A>>> {
        let velocity = &self.focused(jets, velocity)?;
        let Normal {
            gradient,
            projected,
        } = Normal::of(jets, &self.metric, &self.forms, &self.slope)?;
        let steep = dot(jets, &self.slope, &projected);
        let gap_rate = self.gap_rate(jets, velocity);
        let lowered = self.metric.iter().map(|row| dot(jets, row, &projected));
        let lowered: Vec<_> = lowered.collect();
        let momentum = jets.add(&dot(jets, velocity, &lowered), &self.rate);
        let ratio = || {
            let whole = jets.inverse(&dot(jets, &self.slope, &gradient))?;
            Some(jets.mul(&steep, &whole))
        };
        let elastic = jets.add(&jets.constant(jets.field.integer(1)), &self.coefficient);
        let factor = match law {
            Law::Elastic | Law::Restitution(_) => jets.mul(&elastic, &momentum),
            Law::Newton(_) => jets.mul(&elastic, &gap_rate),
            Law::NonholonomicPlastic => {
                let twice = jets.scale(jets.field.integer(2), &ratio()?);
                jets.mul(&twice, &gap_rate)
            }
            Law::ImpactPlastic => gap_rate,
            Law::TotallyPlastic => jets.mul(&ratio()?, &gap_rate),
            Law::Reset | Law::Stop | Law::Transition => return None,
        };
        let impulse = jets.mul(&factor, &jets.inverse(&steep)?);
        let after = |(before, along): (&Series<A>, &Series<A>)| {
            jets.sub(before, &jets.mul(&impulse, along))
        };
        Some(velocity.iter().zip(&projected).map(after).collect())
    }
}

/// `grad h` and `pi_D grad h` at a point.
struct Normal<A: Arithmetic> {
    gradient: Vec<Series<A>>,
    projected: Vec<Series<A>>,
}

impl<A: Arithmetic> Normal<A> {
    /// Geometry of a metric, the forms of the constraints and `dh`; `None` where the metric or the constraints are
    /// singular.
    fn of(
        jets: &Jets<'_, A>,
        metric: &Matrix<A>,
        forms: &Matrix<A>,
        slope: &[Series<A>],
    ) -> Option<Self> {
        let m = forms.len();
        let right = (0..slope.len())
            .map(|i| {
                let mut row: Vec<_> = forms.iter().map(|form| form[i].clone()).collect();
                row.push(slope[i].clone());
                row
            })
            .collect();
        let raised = solve(jets, metric.clone(), right)?.unknowns;
        let column = |j: usize| -> Vec<_> { raised.iter().map(|row| row[j].clone()).collect() };
        let gradient = column(m);
        let duals: Vec<Vec<_>> = (0..m).map(column).collect();
        let mass = forms
            .iter()
            .map(|form| duals.iter().map(|dual| dot(jets, form, dual)).collect())
            .collect();
        let along = forms
            .iter()
            .map(|form| vec![dot(jets, form, &gradient)])
            .collect();
        let share = solve(jets, mass, along)?.unknowns;
        let mut projected = gradient.clone();
        for (part, dual) in share.iter().zip(&duals) {
            for (entry, w) in projected.iter_mut().zip(dual) {
                *entry = jets.sub(entry, &jets.mul(&part[0], w));
            }
        }
        Some(Self {
            gradient,
            projected,
        })
    }
}

/// A velocity, projected onto the constraints of the rows `forms`. `lost` are the residuals of the constraints.
fn projected<A: Arithmetic>(
    jets: &Jets<'_, A>,
    metric: &Matrix<A>,
    forms: &Matrix<A>,
    lost: &[Series<A>],
    velocity: &[Series<A>],
) -> Option<Vec<Series<A>>> {
    let columns = 0..velocity.len();
    let transposed = columns.map(|i| forms.iter().map(|form| form[i].clone()).collect());
    let raised = solve(jets, metric.clone(), transposed.collect())?.unknowns;
    let duals: Vec<Vec<_>> = (0..forms.len())
        .map(|j| raised.iter().map(|row| row[j].clone()).collect())
        .collect();
    let mass = forms.iter().map(|form| {
        let row = duals.iter().map(|dual| dot(jets, form, dual));
        row.collect()
    });
    let right = lost.iter().map(|entry| vec![entry.clone()]).collect();
    let share = solve(jets, mass.collect(), right)?.unknowns;
    let mut found = velocity.to_vec();
    for (part, dual) in share.iter().zip(&duals) {
        for (entry, w) in found.iter_mut().zip(dual) {
            *entry = jets.sub(entry, &jets.mul(&part[0], w));
        }
    }
    Some(found)
}
