//! Control core of a one-axis haptic paddle: measurement in, duty out.
#![no_std]
