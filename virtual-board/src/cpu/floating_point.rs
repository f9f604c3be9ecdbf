//! Arithmetic of the FPU (FPv4-SP): IEEE 754 single precision with the flags, rounding modes, default NaN and flush-to-zero
//! of FPSCR.
//!
//! Each operation computes its exact result as a double plus the sign of the remainder, and rounds it once.

/// FPSCR, the status and control register.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Fpscr(u32);

const INVALID_OPERATION: u32 = 1 << 0;
const DIVIDE_BY_ZERO: u32 = 1 << 1;
const OVERFLOW: u32 = 1 << 2;
const UNDERFLOW: u32 = 1 << 3;
const INEXACT: u32 = 1 << 4;
const INPUT_DENORMAL: u32 = 1 << 7;
const ROUNDING: u32 = 3 << 22;
const FLUSH_TO_ZERO: u32 = 1 << 24;
const DEFAULT_NAN: u32 = 1 << 25;
const ALTERNATIVE_HALF: u32 = 1 << 26;
const CONTROLS: u32 = ROUNDING | FLUSH_TO_ZERO | DEFAULT_NAN | ALTERNATIVE_HALF;
const FLAGS: u32 = 15 << 28;

const SIGN: u32 = 1 << 31;
const LEAST_NORMAL: u32 = 0x0080_0000;
const INFINITY: u32 = 0x7F80_0000;
const QUIET: u32 = 1 << 22;
const THE_DEFAULT_NAN: u32 = 0x7FC0_0000;

/// The rounding mode, field RMode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rounding {
    Nearest,
    Up,
    Down,
    Zero,
}

/// A floating-point format as the target of rounding.
struct Format {
    fraction_bits: u32,
    bias: i32,
}

const SINGLE: Format = Format {
    fraction_bits: 23,
    bias: 127,
};
const HALF: Format = Format {
    fraction_bits: 10,
    bias: 15,
};

impl Fpscr {
    /// The register after `value` is written to it. Reserved bits are ignored.
    pub fn new(value: u32) -> Self {
        const EXCEPTIONS: u32 =
            INVALID_OPERATION | DIVIDE_BY_ZERO | OVERFLOW | UNDERFLOW | INEXACT | INPUT_DENORMAL;
        Self(value & (FLAGS | CONTROLS | EXCEPTIONS))
    }

    /// The value that VMRS reads.
    pub fn bits(self) -> u32 {
        self.0
    }

    /// The register with the control bits of FPDSCR and no flags.
    pub fn from_defaults(fpdscr: u32) -> Self {
        Self(fpdscr & CONTROLS)
    }

    fn rounding(self) -> Rounding {
        match (self.0 & ROUNDING) >> 22 {
            0 => Rounding::Nearest,
            1 => Rounding::Up,
            2 => Rounding::Down,
            _ => Rounding::Zero,
        }
    }

    /// Returns the bits of `result`, computed by the host, if the FPU gives the same and changes no flag. This holds for a
    /// normal number in the default modes if the inexact flag is already set.
    #[inline]
    fn plain(self, result: f32) -> Option<u32> {
        let bits = result.to_bits();
        // The smallest normal number is excluded: it may have been smaller before rounding, which is an underflow.
        let normal = bits & !SIGN > LEAST_NORMAL && bits & !SIGN < INFINITY;
        (self.0 & (CONTROLS | INEXACT) == INEXACT && normal).then_some(bits)
    }

    /// FPAdd.
    #[inline]
    pub fn add(&mut self, a: u32, b: u32) -> u32 {
        self.plain(f32::from_bits(a) + f32::from_bits(b))
            .unwrap_or_else(|| self.sum(a, b, 0))
    }

    /// FPSub.
    #[inline]
    pub fn sub(&mut self, a: u32, b: u32) -> u32 {
        self.plain(f32::from_bits(a) - f32::from_bits(b))
            .unwrap_or_else(|| self.sum(a, b, SIGN))
    }

