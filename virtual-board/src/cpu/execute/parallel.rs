//! Operations of the DSP extension on bytes and halfwords.

use super::super::arithmetic::{saturate_signed, saturate_unsigned};
use super::super::instruction::{LaneOp, Lanes, Reg};
use crate::cpu::Cpu;

impl Cpu {
    /// SEL.
    pub(super) fn select(&mut self, d: Reg, n: Reg, m: Reg) {
        let (n, m) = (self.get(n).to_le_bytes(), self.get(m).to_le_bytes());
        let ge = self.flags.ge;
        let bytes = [0, 1, 2, 3].map(|i| if ge >> i & 1 == 1 { n[i] } else { m[i] });
        self.set(d, u32::from_le_bytes(bytes));
    }

    /// USAD8 and USADA8.
    pub(super) fn sum_of_differences(&mut self, d: Reg, n: Reg, m: Reg, a: Option<Reg>) {
        let (n, m) = (self.get(n).to_le_bytes(), self.get(m).to_le_bytes());
        let sum: u32 = (0..4).map(|i| u32::from(n[i].abs_diff(m[i]))).sum();
        let addend = a.map_or(0, |a| self.get(a));
        self.set(d, addend.wrapping_add(sum));
    }

    /// Parallel addition and subtraction.
    pub(super) fn parallel(&mut self, parallel: LaneOp, lanes: Lanes, d: Reg, n: Reg, m: Reg) {
        let (n, m) = (self.get(n), self.get(m));
        // For each lane of `n`: the lane of `m`, and true if it is subtracted.
        let (width, plan): (u32, &[(u32, bool)]) = match parallel {
            LaneOp::Add8 => (8, &[(0, false), (1, false), (2, false), (3, false)]),
            LaneOp::Sub8 => (8, &[(0, true), (1, true), (2, true), (3, true)]),
            LaneOp::Add16 => (16, &[(0, false), (1, false)]),
            LaneOp::Sub16 => (16, &[(0, true), (1, true)]),
            LaneOp::AddSubExchange => (16, &[(1, true), (0, false)]),
            LaneOp::SubAddExchange => (16, &[(1, false), (0, true)]),
        };
        let mut result = 0;
        let mut ge = 0;
        for (lane, &(other, subtract)) in (0..).zip(plan) {
            let a = lane_of(n, lane, width, lanes);
            let b = lane_of(m, other, width, lanes);
            let exact = if subtract { a - b } else { a + b };
            let value = match lanes {
                Lanes::Signed | Lanes::Unsigned => exact as u32,
                Lanes::SignedHalving | Lanes::UnsignedHalving => (exact >> 1) as u32,
                Lanes::SignedSaturating => saturate_signed(exact.into(), width as u8).0 as u32,
                Lanes::UnsignedSaturating => saturate_unsigned(exact.into(), width as u8).0,
            };
            let mask = (1 << width) - 1;
            result |= (value & mask) << (lane * width);
            let at_least = match lanes {
                Lanes::Unsigned if !subtract => exact >> width != 0,
                _ => exact >= 0,
            };
            let lane_flags = if width == 8 { 1 } else { 3 };
            if at_least {
                ge |= lane_flags << (lane * width / 8);
            }
        }
        self.set(d, result);
        if matches!(lanes, Lanes::Signed | Lanes::Unsigned) {
            self.flags.ge = ge;
        }
    }
}

/// The value of one lane, sign or zero extended.
fn lane_of(value: u32, lane: u32, width: u32, lanes: Lanes) -> i32 {
    let top = value << (32 - width * (lane + 1));
    match lanes {
        Lanes::Signed | Lanes::SignedSaturating | Lanes::SignedHalving => {
            top as i32 >> (32 - width)
        }
        _ => (top >> (32 - width)) as i32,
    }
}
