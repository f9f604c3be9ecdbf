//! User settings.
//!
//! ```text
//! tree         every setting, defined once: name, unit, range, default, what it does
//! definition   the language of that definition
//! choice       settings that are one of some names
//! field        one setting: how it is found, read, written and shown
//! page         the list of them all, for people
//! record       all of them as bytes
//! store        the bytes in flash
//! ```

mod choice;
#[macro_use]
mod definition;
mod field;
mod page;
mod record;
mod store;
mod tree;

pub use choice::{Choice, CurrentSampling, DerivativeSource, FilterOrder, Sensor, VelocitySource};
pub use field::{Field, FieldSet, Group, Kind, SettingError, Shown};
pub use page::Page;
pub use record::Recalled;
pub use store::{Store, StoreError};
pub use tree::{
    CompensationSettings, EstimateSettings, FIELDS, GROUPS, HallSettings, HostSettings,
    LimitSettings, MechanismSettings, MetricsSettings, MotorSettings, PidSettings, Settings,
};
