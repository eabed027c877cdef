//! One type of system for all models: a model known only at run time, behind pointers.
//!
//! [`Form`] is a form of a model as data: its tables and pointers to its kernels. [`Erased`] is the system of a form
//! with values for its parameters. Driver, integrators, effects and events run it like any declared model and give
//! the same bits. They are compiled once for all models; each kernel costs a call through a pointer.
//!
//! Vectors are stored in arrays of fixed capacity with their length: `Erased<8>` runs every model whose vectors have
//! at most 8 components ([`Form::fits`]). Nothing is allocated.
//!
//! | file | job |
//! |---|---|
//! | `bounded.rs` | vectors and rows of a length that is known at run time |
//! | `form.rs` | a form as data |
//! | `series.rs` | power series behind pointers |
//! | `system.rs` | the system of a form |
//! | `scene.rs` | its effects |

mod bounded;
mod form;
mod scene;
mod series;
mod system;

pub use bounded::{Bounded, Wide};
pub use dalembert_numbers::{Held, Shared};
pub use form::{CAPACITIES, Defaults, Excess, Form, Global, Kinds, MOST_FIRSTS};
pub use series::{Advance, Begin, Expanded, SeriesTable};
pub use system::Erased;
