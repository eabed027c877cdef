//! The commands, one file each.

pub mod accuracy;
pub mod build;
pub mod check;
pub mod connect;
pub mod control;
pub mod derive;
pub mod ensemble;
pub mod errata;
pub mod eval;
pub mod export;
pub mod gallery;
pub mod linearise;
pub mod list;
pub mod map;
pub mod new;
pub mod orbit;
pub mod simulate;
pub mod stability;
pub mod watch;