    /// FPMul.
    #[inline]
    pub fn mul(&mut self, a: u32, b: u32) -> u32 {
        self.plain(f32::from_bits(a) * f32::from_bits(b))
            .unwrap_or_else(|| self.product(a, b))
    }

    /// FPDiv.
    #[inline]
    pub fn div(&mut self, a: u32, b: u32) -> u32 {
        self.plain(f32::from_bits(a) / f32::from_bits(b))
            .unwrap_or_else(|| self.quotient(a, b))
    }

    /// FPSqrt.
    pub fn sqrt(&mut self, a: u32) -> u32 {
        let a = self.unpack(a);
        if let Some(nan) = self.propagate(&[a]) {
            return nan;
        }
        if a == INFINITY || a & !SIGN == 0 {
            return a;
        }
        if a & SIGN != 0 {
            return self.invalid();
        }
        let a = double(a);
        let root = a.sqrt();
        self.round(root, (-root).mul_add(root, a))
    }

    #[cold]
    fn sum(&mut self, a: u32, b: u32, flip: u32) -> u32 {
        let (a, b) = (self.unpack(a), self.unpack(b));
        if let Some(nan) = self.propagate(&[a, b]) {
            return nan;
        }
        self.add_exact(double(a), double(b ^ flip))
    }

    /// Sum of two doubles that are not NaN.
    fn add_exact(&mut self, a: f64, b: f64) -> u32 {
        if a.is_infinite() || b.is_infinite() {
            let sum = a + b;
            return if sum.is_nan() {
                self.invalid()
            } else {
                (sum as f32).to_bits()
            };
        }
        let sum = a + b;
        if sum == 0.0 {
            let negative = if a.is_sign_negative() == b.is_sign_negative() {
                a.is_sign_negative()
            } else {
                self.rounding() == Rounding::Down
            };
            return if negative { SIGN } else { 0 };
        }
        let of_b = sum - a;
        self.round(sum, (a - (sum - of_b)) + (b - of_b))
    }

