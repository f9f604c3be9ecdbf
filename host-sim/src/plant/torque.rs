//! The torque that drives the joint over one step.

/// Torque on the joint over one step. It is held, or it relaxes behind a first-order lag to a target that may move at a
/// constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// Torque at the start of the step, N m.
    pub start_nm: f64,
    /// Target at the start of the step, N m.
    pub target_nm: f64,
    /// Rate of the target, N m/s.
    pub target_rate_nm_s: f64,
    /// Time constant of the lag, s; with 0 the torque is the target.
    pub lag_s: f64,
}

impl Torque {
    /// A constant torque.
    #[inline]
    pub fn held(torque_nm: f64) -> Self {
        Self {
            start_nm: torque_nm,
            target_nm: torque_nm,
            target_rate_nm_s: 0.0,
            lag_s: 0.0,
        }
    }

    /// A torque that relaxes from `start_nm` to a constant target.
    #[inline]
    pub fn relaxing(start_nm: f64, target_nm: f64, lag_s: f64) -> Self {
        Self {
            start_nm,
            target_nm,
            target_rate_nm_s: 0.0,
            lag_s,
        }
    }

    /// The sum with a constant torque, N m.
    #[inline]
    pub fn beside(&self, torque_nm: f64) -> Self {
        Self {
            start_nm: self.start_nm + torque_nm,
            target_nm: self.target_nm + torque_nm,
            ..*self
        }
    }

    /// The torque times `gain`.
    #[inline]
    pub fn scaled(&self, gain: f64) -> Self {
        Self {
            start_nm: gain * self.start_nm,
            target_nm: gain * self.target_nm,
            target_rate_nm_s: gain * self.target_rate_nm_s,
            lag_s: self.lag_s,
        }
    }

    /// This torque behind another lag, which starts at `start_nm`, over the next `t_s`. The torque in front of that lag
    /// is replaced by a straight line with the same rise and mean. `decay` is exp(−`t_s`/lag) of this torque's own lag.
    #[inline]
    pub fn behind(&self, start_nm: f64, lag_s: f64, t_s: f64, decay: f64) -> Self {
        if self.is_held() || t_s <= 0.0 {
            return Self::relaxing(start_nm, self.at(0.0), lag_s);
        }
        let (end_nm, mean_nm) = self.end_and_mean(t_s, decay);
        let rise_nm = end_nm - self.at(0.0);
        Self {
            start_nm,
            target_nm: mean_nm - 0.5 * rise_nm,
            target_rate_nm_s: rise_nm / t_s,
            lag_s,
        }
    }

    /// True if it does not change.
    #[inline]
    pub fn is_held(&self) -> bool {
        self.target_rate_nm_s == 0.0 && (self.lag_s == 0.0 || self.start_nm == self.target_nm)
    }

    /// The part that decays, at the start, N m: the distance from the target as it was one lag before.
    #[inline]
    fn transient_nm(&self) -> f64 {
        self.start_nm - self.target_nm + self.target_rate_nm_s * self.lag_s
    }

    /// The part that decays and the part that grows evenly, at the start, N m, and the rate of the latter, N m/s.
    #[inline]
    pub(super) fn parts(&self) -> (f64, f64, f64) {
        if self.is_held() {
            return (0.0, self.target_nm, 0.0);
        }
        let fading_nm = if self.lag_s > 0.0 {
            self.transient_nm()
        } else {
            0.0
        };
        (fading_nm, self.trailing_nm(0.0), self.target_rate_nm_s)
    }

    /// Torque `t_s` after the start of the step without its fading part, N m.
    #[inline]
    pub(super) fn trailing_nm(&self, t_s: f64) -> f64 {
        self.target_nm + self.target_rate_nm_s * (t_s - self.lag_s)
    }

    /// Torque `t_s` after the start of the step, N m.
    #[inline]
    pub fn at(&self, t_s: f64) -> f64 {
        if t_s == 0.0 && self.lag_s > 0.0 {
            self.start_nm
        } else if self.is_held() {
            self.target_nm
        } else if self.lag_s == 0.0 {
            self.trailing_nm(t_s)
        } else {
            self.trailing_nm(t_s) + self.transient_nm() * (-t_s / self.lag_s).exp()
        }
    }

