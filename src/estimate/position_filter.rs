//! Low-pass filter of the measured position. The settings choose its order.

use idsp::iir::Biquad;

use super::{biquad, low_pass};
use crate::settings::{EstimateSettings, FilterOrder};

/// The filter for samples every `tick_s`, as a section of [`biquad::SecondOrder`].
pub fn section(settings: &EstimateSettings, tick_s: f32) -> Biquad<f32> {
    match settings.order {
        FilterOrder::First => biquad::first_order(low_pass::gain(settings.cutoff_hz, tick_s)),
        FilterOrder::Second => biquad::butterworth(settings.cutoff_hz, tick_s),
    }
}
