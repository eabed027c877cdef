//! Owners of a model with values for its parameters: by its type, or by its form.

use dalembert::TaylorField;
use dalembert::describe::{Description, Instance};
use dalembert::erased::{self, Erased, Excess, Shared};
use dalembert::kernels::Declared;
use dalembert::numbers::Row;

use crate::refusal::Refusal;
use crate::typed::Model;

/// The system of computations that need no speed, such as those with variations. They are compiled for it alone. A model of
/// long vectors has none.
pub(crate) type Common<'f> = Erased<'f, 32>;

/// Owner of a model with values for its parameters.
pub(crate) trait Owner {
    /// The model as a system, which may borrow from its owner.
    type System<'a>: Model
    where
        Self: 'a;

    fn system(&self) -> Self::System<'_>;

    /// The model as a system for computations with variations, such as orbits, boundary values and linearisations.
    type Varied<'a>: Model
    where
        Self: 'a;

    /// # Errors
    /// [`Refusal::Large`] if the model has too many components for them.
    fn varied(&self) -> Result<Self::Varied<'_>, Refusal>;

    /// The form, if the model has one.
    fn form(&self) -> Option<&erased::Form>;

    fn description(&self) -> &Description;

    fn inputs(&self) -> &[&'static str];

    fn set_parameter(&mut self, index: usize, value: f64);

    fn set_mode(&mut self, mode: usize);

    /// The mode in which states are made, and its form; `None` without modes or without a form.
    fn mode(&self) -> Option<(usize, Shared<erased::Form>)>;
}

/// Owner of a model by its type.
pub(crate) struct OfType<M>(pub M);

impl<M: Model + 'static> Owner for OfType<M> {
    type System<'a> = M;

    fn system(&self) -> M {
        self.0.clone()
    }

    type Varied<'a> = M;

    fn varied(&self) -> Result<M, Refusal> {
        Ok(self.0.clone())
    }

    fn form(&self) -> Option<&erased::Form> {
        None
    }

    fn description(&self) -> &Description {
        self.0.description()
    }

    fn inputs(&self) -> &[&'static str] {
        self.0.inputs()
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.0.set_parameter(index, value);
    }

    fn set_mode(&mut self, mode: usize) {
        self.0.set_mode(mode);
    }

    fn mode(&self) -> Option<(usize, Shared<erased::Form>)> {
        None
    }
}

/// Owner of a model by its form, whose vectors have at most `C` components.
pub(crate) struct OfForm<const C: usize> {
    form: Shared<erased::Form>,
    /// The values of all parameters, inputs included.
    values: Vec<f64>,
    /// The number of the mode in which states are made.
    mode: usize,
}

impl<const C: usize> OfForm<C> {
    /// The system of another capacity.
    fn with_capacity<const D: usize>(&self) -> Result<Erased<'_, D>, Excess> {
        let mut system = Erased::of(&self.form)?;
        for (index, value) in self.values.iter().enumerate() {
            system.set_parameter(index, *value);
        }
        system.set_mode(self.mode);
        Ok(system)
    }

    /// The model with its declared parameter values.
    ///
    /// # Errors
    /// [`Excess`] if the form has longer vectors.
    pub fn of(form: &Shared<erased::Form>) -> Result<Self, Excess> {
        let values = TaylorField::parameters(&Erased::<C>::of(form)?);
        Ok(Self {
            form: form.clone(),
            values: Row::as_slice(&values).to_vec(),
            mode: 0,
        })
    }
}

impl<const C: usize> Owner for OfForm<C> {
    type System<'a> = Erased<'a, C>;

    fn system(&self) -> Erased<'_, C> {
        let system = self.with_capacity();
        system.expect("vectors of at most `C` components, as in `of`")
    }

    type Varied<'a> = Common<'a>;

    fn varied(&self) -> Result<Common<'_>, Refusal> {
        Ok(self.with_capacity()?)
    }

    fn form(&self) -> Option<&erased::Form> {
        Some(&self.form)
    }

    fn description(&self) -> &Description {
        &self.form.documentation.description
    }

    fn inputs(&self) -> &[&'static str] {
        &self.form.documentation.inputs
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        if let Some(entry) = self.values.get_mut(index) {
            *entry = value;
        }
    }

    fn set_mode(&mut self, mode: usize) {
        let mut system = self.system();
        system.set_mode(mode);
        self.mode = Declared::start(&system);
    }

    fn mode(&self) -> Option<(usize, Shared<erased::Form>)> {
        let mode = self.form.tables.modes.get(self.mode)?;
        Some((self.mode, self.form.forms.get(mode.kernels)?.clone()))
    }
}
