//! What a study is: objects, configurations, comparisons and groups, and the records its stages exchange.
//!
//! A study is written down once, in a TOML file ([`config`]), read and checked before any work starts
//! ([`Study::load`]), and from then on passed by value. The stages never call each other: they hand over the
//! plain records of [`record`] and [`machine`], so statistics build without geometry.
//!
//! Names: a *method* makes a mesh of an object (`bi`: body-centred, integrated); a *factor* is what methods differ in, a *level* a value
//! of it; a *configuration* is a method applied to an object (`ss_bi`); a *comparison* shows two configurations of one object side by side; a
//! *comparison group* collects the comparisons whose methods are all among its members.

mod check;
pub mod code_names;
pub mod config;
pub mod contrast;
mod date;
pub mod forms;
pub mod lint;
mod load;
pub mod machine;
mod method;
pub mod published;
mod read;
pub mod record;
mod study;
pub mod sweep;
pub mod texts;
pub mod wording;

pub use check::ConfigError;
pub use date::{Date, ParseDateError};
pub use method::{
    Arrangement, Clustering, ConfigurationId, Crossed, Factor, FactorSpec, Level, LevelSpec, Method,
    MethodId, ParseIdError, Recipe, TETRAHEDRA,
};
pub use record::Stage;
pub use study::{Comparison, Configuration, Group, METHOD, Published, Study};
