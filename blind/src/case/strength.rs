//! Adjusts the strength of the hidden effects until the gap has the wanted size.

use super::GAP_OVER_FLOOR;
use super::bench::{Bench, Measured};
use super::secret::Secret;
use crate::prediction::{self, HiddenStates};
use crate::reality::Reality;
use crate::scenario::{Plan, Scale};
use crate::truth::Reference;

/// Least gap of the hidden effects over the gap that the tolerances cause.
const OVER_TOLERANCES: f64 = 3.0;
/// Least gap that each effect of a pair causes by itself, over the floor.
const PAIR_SHARE_OVER_FLOOR: f64 = 3.0;
const ADJUSTMENTS: usize = 6;

/// Adjusts the strengths until the gap is about `wanted` floors. Returns `None` if it stays out of range.
pub(super) fn adjust_strengths(
    bench: &Bench,
    secrets: &mut [Secret],
    plans: &[Plan],
    scale: &Scale,
    wanted: f64,
) -> Option<(Reality, Measured)> {
    for _ in 0..ADJUSTMENTS {
        let mut reality = bench.plain();
        for secret in secrets.iter() {
            secret.apply(&mut reality, scale);
        }
        let Some(measured) = bench.measure(&reality, plans, scale) else {
            if secrets.is_empty() {
                return None;
            }
            secrets.iter_mut().for_each(|secret| {
                secret.scale_by(0.5);
            });
            continue;
        };
        if secrets.is_empty() {
            return Some((reality, measured));
        }
        let Reference {
            before,
            after,
            hidden_alone,
            tolerances_alone,
        } = measured.reference;
        let floors = hidden_alone / after;
        let in_range = |gap: f64| (GAP_OVER_FLOOR[0]..GAP_OVER_FLOOR[1]).contains(&(gap / after));
        if in_range(hidden_alone)
            && in_range(before)
            && hidden_alone > OVER_TOLERANCES * tolerances_alone
        {
            return Some((reality, measured));
        }
        let target = wanted
            .max(1.2 * OVER_TOLERANCES * tolerances_alone / after)
            .min(80.0);
        let factor = (target / floors).clamp(0.1, 10.0);
        let mut moved = false;
        for secret in secrets.iter_mut() {
            moved |= secret.scale_by(factor);
        }
        if !moved {
            return None;
        }
    }
    None
}

/// Puts the effect that contributes more to the gap first. Returns `None` if one of them contributes too little.
pub(super) fn order_pair(
    bench: &Bench,
    secrets: &mut [Secret],
    measured: &Measured,
    scale: &Scale,
) -> Option<()> {
    let without = |k: usize| {
        let mut reality = bench.plain();
        for (other, secret) in secrets.iter().enumerate() {
            if other != k {
                secret.apply(&mut reality, scale);
            }
        }
        let step_s = bench.prediction_step_s(&reality);
        let predicted = prediction::predict(
            &reality,
            &measured.logs,
            bench.restart,
            HiddenStates::Carried,
            step_s,
        );
        prediction::gap(&measured.logs, &predicted)
    };
    let [first, second] = [without(0), without(1)];
    if first.min(second) < PAIR_SHARE_OVER_FLOOR * measured.reference.after {
        return None;
    }
    if second > first {
        secrets.swap(0, 1);
    }
    Some(())
}
