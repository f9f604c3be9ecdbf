//! Reads logs of other programs into recordings.
//!
//! A file of any format becomes a [`Log`] of named columns. A [`Recipe`] assigns roles to the columns. Missing roles are
//! guessed from names, units and numbers, and [`Imported::roles`] reports them. [`import()`] makes a
//! [`Recording`](recording::Recording) of both, in SI units.
//!
//! ```
//! use import::{Column, Log, Recipe, import};
//!
//! let time: Vec<f64> = (0..2000).map(f64::from).collect();
//! let log = Log {
//!     name: "swing".into(),
//!     columns: vec![
//!         Column::numbers("t_ms", time.clone()),
//!         Column::numbers("motor current [mA]", time.iter().map(|t| 80.0 * (0.006 * t).cos()).collect()),
//!         Column::numbers("angle [deg]", time.iter().map(|t| 20.0 * (0.006 * t).sin()).collect()),
//!     ],
//!     notes: Vec::new(),
//! };
//! let imported = import(&[log], &Recipe::default())?;
//! assert_eq!(imported.recording.units.input, "A");
//! assert_eq!(imported.recording.runs[0].duration_s(), 1.999);
//! # Ok::<(), import::ImportError>(())
//! ```

mod assemble;
mod clock;
mod controller;
mod counter;
mod error;
mod guess;
mod known;
mod log;
mod manifest;
mod rates;
mod read;
mod recipe;
mod runs;
mod sensor;
mod signal;
mod source;
mod start;
mod stretch;
mod ticks;
mod unit;

pub use assemble::{Imported, import};
pub use error::ImportError;
pub use known::{Kind, Known};
pub use log::{Cells, Column, Log};
pub use manifest::manifest;
pub use read::log as read_log;
pub use recipe::{PidLaw, Recipe, SwitchOn};
pub use unit::{Quantity, parse as parse_unit};
