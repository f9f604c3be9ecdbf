//! Command line of the haptic paddle: simulate, measure the gap, diagnose it.

fn main() {}
