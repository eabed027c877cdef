//! The little dense linear algebra that the runtime itself needs; generated code brings its own.

pub(crate) mod qr;
