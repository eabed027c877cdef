//! Items that declarations expand to.

// A test fails by panicking.
#![allow(clippy::unwrap_used)]

mod families;
mod files;
mod indices;
