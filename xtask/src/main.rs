//! Chores of this repository: its tests and checks.

fn main() {}
