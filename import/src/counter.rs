//! Converts registers and counters to numbers: sign bits, two's complement, wrap-around.

/// Decodes a sign in bit `bit` of each word. The other bits are the magnitude. For example, 1 in bit 10 of an 11-bit word
/// means negative.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "words of a register"
)]
pub(crate) fn sign_magnitude(words: &mut [f64], bit: u32) {
    let sign = 1_i64 << bit.min(62);
    for word in words.iter_mut().filter(|word| !word.is_nan()) {
        let whole = word.round() as i64;
        if whole >= 0 {
            let size = (whole & (sign - 1)) as f64;
            *word = if whole & sign != 0 { -size } else { size };
        }
    }
}

/// Decodes words of `bits` bits as two's complement.
pub(crate) fn twos_complement(words: &mut [f64], bits: u32) {
    let span = 2f64.powi(bits.min(62).cast_signed());
    for word in words.iter_mut().filter(|word| **word >= span / 2.0) {
        *word -= span;
    }
}

/// Undoes wrap-around: adds multiples of `span` where this makes the step smaller. Returns the number of wraps.
pub(crate) fn unwrap(readings: &mut [f64], span: f64) -> usize {
    let mut turns = 0.0;
    let mut count = 0;
    let mut before: Option<f64> = None;
    for reading in readings.iter_mut().filter(|reading| !reading.is_nan()) {
        if let Some(before) = before {
            let jumps = ((*reading - before) / span).round();
            count += usize::from(jumps != 0.0);
            turns -= jumps;
        }
        before = Some(*reading);
        if turns != 0.0 {
            *reading += turns * span;
        }
    }
    count
}

/// Least jump of a wrap, as a share of the span.
const JUMP: f64 = 0.75;
/// Largest other step, as a share of the span.
const STEP: f64 = 0.25;

/// The first of `spans` at which the readings wrap: they jump by almost the whole span, otherwise have small steps, and stay
/// within the span.
pub(crate) fn wraps(readings: &[f64], spans: &[f64]) -> Option<f64> {
    let filled: Vec<f64> = readings
        .iter()
        .copied()
        .filter(|reading| !reading.is_nan())
        .collect();
    let (low, high) = filled
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
    spans.iter().copied().find(|span| {
        let mut steps = filled.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let (mut jumps, mut between) = (0, 0);
        for step in &mut steps {
            jumps += usize::from(step >= JUMP * span);
            between += usize::from(step > STEP * span && step < JUMP * span);
        }
        jumps > 0 && between == 0 && high - low <= 1.001 * span
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_a_sign_bit_are_decoded() {
        let mut load = [0.0, 100.0, 1124.0, 2047.0, f64::NAN];
        sign_magnitude(&mut load, 10);
        assert_eq!(load[..4], [0.0, 100.0, -100.0, -1023.0]);
        let mut word = [65_535.0, 1.0];
        twos_complement(&mut word, 16);
        assert_eq!(word, [-1.0, 1.0]);
    }

    #[test]
    fn a_wrapping_counter_is_distinguished_from_a_jumping_one() {
        let mut counts = [4090.0, 4095.0, 4.0, 9.0, 4.0, 4095.0];
        assert_eq!(wraps(&counts, &[360.0, 4096.0]), Some(4096.0));
        assert_eq!(unwrap(&mut counts, 4096.0), 2);
        assert_eq!(counts, [4090.0, 4095.0, 4100.0, 4105.0, 4100.0, 4095.0]);
        assert_eq!(wraps(&[0.0, 170.0, -170.0, 20.0], &[360.0]), None);
        assert_eq!(wraps(&[0.0, 1.0, 2.0], &[360.0]), None);
    }
}
