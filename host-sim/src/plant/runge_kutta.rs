//! Fourth-order steps of a smooth flow, cut short where its regime ends.

/// A smooth right-hand side that holds as long as its guard is positive.
pub(super) trait Flow<const N: usize> {
    /// Time derivative of the state `x`, `t` after the start of the step.
    fn rate(&self, t: f64, x: &[f64; N]) -> [f64; N];

    /// Positive while the regime lasts, `t` after the start of the step; continuous through its end.
    fn guard(&self, t: f64, x: &[f64; N]) -> f64;

    /// True where the guard may dip below zero inside a step whose end shows nothing of it: judged
    /// from the states and rates at both ends.
    fn may_dip(&self, h: f64, x: [&[f64; N]; 2], rate: [&[f64; N]; 2]) -> bool;
}

/// Where a step ended.
pub(super) struct Step<const N: usize> {
    /// Time that was covered, s.
    pub taken: f64,
    /// State at its end.
    pub x: [f64; N],
    /// True if the regime ended there.
    pub event: bool,
}

#[inline]
fn offset<const N: usize>(x: &[f64; N], h: f64, k: &[f64; N]) -> [f64; N] {
    core::array::from_fn(|i| x[i] + h * k[i])
}

/// One classical Runge-Kutta step of length `h` from the rate `k1` at `x`; the state at the end and
/// the last stage's rate there.
#[inline]
fn rk4<const N: usize>(
    flow: &impl Flow<N>,
    x: &[f64; N],
    k1: &[f64; N],
    h: f64,
) -> ([f64; N], [f64; N]) {
    let k2 = flow.rate(0.5 * h, &offset(x, 0.5 * h, k1));
    let k3 = flow.rate(0.5 * h, &offset(x, 0.5 * h, &k2));
    let k4 = flow.rate(h, &offset(x, h, &k3));
    let end = core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    (end, k4)
}

/// How closely an event is located, as a share of the step.
const EVENT_TOLERANCE: f64 = 1e-13;
/// Enough for the bracketing below to reach the tolerance by bisection alone.
const LOCATE_ITERATIONS: usize = 60;
/// Points at which a step with a suspected dip is sampled.
const DIP_SAMPLES: usize = 8;

/// Steps by `h`, or to the first event if the guard ends before.
///
/// An event is located by re-integrating to trial instants, so that it is as exact as the step
/// itself; the state returned is the first one past it.
///
/// With `watch` false the step is taken whole, whatever the guard says.
#[inline]
pub(super) fn advance<const N: usize>(
    flow: &impl Flow<N>,
    x: &[f64; N],
    h: f64,
    watch: bool,
) -> Step<N> {
    let k1 = flow.rate(0.0, x);
    let (end, k4) = rk4(flow, x, &k1, h);
    if watch && flow.guard(h, &end) < 0.0 {
        return locate(flow, x, &k1, h);
    }
    if watch && flow.may_dip(h, [x, &end], [&k1, &k4]) {
        for i in 1..DIP_SAMPLES {
            let t = h * i as f64 / DIP_SAMPLES as f64;
            if flow.guard(t, &rk4(flow, x, &k1, t).0) < 0.0 {
                return locate(flow, x, &k1, t);
            }
        }
    }
    Step {
        taken: h,
        x: end,
        event: false,
    }
}

/// The first instant in (0, `h`] past which the guard is negative, by the Illinois variant of
/// regula falsi (Dowell and Jarratt, BIT 11, 1971) with bisection where it stalls.
#[cold]
fn locate<const N: usize>(flow: &impl Flow<N>, x: &[f64; N], k1: &[f64; N], h: f64) -> Step<N> {
    let at = |t: f64| rk4(flow, x, k1, t).0;
    let (mut low, mut high) = (0.0, h);
    let mut x_high = at(high);
    let (mut g_low, mut g_high) = (flow.guard(0.0, x).max(0.0), flow.guard(h, &x_high));
    for iteration in 0..LOCATE_ITERATIONS {
        if high - low <= EVENT_TOLERANCE * h {
            break;
        }
        let secant = (low * g_high - high * g_low) / (g_high - g_low);
        let t = if iteration % 4 == 3 || !(secant > low && secant < high) {
            0.5 * (low + high)
        } else {
            secant
        };
        let x_t = at(t);
        let g = flow.guard(t, &x_t);
        if g > 0.0 {
            (low, g_low) = (t, g);
            g_high *= 0.5;
        } else {
            (high, g_high, x_high) = (t, g, x_t);
            g_low *= 0.5;
        }
        if g == 0.0 {
            break;
        }
    }
    Step {
        taken: high,
        x: x_high,
        event: true,
    }
}
