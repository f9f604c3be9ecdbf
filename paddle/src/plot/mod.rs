//! Charts as SVG text in a common style.

mod axis;
mod bars;
mod figure;
mod ink;
mod scatter;
mod sheet;
mod step_response;
mod thin;

pub use axis::Scale;
pub use bars::{Bar, Bars};
pub use figure::{Band, Figure, Line, Panel};
pub use ink::Ink;
pub use scatter::{Cloud, Scatter};
pub use sheet::PlotError;
pub use step_response::step_response;
