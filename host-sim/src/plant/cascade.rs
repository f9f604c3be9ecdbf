//! Torque behind two first-order lags, one after the other.

use super::Torque;
use super::torque::Impulse;

/// A torque that relaxes to a constant target through both lags: `T(t) = target + b e^(−t/τ₁) + c e^(−t/τ₂)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascade {
    /// Torque to which both lags relax, N m.
    pub target_nm: f64,
    /// Torque behind the first lag, N m.
    between_nm: f64,
    /// Torque behind both lags, N m.
    acting_nm: f64,
    lags_s: [f64; 2],
}

/// Smallest relative difference of the two lags. Equal lags have no partial fractions; the error of this shift is as
/// small.
const LEAST_APART: f64 = 1e-4;

impl Cascade {
    /// A constant torque, N m, behind two lags, s. The second lag is not zero.
    pub fn at_rest(torque_nm: f64, [first_s, second_s]: [f64; 2]) -> Self {
        let apart_s = LEAST_APART * second_s;
        let is_apart = (first_s - second_s).abs() >= apart_s;
        let first_s = if is_apart {
            first_s
        } else {
            second_s + apart_s
        };
        Self {
            target_nm: torque_nm,
            between_nm: torque_nm,
            acting_nm: torque_nm,
            lags_s: [first_s, second_s],
        }
    }

    /// Time constants, s.
    #[inline]
    pub fn lags_s(&self) -> [f64; 2] {
        self.lags_s
    }

    /// The coefficients b and c, N m.
    #[inline]
    fn transients_nm(&self) -> [f64; 2] {
        let [first_s, second_s] = self.lags_s;
        let first_nm = (self.between_nm - self.target_nm) * first_s / (first_s - second_s);
        [first_nm, self.acting_nm - self.target_nm - first_nm]
    }

    /// The cascade after a time over which the transient of each lag decays to the given share.
    #[inline]
    pub fn after(&self, decays: [f64; 2]) -> Self {
        let [first_nm, second_nm] = self.transients_nm();
        Self {
            between_nm: self.target_nm + (self.between_nm - self.target_nm) * decays[0],
            acting_nm: self.target_nm + first_nm * decays[0] + second_nm * decays[1],
            ..*self
        }
    }

    /// The impulse over `lasts_s`, over which the transient of each lag decays to the given share.
    #[inline]
    pub(super) fn impulse(&self, lasts_s: f64, decays: [f64; 2]) -> Impulse {
        let transients_nm = self.transients_nm();
        let mut impulse_nms = self.target_nm * lasts_s;
        let mut way_nms2 = 0.5 * impulse_nms * lasts_s;
        for i in 0..2 {
            let passed_s = self.lags_s[i] * (1.0 - decays[i]);
            impulse_nms += transients_nm[i] * passed_s;
            way_nms2 += transients_nm[i] * self.lags_s[i] * (lasts_s - passed_s);
        }
        let end = self.after(decays);
        let [now_nm, then_nm] = [self.acting_nm, end.acting_nm];
        let mut bounds_nm = [now_nm.min(then_nm), now_nm.max(then_nm)];
        // The torque turns where it equals the one between the lags.
        if (self.between_nm - now_nm) * (end.between_nm - then_nm) < 0.0 {
            let [low, high] = &mut bounds_nm;
            *low = low.min(self.between_nm).min(end.between_nm);
            *high = high.max(self.between_nm).max(end.between_nm);
        }
        Impulse {
            lasts_s,
            impulse_nms,
            way_nms2,
            bounds_nm,
        }
    }

    /// The cascade as a single lag over `lasts_s`. The torque between the lags is replaced by a straight line with the
    /// same rise and mean.
    #[inline]
    pub(super) fn torque(&self, lasts_s: f64, decays: [f64; 2]) -> Torque {
        let [first_s, second_s] = self.lags_s;
        let between = Torque::relaxing(self.between_nm, self.target_nm, first_s);
        between.behind(self.acting_nm, second_s, lasts_s, decays[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decays(lags_s: [f64; 2], t_s: f64) -> [f64; 2] {
        lags_s.map(|lag_s| (-t_s / lag_s).exp())
    }

    #[test]
    fn the_cascade_matches_its_differential_equations() {
        for lags_s in [[2e-3, 5e-3], [5e-3, 2e-3], [3e-3, 3e-3], [0.0, 2e-3]] {
            let mut cascade = Cascade::at_rest(0.1, lags_s);
            (cascade.target_nm, cascade.between_nm) = (-0.3, 0.4);
            // τ₁ u' = target − u and τ₂ T' = u − T by small explicit steps; the first and the second integral of T by
            // sums.
            let (dt, lasts_s) = (1e-8, 4e-3);
            let [mut u, mut t, mut sum, mut twice] = [0.4, 0.1, 0.0, 0.0];
            let (mut low, mut high) = (t, t);
            for _ in 0..400_000 {
                u = if lags_s[0] == 0.0 {
                    -0.3
                } else {
                    u + dt / lags_s[0] * (-0.3 - u)
                };
                t += dt / lags_s[1] * (u - t);
                sum += t * dt;
                twice += sum * dt;
                (low, high) = (low.min(t), high.max(t));
            }
            let decays = decays(cascade.lags_s(), lasts_s);
            let end = cascade.after(decays);
            assert!((end.acting_nm - t).abs() < 1e-4, "{lags_s:?}");
            assert!((end.between_nm - u).abs() < 1e-4, "{lags_s:?}");
            let impulse = cascade.impulse(lasts_s, decays);
            assert!((impulse.impulse_nms - sum).abs() < 1e-4 * lasts_s);
            assert!((impulse.way_nms2 - twice).abs() < 1e-4 * lasts_s * lasts_s);
            assert!(impulse.bounds_nm[0] <= low + 1e-6 && impulse.bounds_nm[1] >= high - 1e-6);
        }
    }

    #[test]
    fn over_a_short_time_the_cascade_equals_a_single_lag() {
        let mut cascade = Cascade::at_rest(0.1, [2e-3, 5e-3]);
        (cascade.target_nm, cascade.between_nm) = (-0.3, 0.4);
        let lasts_s = 4e-4;
        let decays = decays(cascade.lags_s(), lasts_s);
        let torque = cascade.torque(lasts_s, decays);
        let [mean_nm, early_nm] = torque.means(lasts_s);
        let whole = cascade.impulse(lasts_s, decays);
        assert!((mean_nm * lasts_s - whole.impulse_nms).abs() < 1e-3 * lasts_s * 0.1);
        assert!((0.5 * early_nm * lasts_s * lasts_s / whole.way_nms2 - 1.0).abs() < 1e-3);
        assert!((torque.at(lasts_s) - cascade.after(decays).acting_nm).abs() < 1e-3);
    }
}
