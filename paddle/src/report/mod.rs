//! A diagnosis for people: in words, on a terminal, and as a page with plots.

mod effect;
#[cfg(test)]
mod example;
mod paragraph;
mod quantity;
mod region;
mod terminal;

pub use region::Labels;
pub use terminal::text;
