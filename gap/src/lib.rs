//! Where a simulation and a device differ, which effect causes it, how far the gap shrinks.