    /// Torque at the end of the next `t_s` and its mean over them, N m. `decay` is exp(−`t_s`/lag).
    #[inline]
    pub fn end_and_mean(&self, t_s: f64, decay: f64) -> (f64, f64) {
        let left = self.transient_nm() * decay;
        let relaxed = self.transient_nm() - left;
        (
            self.trailing_nm(t_s) + left,
            self.trailing_nm(0.5 * t_s) + relaxed * self.lag_s / t_s,
        )
    }

    /// Mean over the next `t_s`, and the mean weighted by the time that is left, N m. The latter sets how far an
    /// inertia goes.
    #[inline]
    pub(super) fn means(&self, t_s: f64) -> [f64; 2] {
        if self.is_held() {
            return [self.target_nm; 2];
        }
        let (_, mean) = self.end_and_mean(t_s, (-t_s / self.lag_s).exp());
        // The transient adds to the way what it loses in the mean.
        let lost = self.transient_nm() - (mean - self.trailing_nm(0.5 * t_s));
        let early = self.trailing_nm(t_s / 3.0) + 2.0 * self.lag_s / t_s * lost;
        [mean, early]
    }

    /// Bounds of the torque within the next `t_s`, N m: those of start and target.
    #[inline]
    pub(super) fn bounds(&self, t_s: f64) -> [f64; 2] {
        let later = self.target_nm + self.target_rate_nm_s * t_s;
        let (low, high) = (self.target_nm.min(later), self.target_nm.max(later));
        if self.lag_s == 0.0 {
            return [low, high];
        }
        [low.min(self.start_nm), high.max(self.start_nm)]
    }

    /// The torque from `t_s` after the start on.
    #[inline]
    pub fn after(&self, t_s: f64) -> Self {
        Self {
            start_nm: self.at(t_s),
            target_nm: self.target_nm + self.target_rate_nm_s * t_s,
            ..*self
        }
    }

    /// The longest step that follows the relaxation, s: the error of a fourth-order step over half a time constant is
    /// 1e-5 of it.
    #[inline]
    pub(super) fn longest_step(&self) -> f64 {
        if !self.is_held() && self.lag_s > 0.0 {
            0.5 * self.lag_s
        } else {
            f64::INFINITY
        }
    }
}

/// The sum of successive pieces of torque over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Push {
    /// Duration of the step, s.
    pub(super) lasts_s: f64,
    /// The two means of [`Torque::means`], N m.
    pub(super) means_nm: [f64; 2],
    /// Bounds of the torque within the step, N m.
    pub(super) bounds_nm: [f64; 2],
}

impl Push {
    /// The sum with a constant torque, N m.
    pub(super) fn beside(&self, torque_nm: f64) -> Self {
        Self {
            lasts_s: self.lasts_s,
            means_nm: self.means_nm.map(|nm| nm + torque_nm),
            bounds_nm: self.bounds_nm.map(|nm| nm + torque_nm),
        }
    }

    /// The push times a `gain` that is not negative.
    #[inline(always)]
    pub(super) fn scaled(&self, gain: f64) -> Self {
        let scaled = |nm: [f64; 2]| nm.map(|nm| gain * nm);
        Self {
            lasts_s: self.lasts_s,
            means_nm: scaled(self.means_nm),
            bounds_nm: scaled(self.bounds_nm),
        }
    }
}

/// Successive pieces of torque, integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Impulse {
    pub(super) lasts_s: f64,
    /// Integral of the torque, N m s, and its second integral, N m s².
    pub(super) impulse_nms: f64,
    pub(super) way_nms2: f64,
    /// Bounds of the torque, N m.
    pub(super) bounds_nm: [f64; 2],
}

impl Impulse {
    /// The impulse of no piece.
    pub(super) const NONE: Self = Self {
        lasts_s: 0.0,
        impulse_nms: 0.0,
        way_nms2: 0.0,
        bounds_nm: [f64::INFINITY, f64::NEG_INFINITY],
    };

    /// The impulse of one piece that acts for `lasts_s`.
    #[inline]
    pub(super) fn of(torque: &Torque, lasts_s: f64) -> Self {
        if torque.is_held() {
            let held_nm = torque.target_nm;
            let impulse_nms = held_nm * lasts_s;
            return Self {
                lasts_s,
                impulse_nms,
                way_nms2: 0.5 * impulse_nms * lasts_s,
                bounds_nm: [held_nm; 2],
            };
        }
        Self::behind(torque, lasts_s, (-lasts_s / torque.lag_s).exp())
    }

