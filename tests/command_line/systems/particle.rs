//! Implementations of the traits for a particle, which the systems share. They are macros, since the types contain the
//! lengths of vectors.

/// Mass, force and potential of a system.
pub(super) trait Particle<const N: usize> {
    fn mass(&self) -> f64;
    fn force(&self, q: &[f64; N]) -> [f64; N];
    fn potential(&self, q: &[f64; N]) -> f64;
}

/// `VectorField` and `TaylorField` of a [`Particle`] with state `(q, p)`.
macro_rules! field {
    ($type:ty, $n:literal, $dim:literal) => {
        impl VectorField for $type {
            type State = SVector<f64, $dim>;

            fn rate(
                &self,
                _t: f64,
                state: &Self::State,
                rate: &mut Self::State,
            ) -> Result<(), Fault> {
                let force = Particle::force(self, &std::array::from_fn(|i| state[i]));
                for i in 0..$n {
                    rate[i] = state[$n + i] / self.mass();
                    rate[$n + i] = force[i];
                }
                Ok(())
            }
        }

        // Every force is that of a spring along its axis plus a constant, which gives a linear recurrence.
        impl TaylorField for $type {
            type Parameters<L: Numbers> = [L; 1 + $dim];
            type Row<L: Numbers> = [L; $dim];
            type Gaps<L: Numbers> = [L; 0];
            type Firsts<L: Numbers> = [L; $dim];
            type Jets<L: Numbers> = [[L; LENGTH]; 0];

            fn parameters(&self) -> Self::Parameters<f64> {
                let constant = Particle::force(self, &[0.0; $n]);
                let mut parameters = [self.mass(); 1 + $dim];
                for i in 0..$n {
                    let mut q = [0.0; $n];
                    q[i] = 1.0;
                    parameters[1 + i] = Particle::force(self, &q)[i] - constant[i];
                    parameters[1 + $n + i] = constant[i];
                }
                parameters
            }

            fn begin<L: Numbers>(
                &self,
                parameters: &Self::Parameters<L>,
                _t: L,
                state: &Self::Row<L>,
                firsts: &mut Self::Firsts<L>,
            ) -> Result<(), Fault> {
                for i in 0..$n {
                    firsts[i] = state[$n + i] / parameters[0];
                    firsts[$n + i] = parameters[1 + i] * state[i] + parameters[1 + $n + i];
                }
                Ok(())
            }

            fn advance<L: Numbers>(
                &self,
                parameters: &Self::Parameters<L>,
                unit: L,
                order: usize,
                firsts: &Self::Firsts<L>,
                coefficients: &mut [Self::Row<L>; LENGTH],
                _gaps: &mut [Self::Gaps<L>; LENGTH],
                _jets: &mut Self::Jets<L>,
            ) {
                coefficients[1] = firsts.map(|rate| unit * rate);
                for k in 1..order {
                    let scale = unit / L::of((k + 1) as f64);
                    for i in 0..$n {
                        coefficients[k + 1][i] = scale * coefficients[k][$n + i] / parameters[0];
                        coefficients[k + 1][$n + i] =
                            scale * parameters[1 + i] * coefficients[k][i];
                    }
                }
            }
        }
    };
}

/// The field and `System` of a [`Particle`] with state `(q, p)`. `hooks` are further methods of `System`.
macro_rules! particle {
    ($type:ty, $n:literal, $dim:literal, { $($hooks:tt)* }) => {
        field!($type, $n, $dim);
        system!($type, $n, $dim, { $($hooks)* });
    };
}

/// `System` of a [`Particle`] with state `(q, p)`. `hooks` are further methods of `System`.
macro_rules! system {
    ($type:ty, $n:literal, $dim:literal, { $($hooks:tt)* }) => {
        impl System for $type {
            type Vector = SVector<f64, $n>;
            type Impulse = SVector<f64, $n>;

            fn position(&self, state: &Self::State) -> Self::Vector {
                SVector::from_fn(|i, _| state[i])
            }

            fn velocity(&self, _t: f64, state: &Self::State) -> Result<Self::Vector, Fault> {
                Ok(SVector::from_fn(|i, _| state[$n + i] / self.mass()))
            }

            fn momentum(&self, _t: f64, state: &Self::State) -> Result<Self::Vector, Fault> {
                Ok(SVector::from_fn(|i, _| state[$n + i]))
            }

            fn state_unchecked(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<Self::State, Fault> {
                self.state_from_momenta(t, q, &(qdot * self.mass()))
            }

            fn state_from_momenta(&self, _t: f64, q: &Self::Vector, p: &Self::Vector) -> Result<Self::State, Fault> {
                Ok(SVector::from_fn(|i, _| if i < $n { q[i] } else { p[i - $n] }))
            }

            fn energy(&self, _t: f64, state: &Self::State) -> Result<f64, Fault> {
                let kinetic: f64 = (0..$n).map(|i| state[$n + i] * state[$n + i]).sum::<f64>() / (2.0 * self.mass());
                Ok(kinetic + self.potential(&std::array::from_fn(|i| state[i])))
            }

            fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse) {
                (0..$n).for_each(|i| state[$n + i] += size * direction[i]);
            }

            fn check_parameters(&self) -> Result<(), ParameterError> {
                for (index, parameter) in Self::DESCRIPTION.parameters.iter().enumerate() {
                    let value = self.parameter(index);
                    if !parameter.assumption.holds(value) {
                        return Err(ParameterError { name: parameter.name, value, expected: parameter.assumption });
                    }
                }
                Ok(())
            }

            $($hooks)*
        }
    };
}

/// `Lagrangian` of a [`Particle`] without constraints.
macro_rules! free {
    ($type:ty, $n:literal) => {
        impl Lagrangian for $type {
            type Reactions = SVector<f64, 0>;

            fn force(&self, _t: f64, q: &Self::Vector, _qdot: &Self::Vector) -> Self::Vector {
                SVector::from(Particle::force(self, &std::array::from_fn(|i| q[i])))
            }

            fn reaction_force(
                &self,
                _t: f64,
                _q: &Self::Vector,
                _reactions: &Self::Reactions,
            ) -> Self::Vector {
                Self::Vector::zeros()
            }

            fn constrained_velocity(
                &self,
                _t: f64,
                _q: &Self::Vector,
                p: &Self::Vector,
            ) -> Result<(Self::Vector, Self::Reactions), Fault> {
                Ok((p / self.mass(), SVector::zeros()))
            }
        }
    };
}

pub(super) use {field, free, particle, system};
