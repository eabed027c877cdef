//! Declared impact laws. The runtime has one of the same name for each.

use dalembert_expr::{ExprId, Pool};

/// A declared impact law; coefficients are expressions of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// `elastic`
    Elastic,
    /// `restitution(e)`
    Restitution(ExprId),
    /// `newton(e)`
    Newton(ExprId),
    /// `nonholonomic_plastic`
    NonholonomicPlastic,
    /// `impact_plastic`
    ImpactPlastic,
    /// `totally_plastic`
    TotallyPlastic,
}

impl Law {
    /// The law of this name with this coefficient; `None` if there is no such law.
    pub(super) fn named(name: &str, coefficient: Option<ExprId>) -> Option<Self> {
        Some(match (name, coefficient) {
            ("elastic", None) => Self::Elastic,
            ("restitution", Some(e)) => Self::Restitution(e),
            ("newton", Some(e)) => Self::Newton(e),
            ("nonholonomic_plastic", None) => Self::NonholonomicPlastic,
            ("impact_plastic", None) => Self::ImpactPlastic,
            ("totally_plastic", None) => Self::TotallyPlastic,
            _ => return None,
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Restitution(_) => "restitution",
            Self::Newton(_) => "newton",
            Self::NonholonomicPlastic => "nonholonomic_plastic",
            Self::ImpactPlastic => "impact_plastic",
            Self::TotallyPlastic => "totally_plastic",
        }
    }

    /// Its coefficient.
    pub fn coefficient(self) -> Option<ExprId> {
        match self {
            Self::Restitution(e) | Self::Newton(e) => Some(e),
            Self::Elastic
            | Self::NonholonomicPlastic
            | Self::ImpactPlastic
            | Self::TotallyPlastic => None,
        }
    }

    /// As it was declared: `newton(e)`.
    pub fn text(self, pool: &Pool) -> String {
        match self.coefficient() {
            Some(e) => format!("{}({})", self.name(), pool.text(e)),
            None => self.name().to_owned(),
        }
    }
}
