//! The format as a user meets it: folders on disk.

mod actuator;
mod bad_input;
mod folder;
mod oddities;
mod order;
mod own_numbers;
mod round_trip;
mod shared_data;
