//! Dense linear algebra for the runtime itself. Generated code contains its own.

pub(crate) mod qr;
