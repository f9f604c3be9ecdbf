//! First-order and second-order low-pass filters as second-order sections.

use core::f32::consts::{PI, SQRT_2};

use dsp_process::SplitProcess;
use idsp::iir::{Biquad, DirectForm2Transposed};

use crate::scalar::flushed;

/// Largest ratio of cutoff to sampling rate. Higher cutoffs are lowered to it.
const MAX_CUTOFF_RATIO: f32 = 0.45;

/// A second-order section with its state.
#[derive(Clone, Debug)]
pub struct SecondOrder {
    section: Biquad<f32>,
    state: DirectForm2Transposed<f32>,
}

/// The first-order low-pass `y += gain (x - y)`, see [`super::low_pass`].
pub fn first_order(gain: f32) -> Biquad<f32> {
    Biquad::from([[gain, 0.0, 0.0], [1.0, gain - 1.0, 0.0]])
}

/// Butterworth section by the bilinear transform, exact at the cutoff. A cutoff of 0 gives no filtering.
///
/// With K = tan(pi f T): `b = K^2 [1, 2, 1] / d`, `d = 1 + sqrt(2) K + K^2` (Oppenheim and Schafer, Discrete-Time Signal
/// Processing, section 7.2).
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

/// Tangent by Lambert's continued fraction. The error is 1e-3 at 0.45 pi, and rounding only below 1.
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

    /// Changes the section and sets it to rest at `value`.
    pub fn retune(&mut self, section: Biquad<f32>, value: f32) {
        self.section = section;
        self.reset(value);
    }

    /// Sets the section to rest at `value`.
    pub fn reset(&mut self, value: f32) {
        let [b0, _, b2, _, a2] = self.section.ba;
        self.state.x = [value * (1.0 - b0), value * (b2 + a2)];
    }

    /// Filters one sample.
    #[inline]
    pub fn update(&mut self, input: f32) -> f32 {
        let output = self.section.process(&mut self.state, input);
        // The output state decays together with the input state.
        self.state.x[0] = flushed(self.state.x[0]);
        output
    }
}
