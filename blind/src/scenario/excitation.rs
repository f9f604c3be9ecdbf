//! Waveforms of the input or of the setpoint, of about unit amplitude.

use std::f64::consts::TAU;

use crate::draw::Draw;

/// A function of the time since the start of a run.
#[derive(Clone, Debug)]
pub(crate) enum Waveform {
    Sine {
        hz: f64,
    },
    /// Amplitude, frequency and phase of each sine.
    Multisine {
        parts: Vec<[f64; 3]>,
    },
    Chirp {
        from_hz: f64,
        to_hz: f64,
        over_s: f64,
    },
    /// A sequence of levels, each held for `hold_s`.
    Steps {
        levels: Vec<f64>,
        hold_s: f64,
    },
    /// A triangle wave whose height changes from period to period.
    Triangle {
        hz: f64,
        heights: Vec<f64>,
    },
    /// A sawtooth: a slow rise and a quick return.
    Ramp {
        period_s: f64,
        rise_share: f64,
    },
}

impl Waveform {
    /// Draws a waveform with its energy around `hz`. A `rich` one has more than one amplitude and frequency.
    pub fn draw(draw: &mut Draw, hz: f64, duration_s: f64, rich: bool) -> Self {
        let kinds: &[u8] = if rich {
            &[1, 1, 2, 3, 3, 4]
        } else {
            &[0, 1, 2, 3, 4, 5]
        };
        match draw.pick(kinds) {
            0 => Self::Sine { hz },
            1 => {
                let count = draw.count(3, 6);
                let mut parts: Vec<[f64; 3]> = (0..count)
                    .map(|_| {
                        let part_hz = hz * draw.log_uniform(0.35, 2.5);
                        [draw.uniform(0.4, 1.0), part_hz, draw.uniform(0.0, TAU)]
                    })
                    .collect();
                let whole: f64 = parts.iter().map(|part| part[0]).sum::<f64>() * 0.7;
                for part in &mut parts {
                    part[0] /= whole;
                }
                Self::Multisine { parts }
            }
            2 => {
                let (low, high) = (hz * draw.uniform(0.25, 0.6), hz * draw.uniform(1.5, 3.5));
                Self::Chirp {
                    from_hz: low,
                    to_hz: high,
                    over_s: duration_s,
                }
            }
            3 => {
                let levels = (0..draw.count(5, 12))
                    .map(|k| (if k % 2 == 0 { 1.0 } else { -1.0 }) * draw.uniform(0.25, 1.0))
                    .collect();
                Self::Steps {
                    levels,
                    hold_s: draw.uniform(0.35, 0.8) / hz,
                }
            }
            4 => {
                let heights = (0..draw.count(3, 6))
                    .map(|_| draw.uniform(0.3, 1.0))
                    .collect();
                Self::Triangle {
                    hz: hz * draw.uniform(0.5, 1.0),
                    heights,
                }
            }
            _ => Self::Ramp {
                period_s: draw.uniform(1.0, 2.0) / hz,
                rise_share: draw.uniform(0.6, 0.9),
            },
        }
    }

    /// The value at `time_s` after the start.
    pub fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Sine { hz } => (TAU * hz * time_s).cos(),
            Self::Multisine { parts } => parts
                .iter()
                .map(|[amplitude, hz, phase]| amplitude * (TAU * hz * time_s + phase).cos())
                .sum(),
            Self::Chirp {
                from_hz,
                to_hz,
                over_s,
            } => {
                let rate = (to_hz / from_hz).ln() / over_s;
                (TAU * from_hz * ((rate * time_s).exp() - 1.0) / rate).cos()
            }
            Self::Steps { levels, hold_s } => levels[(time_s / hold_s) as usize % levels.len()],
            Self::Triangle { hz, heights } => {
                let turns = hz * time_s;
                let phase = (turns + 0.25).fract();
                let height = heights[(turns + 0.25) as usize % heights.len()];
                height * (1.0 - 4.0 * (phase - 0.5).abs())
            }
            Self::Ramp {
                period_s,
                rise_share,
            } => {
                let phase = (time_s / period_s).fract();
                if phase < *rise_share {
                    2.0 * phase / rise_share - 1.0
                } else {
                    1.0 - 2.0 * (phase - rise_share) / (1.0 - rise_share)
                }
            }
        }
    }
}