    #[cold]
    fn product(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.unpack(a), self.unpack(b));
        if let Some(nan) = self.propagate(&[a, b]) {
            return nan;
        }
        let product = double(a) * double(b);
        if product.is_nan() {
            self.invalid()
        } else {
            self.round(product, 0.0)
        }
    }

    #[cold]
    fn quotient(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.unpack(a), self.unpack(b));
        if let Some(nan) = self.propagate(&[a, b]) {
            return nan;
        }
        let (a, b) = (double(a), double(b));
        let quotient = a / b;
        if quotient.is_nan() {
            return self.invalid();
        }
        if b == 0.0 && a.is_finite() {
            self.0 |= DIVIDE_BY_ZERO;
        }
        let left = if quotient.is_finite() && b.is_finite() {
            (-quotient).mul_add(b, a) * b.signum()
        } else {
            0.0
        };
        self.round(quotient, left)
    }

    /// FPMulAdd: `addend + n * m`, rounded once.
    pub fn fused(&mut self, addend: u32, n: u32, m: u32) -> u32 {
        let (addend, n, m) = (self.unpack(addend), self.unpack(n), self.unpack(m));
        let product = double(n) * double(m);
        let product_is_invalid = product.is_nan() && !is_nan(n) && !is_nan(m);
        if product_is_invalid && is_nan(addend) && addend & QUIET != 0 {
            return self.invalid();
        }
        if let Some(nan) = self.propagate(&[addend, n, m]) {
            return nan;
        }
        if product_is_invalid {
            return self.invalid();
        }
        self.add_exact(double(addend), product)
    }

    /// FPCompare: sets the four flags of FPSCR.
    pub fn compare(&mut self, a: u32, b: u32, quiet_is_invalid: bool) {
        let (a, b) = (self.unpack(a), self.unpack(b));
        let signalling = |x| is_nan(x) && x & QUIET == 0;
        let unordered = is_nan(a) || is_nan(b);
        if signalling(a) || signalling(b) || (quiet_is_invalid && unordered) {
            self.0 |= INVALID_OPERATION;
        }
        let flags = match f32::from_bits(a).partial_cmp(&f32::from_bits(b)) {
            None => 0b0011,
            Some(std::cmp::Ordering::Equal) => 0b0110,
            Some(std::cmp::Ordering::Less) => 0b1000,
            Some(std::cmp::Ordering::Greater) => 0b0010,
        };
        self.0 = self.0 & !FLAGS | flags << 28;
    }

    /// FPToFixed: converts to a fixed-point number of `bits` bits with `fraction` fractional bits, sign or zero extended.
    pub fn float_to_fixed(
        &mut self,
        a: u32,
        signed: bool,
        bits: u8,
        fraction: u8,
        to_zero: bool,
    ) -> u32 {
        let a = self.unpack(a);
        if is_nan(a) {
            self.0 |= INVALID_OPERATION;
            return 0;
        }
        let exact = double(a) * 2f64.powi(fraction.into());
        let rounding = if to_zero {
            Rounding::Zero
        } else {
            self.rounding()
        };
        let rounded = match rounding {
            Rounding::Nearest => exact.round_ties_even(),
            Rounding::Up => exact.ceil(),
            Rounding::Down => exact.floor(),
            Rounding::Zero => exact.trunc(),
        };
        let span = 1_i64 << bits;
        let (least, most) = if signed {
            (-span / 2, span / 2 - 1)
        } else {
            (0, span - 1)
        };
        let value = (rounded as i64).clamp(least, most);
        if value as f64 != rounded {
            self.0 |= INVALID_OPERATION;
        } else if rounded != exact {
            self.0 |= INEXACT;
        }
        value as u32
    }

    /// FixedToFP: converts a fixed-point number of `bits` bits with `fraction` fractional bits.
    pub fn fixed_to_float(
        &mut self,
        value: u32,
        signed: bool,
        bits: u8,
        fraction: u8,
        to_nearest: bool,
    ) -> u32 {
        let unused = 32 - u32::from(bits);
        let value = if signed {
            f64::from((value << unused) as i32 >> unused)
        } else {
            f64::from(value << unused >> unused)
        };
        let rounding = if to_nearest {
            Rounding::Nearest
        } else {
            self.rounding()
        };
        let exact = value / 2f64.powi(fraction.into());
        self.round_to(&SINGLE, rounding, exact, 0.0)
    }

    /// FPHalfToSingle.
    pub fn half_to_single(&mut self, half: u16) -> u32 {
        let sign = u32::from(half >> 15) << 31;
        let fraction = u32::from(half & 0x3FF);
        match (half >> 10) & 31 {
            31 if self.0 & ALTERNATIVE_HALF == 0 => {
                let single = sign | INFINITY | fraction << 13;
                self.propagate(&[single]).unwrap_or(single)
            }
            0 => sign | (fraction as f32 / (1 << 24) as f32).to_bits(),
            exponent => sign | (u32::from(exponent) + 127 - 15) << 23 | fraction << 13,
        }
    }

    /// FPSingleToHalf.
    pub fn single_to_half(&mut self, a: u32) -> u16 {
        let a = self.unpack(a);
        let alternative = self.0 & ALTERNATIVE_HALF != 0;
        let sign = a & SIGN;
        if is_nan(a) && alternative {
            self.0 |= INVALID_OPERATION;
            return (sign >> 16) as u16;
        }
        if let Some(nan) = self.propagate(&[a]) {
            return (nan >> 16 & 0x8000 | 0x7E00 | nan >> 13 & 0x1FF) as u16;
        }
        if a & !SIGN == INFINITY && alternative {
            self.0 |= INVALID_OPERATION;
            return (sign >> 16) as u16 | 0x7FFF;
        }
        self.round_to(&HALF, self.rounding(), double(a), 0.0) as u16
    }

    /// The part of FPUnpack that changes a number: flushes a denormal number to zero if FZ is set.
    fn unpack(&mut self, a: u32) -> u32 {
        let denormal = a & INFINITY == 0 && a & !SIGN != 0;
        if denormal && self.0 & FLUSH_TO_ZERO != 0 {
            self.0 |= INPUT_DENORMAL;
            a & SIGN
        } else {
            a
        }
    }

    /// FPProcessNaNs: the resulting NaN, if an operand is one.
    fn propagate(&mut self, operands: &[u32]) -> Option<u32> {
        let signalling = operands.iter().find(|&&x| is_nan(x) && x & QUIET == 0);
        if signalling.is_some() {
            self.0 |= INVALID_OPERATION;
        }
        let nan = signalling.or_else(|| operands.iter().find(|&&x| is_nan(x)))?;
        Some(if self.0 & DEFAULT_NAN != 0 {
            THE_DEFAULT_NAN
        } else {
            nan | QUIET
        })
    }

    fn invalid(&mut self) -> u32 {
        self.0 |= INVALID_OPERATION;
        THE_DEFAULT_NAN
    }

    fn round(&mut self, value: f64, left: f64) -> u32 {
        self.round_to(&SINGLE, self.rounding(), value, left)
    }

    /// FPRound of `value` plus a remainder of the sign of `left`, smaller than half its last bit.
    fn round_to(&mut self, format: &Format, rounding: Rounding, value: f64, left: f64) -> u32 {
        let width = format.fraction_bits;
        let largest_exponent = 2 * format.bias as u32 + 1;
        let negative = value.is_sign_negative();
        let sign = u32::from(negative) << (31 - if width == 23 { 0 } else { 16 });
        if value == 0.0 {
            return sign;
        }
        if value.is_infinite() {
            return sign | largest_exponent << width;
        }
        let bits = value.to_bits();
        let mut exponent = (bits >> 52 & 0x7FF) as i32 - 1023;
        // The significand with three additional bits for the remainder.
        let mut significand = (bits & ((1 << 52) - 1) | 1 << 52) << 3;
        if left != 0.0 {
            if (left < 0.0) == negative {
                significand += 1;
            } else {
                significand -= 1;
            }
        }
        if significand < 1 << 55 {
            significand <<= 1;
            exponent -= 1;
        }
        let least = 1 - format.bias;
        let tiny = exponent < least;
        if tiny && width == 23 && self.0 & FLUSH_TO_ZERO != 0 {
            self.0 |= UNDERFLOW;
            return sign;
        }
        let dropped = (55 - width) as i32 + if tiny { least - exponent } else { 0 };
        let dropped = dropped.min(60) as u32;
        let rest = significand & ((1 << dropped) - 1);
        let half = 1 << (dropped - 1);
        let kept = (significand >> dropped) as u32;
        let up = match rounding {
            Rounding::Nearest => rest > half || rest == half && kept & 1 == 1,
            Rounding::Up => rest != 0 && !negative,
            Rounding::Down => rest != 0 && negative,
            Rounding::Zero => false,
        };
        let kept = kept + u32::from(up);
        // The leading one of a normal significand adds one to the exponent. So does a carry out of it.
        let exponent = if tiny { 0 } else { exponent - least };
        let magnitude = ((exponent as u32) << width) + kept;
        let alternative = width == 10 && self.0 & ALTERNATIVE_HALF != 0;
        let infinity = (largest_exponent + u32::from(alternative)) << width;
        if magnitude < infinity {
            if rest != 0 {
                self.0 |= INEXACT | if tiny { UNDERFLOW } else { 0 };
            }
            return sign | magnitude;
        }
        if alternative {
            self.0 |= INVALID_OPERATION;
            return sign | (infinity - 1);
        }
        self.0 |= OVERFLOW | INEXACT;
        let to_infinity = match rounding {
            Rounding::Nearest => true,
            Rounding::Up => !negative,
            Rounding::Down => negative,
            Rounding::Zero => false,
        };
        sign | (infinity - u32::from(!to_infinity))
    }
}

fn is_nan(a: u32) -> bool {
    a & !SIGN > INFINITY
}

fn double(a: u32) -> f64 {
    f64::from(f32::from_bits(a))
}
