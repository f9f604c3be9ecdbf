//! Tests of the format with folders on disk.

mod actuator;
mod bad_input;
mod folder;
mod oddities;
mod order;
mod own_numbers;
mod round_trip;
mod shared_data;
