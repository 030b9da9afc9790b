//! From the data sets to a finished model, stage by stage.
//!
//! A stage is data ([`stage`]): a name, a version, content hashes of its inputs and options. Its
//! output is kept under the hash of all that ([`store`]), so an interrupted run goes on where it
//! stopped, and a changed data set or option makes again what depends on it and nothing else.
//!
//! | stage | file | makes |
//! |---|---|---|
//! | `fits` | [`fits`] | the 3D head fitted to every photograph |
//! | `renders`, `renders-near` | [`renders`] | rendered faces |
//! | `face` | [`face`] | section `FACE`, the 3D face |
//! | `detector` | [`detector`] | section `DTCT` |
//! | `global-network` | [`global_network`] | section `ALGN` |
//! | `ensemble-member` | [`ensemble_member`] | section `ENSM` |
//! | `refiners` | [`refiners`] | section `RFIN` |
//! | `shape-regression` | [`shape_regression`] | section `SREG` |
//! | `rotation-regression` | [`rotation_regression`] | section `ROTN` |
//! | `verifier` | [`verifier`] | section `VRFY` |
//! | `mesh` | [`mesh`] | section `MESH` |
//! | `data-sheet` | [`data_sheet`] | errors on the dev photographs, for section `INFO` |
//!
//! [`pack`] writes the model of these, and [`run()`] calls them in order. [`eyes`] and [`weights`]
//! make sections for a model that is finished, and [`add`] writes it with one more section.

pub mod add;
pub mod args;
pub mod context;
pub mod data_sheet;
pub mod detector;
pub mod ensemble_member;
pub mod eyes;
pub mod face;
pub mod fits;
pub mod global_network;
pub mod hash;
pub mod marks;
pub mod mesh;
pub mod pack;
pub mod refiners;
pub mod renders;
pub mod rotation_regression;
mod run;
mod sections;
pub mod shape_regression;
pub mod stage;
pub mod store;
pub mod verifier;
pub mod weights;

pub use args::Args;
pub use run::run;
