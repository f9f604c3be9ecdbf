//! Fourth-order steps of a smooth flow.

#[inline]
fn offset<const N: usize>(x: &[f64; N], h: f64, k: &[f64; N]) -> [f64; N] {
    core::array::from_fn(|i| x[i] + h * k[i])
}

/// One classical Runge-Kutta step of length `h` from `x`, where the rate is `k1`. Returns the state at the end and the
/// rate of the last stage.
#[inline]
pub(super) fn rk4<const N: usize>(
    rate: impl Fn(f64, &[f64; N]) -> [f64; N],
    x: &[f64; N],
    k1: &[f64; N],
    h: f64,
) -> ([f64; N], [f64; N]) {
    let k2 = rate(0.5 * h, &offset(x, 0.5 * h, k1));
    let k3 = rate(0.5 * h, &offset(x, 0.5 * h, &k2));
    let k4 = rate(h, &offset(x, h, &k3));
    let end = core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    (end, k4)
}
