//! What a first use meets: places that cannot be written, nonsense, words, and an end by Ctrl-C.

mod ended_board;
mod nonsense;
mod places;
mod support;
mod words;
