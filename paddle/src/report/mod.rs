//! Reports a diagnosis: in words, on a terminal, and as a page with plots.

mod bar;
mod charts;
mod effect;
#[cfg(test)]
mod example;
pub mod missing_torque;
mod number;
mod page;
mod paragraph;
mod predicted_run;
mod quantity;
mod region;
mod terminal;

pub use page::page;
pub use region::Labels;
pub use terminal::text;
