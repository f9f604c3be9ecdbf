//! Two columns of one position, sample by sample, and the difference between them.

mod disagreement;
mod pair;

pub(crate) use disagreement::{
    Disagreement, disagreement, less_mean, lowest, mean_square, read, residuals,
};
pub(crate) use pair::{Columns, Track, exchanged, is_live};
