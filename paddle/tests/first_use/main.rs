//! Tests of typical first uses: paths that cannot be written, invalid input, messages, and an interruption by Ctrl-C.

mod ended_board;
mod nonsense;
mod places;
mod support;
mod words;
