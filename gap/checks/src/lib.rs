//! Benches of the diagnosis, in a package of their own: `cargo run -p gap --example linear_axis` compiles what the
//! package `gap` needs for its tests, and a library for benches takes minutes.
