//! Owners of a model with values for its parameters: by its type, or by its form.

use std::sync::{Arc, OnceLock};

use dalembert::describe::{Description, Instance};
use dalembert::erased::{self, Erased, Excess, Shared};
use dalembert::kernels::Declared;
use dalembert::numbers::Row;
use dalembert::{Fault, StateError, TaylorField};

use crate::refusal::Refusal;
use crate::typed::Model;

/// The system of computations that need no speed, such as those with variations. They are compiled for it alone. A model of
/// long vectors has none.
pub(crate) type Common<'f> = Erased<'f, 32>;

/// The largest capacity of an erased system.
pub(crate) const LARGEST: usize = erased::CAPACITIES[erased::CAPACITIES.len() - 1];

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

    /// The model as a system that has its global form.
    type General<'a>: Model
    where
        Self: 'a;

    /// # Errors
    /// [`Fault::NotDerived`] if the declaration does not ask for the global form, and its text is not known or too large.
    fn general(&self) -> Result<Self::General<'_>, Fault>;

    /// The form with everything that the declaration determines; `None` if the model has only a type.
    fn whole(&self) -> Option<&erased::Form>;

    fn description(&self) -> &Description;

    fn inputs(&self) -> &[&'static str];

    fn set_parameter(&mut self, index: usize, value: f64);

    fn set_mode(&mut self, mode: usize);

    /// The mode in which states are made, and its form; `None` without modes or without a form.
    fn mode(&self) -> Option<(usize, Shared<erased::Form>)>;
}

/// A function that makes the form of a declaration with everything that the declaration determines: its global form, and
/// kernels over all numbers. Compiled forms leave out what a declaration does not ask for. `None` if there is no such form.
pub type MakeWhole = Arc<dyn Fn() -> Option<Shared<erased::Form>> + Send + Sync>;

/// The result of a [`MakeWhole`], which is called when it is first needed.
struct Whole {
    make: MakeWhole,
    made: OnceLock<Option<Shared<erased::Form>>>,
}

impl Whole {
    fn of(make: MakeWhole) -> Self {
        Self {
            make,
            made: OnceLock::new(),
        }
    }

    fn form(&self) -> Option<&erased::Form> {
        self.made.get_or_init(|| (self.make)()).as_deref()
    }
}

/// The system of a form with these values of its parameters, in this mode.
///
/// # Errors
/// [`Excess`] if the form has longer vectors.
fn system_of<'f, const C: usize>(
    form: &'f erased::Form,
    values: &[f64],
    mode: usize,
) -> Result<Erased<'f, C>, Excess> {
    let mut system = Erased::of(form)?;
    for (index, value) in values.iter().enumerate() {
        system.set_parameter(index, *value);
    }
    system.set_mode(mode);
    Ok(system)
}

/// Owner of a model by its type, whose runs in its own form are compiled for the type. Everything that needs the global
/// form, or no speed, is done by the form of its declaration.
pub(crate) struct Inlined<M> {
    system: M,
    /// The number of the mode in which states are made.
    mode: usize,
    whole: Whole,
}

impl<M: Model + 'static> Inlined<M> {
    pub fn of(system: M, make: MakeWhole) -> Self {
        Self {
            system,
            mode: 0,
            whole: Whole::of(make),
        }
    }

    /// The same model as the system of a form.
    fn system_of<'f, const C: usize>(
        &self,
        form: &'f erased::Form,
    ) -> Result<Erased<'f, C>, Excess> {
        let values = TaylorField::parameters(&self.system);
        system_of(form, Row::as_slice(&values), self.mode)
    }
}

impl<M: Model + 'static> Owner for Inlined<M> {
    type System<'a> = M;

    fn system(&self) -> M {
        self.system.clone()
    }

    type Varied<'a> = Common<'a>;

    fn varied(&self) -> Result<Common<'_>, Refusal> {
        let form = self.whole.form().ok_or(Fault::NotDerived);
        Ok(self.system_of(form.map_err(StateError::from)?)?)
    }

    type General<'a> = Erased<'a, LARGEST>;

    fn general(&self) -> Result<Erased<'_, LARGEST>, Fault> {
        let form = self.whole.form().ok_or(Fault::NotDerived)?;
        self.system_of(form).map_err(|_| Fault::NotDerived)
    }

    fn whole(&self) -> Option<&erased::Form> {
        self.whole.form()
    }

    fn description(&self) -> &Description {
        self.system.description()
    }

    fn inputs(&self) -> &[&'static str] {
        self.system.inputs()
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.system.set_parameter(index, value);
    }

    fn set_mode(&mut self, mode: usize) {
        if mode < self.description().modes.len() {
            self.mode = mode;
            self.system.set_mode(mode);
        }
    }

    fn mode(&self) -> Option<(usize, Shared<erased::Form>)> {
        None
    }
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

    type General<'a> = M;

    fn general(&self) -> Result<M, Fault> {
        Ok(self.0.clone())
    }

    fn whole(&self) -> Option<&erased::Form> {
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
    /// The form with everything, if the form itself is a compiled one.
    whole: Option<Whole>,
    /// The values of all parameters, inputs included.
    values: Vec<f64>,
    /// The number of the mode in which states are made.
    mode: usize,
}

impl<const C: usize> OfForm<C> {
    /// The system of another form of the model, and of another capacity.
    fn system_of<'f, const D: usize>(
        &self,
        form: &'f erased::Form,
    ) -> Result<Erased<'f, D>, Excess> {
        system_of(form, &self.values, self.mode)
    }

    /// The model with its declared parameter values. `make` makes the form with everything, if `form` is not that form.
    ///
    /// # Errors
    /// [`Excess`] if the form has longer vectors.
    pub fn of(form: &Shared<erased::Form>, make: Option<&MakeWhole>) -> Result<Self, Excess> {
        let values = TaylorField::parameters(&Erased::<C>::of(form)?);
        Ok(Self {
            form: form.clone(),
            whole: make.cloned().map(Whole::of),
            values: Row::as_slice(&values).to_vec(),
            mode: 0,
        })
    }
}

impl<const C: usize> Owner for OfForm<C> {
    type System<'a> = Erased<'a, C>;

    fn system(&self) -> Erased<'_, C> {
        let system = self.system_of(&self.form);
        system.expect("vectors of at most `C` components, as in `of`")
    }

    type Varied<'a> = Common<'a>;

    fn varied(&self) -> Result<Common<'_>, Refusal> {
        Ok(self.system_of(&self.form)?)
    }

    type General<'a> = Erased<'a, C>;

    fn general(&self) -> Result<Erased<'_, C>, Fault> {
        let form = match self.form.global() {
            Some(_) => Some(&*self.form),
            None => self.whole(),
        };
        let form = form.ok_or(Fault::NotDerived)?;
        self.system_of(form).map_err(|_| Fault::NotDerived)
    }

    fn whole(&self) -> Option<&erased::Form> {
        match &self.whole {
            Some(whole) => whole.form(),
            None => Some(&self.form),
        }
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
