//! Low-passes of the first and the second order as a second-order section.

use core::f32::consts::{PI, SQRT_2};

use dsp_process::SplitProcess;
use idsp::iir::{Biquad, DirectForm2Transposed};

use crate::scalar::flushed;

/// A cutoff above this share of the sampling rate is lowered to it.
const MAX_CUTOFF_RATIO: f32 = 0.45;

/// A second-order section with its state.
#[derive(Clone, Debug)]
pub struct SecondOrder {
    section: Biquad<f32>,
    state: DirectForm2Transposed<f32>,
}

/// The low-pass `y += gain (x - y)` of the first order, see [`super::low_pass`].
pub fn first_order(gain: f32) -> Biquad<f32> {
    Biquad::from([[gain, 0.0, 0.0], [1.0, gain - 1.0, 0.0]])
}

/// Butterworth section by the bilinear transform, exact at the cutoff; it passes everything for a cutoff of 0.
///
/// With K = tan(pi f T): `b = K^2 [1, 2, 1] / d`, `d = 1 + sqrt(2) K + K^2`
/// (Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.2).
pub fn butterworth(cutoff_hz: f32, tick_s: f32) -> Biquad<f32> {
    if cutoff_hz <= 0.0 {
        return Biquad::IDENTITY;
    }
    let k = tan(PI * (cutoff_hz * tick_s).min(MAX_CUTOFF_RATIO));
    let k2 = k * k;
    Biquad::from([
        [k2, 2.0 * k2, k2],
        [
            1.0 + SQRT_2 * k + k2,
            2.0 * (k2 - 1.0),
            1.0 - SQRT_2 * k + k2,
        ],
    ])
}

/// Tangent by Lambert's continued fraction; good to 1e-3 at 0.45 pi and to rounding below 1.
fn tan(x: f32) -> f32 {
    let x2 = x * x;
    x * (945.0 - x2 * (105.0 - x2)) / (945.0 - x2 * (420.0 - 15.0 * x2))
}

impl SecondOrder {
    /// A section at rest at 0.
    pub fn new(section: Biquad<f32>) -> Self {
        Self {
            section,
            state: DirectForm2Transposed::default(),
        }
    }

    /// Takes over a section; it is at rest at `value`.
    pub fn retune(&mut self, section: Biquad<f32>, value: f32) {
        self.section = section;
        self.reset(value);
    }

    /// Puts the section at rest at `value`.
    pub fn reset(&mut self, value: f32) {
        let [b0, _, b2, _, a2] = self.section.ba;
        self.state.x = [value * (1.0 - b0), value * (b2 + a2)];
    }

    /// Takes one sample and gives the filtered one.
    #[inline]
    pub fn update(&mut self, input: f32) -> f32 {
        let output = self.section.process(&mut self.state, input);
        // The other state decays with this one.
        self.state.x[0] = flushed(self.state.x[0]);
        output
    }
}
