//! Dense linear algebra of the runtime itself; generated code contains its own.

pub(crate) mod qr;
