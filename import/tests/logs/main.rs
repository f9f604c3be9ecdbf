//! Tests logs as other programs write them.

mod lab;
mod round_trip;
mod support;
mod text;
mod words;