    /// The impulse of one piece behind a lag. `decay` is exp(−`lasts_s`/lag).
    #[inline]
    pub(super) fn behind(torque: &Torque, lasts_s: f64, decay: f64) -> Self {
        let transient_nm = torque.transient_nm();
        let passed_s = torque.lag_s * (1.0 - decay);
        let trailing_nms = torque.trailing_nm(0.5 * lasts_s) * lasts_s;
        let trailing_nms2 = 0.5 * torque.trailing_nm(lasts_s / 3.0) * lasts_s * lasts_s;
        let bounds_nm = if torque.target_rate_nm_s == 0.0 {
            let end_nm = torque.target_nm + transient_nm * decay;
            [torque.start_nm.min(end_nm), torque.start_nm.max(end_nm)]
        } else {
            torque.bounds(lasts_s)
        };
        Self {
            lasts_s,
            impulse_nms: trailing_nms + transient_nm * passed_s,
            way_nms2: trailing_nms2 + transient_nm * torque.lag_s * (lasts_s - passed_s),
            bounds_nm,
        }
    }

    /// The impulse with a further piece at the end.
    #[inline]
    pub(super) fn then(&self, next: &Self) -> Self {
        let [low, high] = self.bounds_nm;
        Self {
            lasts_s: self.lasts_s + next.lasts_s,
            impulse_nms: self.impulse_nms + next.impulse_nms,
            // The earlier impulse moves the joint during the later piece, too.
            way_nms2: self.way_nms2 + self.impulse_nms * next.lasts_s + next.way_nms2,
            bounds_nm: [low.min(next.bounds_nm[0]), high.max(next.bounds_nm[1])],
        }
    }

    /// The sum of the pieces; zero if there is none.
    #[inline]
    pub(super) fn push(&self) -> Push {
        if self.lasts_s == 0.0 {
            return Push {
                lasts_s: 0.0,
                means_nm: [0.0; 2],
                bounds_nm: [0.0; 2],
            };
        }
        let per_s = self.lasts_s.recip();
        Push {
            lasts_s: self.lasts_s,
            means_nm: [
                self.impulse_nms * per_s,
                2.0 * self.way_nms2 * per_s * per_s,
            ],
            bounds_nm: self.bounds_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relaxation_to_a_moving_target_matches_its_equation() {
        let torque = Torque {
            start_nm: 0.3,
            target_nm: -0.1,
            target_rate_nm_s: 50.0,
            lag_s: 2e-3,
        };
        // τ T' = target − T, by small explicit steps; the mean by summing.
        let (dt, steps) = (1e-8, 300_000);
        let (mut t, mut sum, mut twice) = (torque.start_nm, 0.0, 0.0);
        for i in 0..steps {
            sum += t * dt;
            twice += sum * dt;
            t += dt / 2e-3 * (-0.1 + 50.0 * f64::from(i) * dt - t);
        }
        let (end, mean) = torque.end_and_mean(3e-3, (-1.5f64).exp());
        assert!((end - t).abs() < 1e-6 && (mean - sum / 3e-3).abs() < 1e-6);
        let [mean, early] = torque.means(3e-3);
        assert!((mean - sum / 3e-3).abs() < 1e-6 && (early - twice / 4.5e-6).abs() < 1e-6);
        let halves = torque.after(1e-3).after(2e-3);
        assert!((halves.start_nm - end).abs() < 1e-12);
    }

    #[test]
    fn a_push_of_pieces_equals_that_of_the_whole() {
        let torque = Torque::relaxing(0.3, -0.1, 2e-3);
        let parts = Impulse::of(&torque, 1e-3);
        let later = Impulse::behind(&torque.after(1e-3), 2e-3, (-1f64).exp());
        let parts = Impulse::NONE.then(&parts).then(&later).push();
        let whole = Impulse::of(&torque, 3e-3).push();
        let off = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        assert!((whole.lasts_s - parts.lasts_s).abs() < 1e-15);
        for (whole, parts) in [
            (torque.means(3e-3), parts.means_nm),
            (whole.means_nm, parts.means_nm),
            (whole.bounds_nm, parts.bounds_nm),
        ] {
            assert!(off(whole, parts) < 1e-12, "{whole:?} {parts:?}");
        }
        assert_eq!(whole.bounds_nm, [torque.at(3e-3), 0.3]);
    }
}
