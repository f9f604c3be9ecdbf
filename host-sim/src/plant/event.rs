//! Steps of a smooth flow, cut short where its regime ends.

/// A smooth right-hand side that holds as long as its guard is positive.
pub(super) trait Flow<const N: usize> {
    /// Time derivative of the state `x`, `t` after the start of the step.
    fn rate(&self, t: f64, x: &[f64; N]) -> [f64; N];

    /// The state `t` after the start of the step, from the state and the rate at its start, and the approximate rate
    /// there.
    fn carried(&self, x: &[f64; N], rate: &[f64; N], t: f64) -> ([f64; N], [f64; N]);

    /// True if a cubic between the ends of a step of `h` follows it closely enough.
    fn is_nearly_cubic(&self, h: f64) -> bool;

    /// Positive while the regime lasts. It is evaluated `t` after the start of the step and is continuous through the
    /// end of the regime.
    fn guard(&self, t: f64, x: &[f64; N]) -> f64;

    /// True if the guard may fall below zero within a step although it is positive at the end. Judged from the states
    /// and rates at both ends.
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

/// Iterations with which bisection alone reaches any tolerance.
const LOCATE_ITERATIONS: usize = 60;
/// Number of iterations after which the bracket is bisected instead of cut by a secant.
const HALVED_EVERY: usize = 6;
/// Points at which the guard is sampled in a step that [may dip](Flow::may_dip).
const DIP_SAMPLES: usize = 8;

/// Steps by `h`, or to the first event before that.
///
/// An event is located to a share `tolerance` of the step: on a cubic if that is close enough, else by integrating to
/// trial instants. The returned state is the first one past the event. Without a tolerance the whole step is taken and
/// the guard is ignored.
#[inline]
pub(super) fn advance<const N: usize>(
    flow: &impl Flow<N>,
    x: &[f64; N],
    h: f64,
    tolerance: Option<f64>,
) -> Step<N> {
    let rate = flow.rate(0.0, x);
    let (end, end_rate) = flow.carried(x, &rate, h);
    if let Some(tolerance) = tolerance {
        let is_over = flow.guard(h, &end) < 0.0;
        if is_over || flow.may_dip(h, [x, &end], [&rate, &end_rate]) {
            let cubic = flow
                .is_nearly_cubic(h)
                .then(|| Cubic::new(h, [x, &end], [&rate, &end_rate]));
            let between = |t: f64| match &cubic {
                Some(cubic) => cubic.at(t),
                None => flow.carried(x, &rate, t).0,
            };
            if is_over {
                return cut_short(flow, x, between, (h, end), tolerance);
            }
            for i in 1..DIP_SAMPLES {
                let t = h * i as f64 / DIP_SAMPLES as f64;
                let x_t = between(t);
                if flow.guard(t, &x_t) < 0.0 {
                    return cut_short(flow, x, between, (t, x_t), tolerance);
                }
            }
        }
    }
    Step {
        taken: h,
        x: end,
        event: false,
    }
}

/// The cubic with the states and rates at both ends of a step.
struct Cubic<const N: usize> {
    /// Coefficients of the powers of time since the start, the constant first.
    coefficients: [[f64; N]; 4],
}

impl<const N: usize> Cubic<N> {
    fn new(h: f64, x: [&[f64; N]; 2], rate: [&[f64; N]; 2]) -> Self {
        let mean = |i: usize| (x[1][i] - x[0][i]) / h;
        let square = |i: usize| (3.0 * mean(i) - 2.0 * rate[0][i] - rate[1][i]) / h;
        let cube = |i: usize| (rate[0][i] + rate[1][i] - 2.0 * mean(i)) / (h * h);
        Self {
            coefficients: [
                *x[0],
                *rate[0],
                core::array::from_fn(square),
                core::array::from_fn(cube),
            ],
        }
    }

    fn at(&self, t: f64) -> [f64; N] {
        let [constant, slope, square, cube] = &self.coefficients;
        core::array::from_fn(|i| constant[i] + t * (slope[i] + t * (square[i] + t * cube[i])))
    }
}

/// An end of a bracket.
#[derive(PartialEq)]
enum End {
    Low,
    High,
}

/// The step to the first state past the regime's end. `past` is a later state past that end.
#[cold]
fn cut_short<const N: usize>(
    flow: &impl Flow<N>,
    x: &[f64; N],
    between: impl Fn(f64) -> [f64; N],
    (h, end): (f64, [f64; N]),
    tolerance: f64,
) -> Step<N> {
    let past = (flow.guard(h, &end), end);
    let guarded = |t: f64| {
        let x_t = between(t);
        (flow.guard(t, &x_t), x_t)
    };
    let (taken, x) = locate(guarded, flow.guard(0.0, x), (h, past), tolerance);
    Step {
        taken,
        x,
        event: true,
    }
}

/// An instant past which a guard is negative, up to one that is, with what comes with it, `past`, and to a share `tolerance`
/// of that or of the guard's fall, by the Illinois variant of regula falsi (Dowell and Jarratt, BIT 11, 1971) with bisection
/// where it stalls.
pub(super) fn locate<T>(
    guarded: impl Fn(f64) -> (f64, T),
    g_start: f64,
    past: (f64, (f64, T)),
    tolerance: f64,
) -> (f64, T) {
    let (h, (g_end, mut x_high)) = past;
    let (mut low, mut high) = (0.0, h);
    let g_start = g_start.max(0.0);
    // The search aims past the end by the tolerance, so that a slightly early result is past the end, too.
    let within = 0.5 * tolerance * (g_start - g_end);
    let (mut g_low, mut g_high) = (g_start + within, g_end + within);
    // The end that the last iteration moved, if any. The value of an end that stays twice is halved.
    let mut moved = None;
    for iteration in 1..=LOCATE_ITERATIONS {
        if high - low <= tolerance * h {
            break;
        }
        let secant = (low * g_high - high * g_low) / (g_high - g_low);
        let t = if iteration % HALVED_EVERY == 0 || !(secant > low && secant < high) {
            0.5 * (low + high)
        } else {
            secant
        };
        let (guard, x_t) = guarded(t);
        let g = guard + within;
        if g.abs() < within {
            (high, x_high) = (t, x_t);
            break;
        }
        if g > 0.0 {
            (low, g_low) = (t, g);
            if moved == Some(End::Low) {
                g_high *= 0.5;
            }
            moved = Some(End::Low);
        } else {
            (high, g_high, x_high) = (t, g, x_t);
            if moved == Some(End::High) {
                g_low *= 0.5;
            }
            moved = Some(End::High);
        }
    }
    (high, x_high)
}
