//! Exact expressions for mechanics: hash-consed nodes, derivatives, zero tests, printing.
//!
//! Every expression is stored in a [`Pool`] and identified by an [`ExprId`]. Equal expressions have equal ids. Ids are
//! assigned in order of creation, so operands have smaller ids than the nodes that use them. Passes iterate over ids in
//! increasing order instead of recursing, and every result is the same in every run.
//!
//! | file | job |
//! |---|---|
//! | `rational.rs`, `decimal.rs` | exact numbers; conversion from text and to doubles |
//! | `function.rs` | the functions of one argument and their properties |
//! | `node.rs`, `pool.rs`, `intern.rs` | nodes of expressions and their storage |
//! | `construct.rs`, `sum.rs`, `product.rs`, `call.rs`, `constants.rs` | the constructors and every rewrite they make |
//! | `sign.rs` | signs and finiteness |
//! | `diff.rs`, `subst.rs`, `eval.rs` | calculus and evaluation |
//! | `taylor/` | truncated series modulo a prime, in doubles, in intervals or in balls |
//! | `field.rs`, `point.rs`, `modular.rs`, `profile.rs`, `branch.rs`, `squares.rs`, `zero.rs`, `rank.rs` | exact evaluation modulo a prime, and decisions based on it |
//! | `ball/` | numbers of 76 digits with error bounds |
//! | `interval.rs`, `enclose.rs` | certified ranges; proofs that an expression is never 0 |
//! | `simplify.rs`, `expand.rs`, `print/` | presentation |
//!
//! ```
//! use dalembert_expr::{Assumption, Function, Pool, Rational, Verdict};
//!
//! let mut pool = Pool::new();
//! let angle = pool.symbol("theta", r"\theta", Assumption::None);
//! let theta = pool.variable(angle);
//! let sine = pool.call(Function::Sin, theta);
//! let cosine = pool.call(Function::Cos, theta);
//! assert_eq!(pool.diff(sine, angle), cosine);
//!
//! let two = Rational::from(2);
//! let (s2, c2) = (pool.pow(sine, two.clone()), pool.pow(cosine, two));
//! let sum = pool.add(s2, c2);
//! let one = pool.one();
//! let difference = pool.sub(sum, one);
//! assert_eq!(pool.zero_test(difference), Verdict::Proved);
//! ```

#![forbid(unsafe_code)]
// Tests may panic.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod ball;
mod branch;
mod call;
mod constants;
mod construct;
mod decimal;
mod diff;
mod enclose;
mod eval;
mod expand;
mod field;
#[cfg(test)]
mod fixture;
mod function;
mod generic;
mod intern;
mod interval;
mod modular;
mod node;
mod point;
mod pool;
mod print;
mod product;
mod profile;
mod rank;
mod rational;
mod sign;
mod simplify;
mod squares;
mod subst;
mod sum;
mod taylor;
mod zero;

pub use ball::Ball;
pub use branch::{Branches, Covered};
pub use enclose::{Domain, Zeros};
pub use field::Modulus;
pub use function::{Course, Function, Singularity};
pub use intern::{WordHash, WordHasher};
pub use interval::Interval;
pub use node::{Assumption, ExprId, Node, SymbolId};
pub use point::{ModularFailure, ModularPoint};
pub use pool::Pool;
pub use profile::Profile;
pub use rank::RankReport;
pub use rational::{MAX_BITS, Rational};
pub use sign::Sign;
pub use taylor::{
    Arithmetic, BallPoint, Balls, EnclosedPoint, Enclosures, ExpansionPoint, JetSpace, Jets,
    RangePoint, RealPoint, Reals, Series,
};
pub use zero::{Frozen, SamplePoints, Verdict};
