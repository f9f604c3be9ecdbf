//! Two columns of one position: what they show of one motion, and by how much they differ.

mod disagreement;
mod pair;

pub(crate) use disagreement::{
    Disagreement, disagreement, less_mean, lowest, mean_square, read, residuals,
};
pub(crate) use pair::{Columns, Track, exchanged, is_live};
