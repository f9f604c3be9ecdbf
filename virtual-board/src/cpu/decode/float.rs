//! The coprocessor space: FPU instructions, and those of coprocessors that do not exist.

use super::{aligned_pc, bit, bits, small};
use crate::cpu::instruction::Instruction::{self, *};
use crate::cpu::instruction::{FloatOp, PC, SP, UnaryOp};

pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    if bits(second, 11, 9) != 0b101 {
        return NoCoprocessor;
    }
    if bit(first, 12) {
        return Undefined;
    }
    match (bits(first, 11, 8), bit(second, 4)) {
        (0b1110, false) => arithmetic(first, second),
        (0b1110, true) => transfer(first, second),
        _ if bits(first, 11, 5) == 0b110_0010 => transfer_pair(first, second),
        (0b1100 | 0b1101, _) => load_store(address, first, second),
        _ => Undefined,
    }
}

/// Number of the single-precision register. Its lowest bit is encoded separately.
const fn single(high: u8, low: u8) -> u8 {
    high << 1 | low
}

fn arithmetic(first: u16, second: u16) -> Instruction {
    let d = single(small(second, 15, 12), small(first, 6, 6));
    let n = single(small(first, 3, 0), small(second, 7, 7));
    let m = single(small(second, 3, 0), small(second, 5, 5));
    if bit(second, 8) {
        // Double precision is not implemented.
        return Undefined;
    }
    let op = bit(second, 6);
    let float = match (bits(first, 7, 4) & 0b1011, op) {
        (0b0000, false) => FloatOp::Mla,
        (0b0000, true) => FloatOp::Mls,
        (0b0001, false) => FloatOp::Nmls,
        (0b0001, true) => FloatOp::Nmla,
        (0b0010, false) => FloatOp::Mul,
        (0b0010, true) => FloatOp::Nmul,
        (0b0011, false) => FloatOp::Add,
        (0b0011, true) => FloatOp::Sub,
        (0b1000, false) => FloatOp::Div,
        (0b1001, false) => FloatOp::Fnms,
        (0b1001, true) => FloatOp::Fnma,
        (0b1010, false) => FloatOp::Fma,
        (0b1010, true) => FloatOp::Fms,
        (0b1011, false) => return immediate(d, first, second),
        (0b1011, true) => return unary(d, m, first, second),
        _ => return Undefined,
    };
    FloatArithmetic { float, d, n, m }
}

/// VFPExpandImm.
fn immediate(d: u8, first: u16, second: u16) -> Instruction {
    if bits(second, 7, 4) != 0 {
        return Undefined;
    }
    let imm8 = bits(first, 3, 0) << 4 | bits(second, 3, 0);
    let exponent = match imm8 >> 6 & 1 {
        0 => 0x80,
        _ => 0x7C,
    } | imm8 >> 4 & 3;
    FloatImmediate {
        d,
        bits: (imm8 & 0x80) << 24 | exponent << 23 | (imm8 & 15) << 19,
    }
}

fn unary(d: u8, m: u8, first: u16, second: u16) -> Instruction {
    let top = bit(second, 7);
    let simple = |float| FloatUnary { float, d, m };
    match bits(first, 3, 0) {
        0b0000 => simple(if top { UnaryOp::Abs } else { UnaryOp::Mov }),
        0b0001 => simple(if top { UnaryOp::Sqrt } else { UnaryOp::Neg }),
        0b0010 => HalfToFloat { d, m, top },
        0b0011 => FloatToHalf { d, m, top },
        0b0100 => FloatCompare {
            d,
            m: Some(m),
            quiet_is_invalid: top,
        },
        0b0101 if bits(second, 5, 0) == 0 => FloatCompare {
            d,
            m: None,
            quiet_is_invalid: top,
        },
        0b1000 => IntegerToFloat { d, m, signed: top },
        op @ (0b1010 | 0b1011 | 0b1110 | 0b1111) => {
            let size = if top { 32 } else { 16 };
            let Some(fraction) =
                u8::checked_sub(size, small(second, 3, 0) << 1 | small(second, 5, 5))
            else {
                return Unpredictable;
            };
            let signed = op & 1 == 0;
            if op & 4 == 0 {
                FixedToFloat {
                    d,
                    signed,
                    bits: size,
                    fraction,
                }
            } else {
                FloatToFixed {
                    d,
                    signed,
                    bits: size,
                    fraction,
                }
            }
        }
        op @ (0b1100 | 0b1101) => FloatToInteger {
            d,
            m,
            signed: op & 1 == 1,
            round_to_zero: top,
        },
        _ => Undefined,
    }
}

fn transfer(first: u16, second: u16) -> Instruction {
    let t = small(second, 15, 12);
    let to_core = bit(first, 4);
    let bad = t == SP || t == PC || bits(second, 3, 0) != 0;
    if bit(second, 8) {
        // One word of a doubleword register.
        let s = single(small(first, 3, 0), small(first, 5, 5));
        return match (bits(first, 7, 6), bits(second, 6, 5)) {
            (0, 0) if bit(second, 7) => Undefined,
            (0, 0) if bad => Unpredictable,
            (0, 0) if to_core => FloatToCore { s, t },
            (0, 0) => CoreToFloat { s, t },
            _ => Undefined,
        };
    }
    let s = single(small(first, 3, 0), small(second, 7, 7));
    match bits(first, 7, 5) {
        0 if bad || bits(second, 6, 5) != 0 => Unpredictable,
        0 if to_core => FloatToCore { s, t },
        0 => CoreToFloat { s, t },
        7 if bits(first, 3, 0) != 1 => Undefined,
        7 if bits(second, 7, 5) != 0 => Unpredictable,
        7 if to_core && t == PC && bits(second, 3, 0) == 0 => FloatStatusToFlags,
        7 if bad => Unpredictable,
        7 if to_core => FloatStatusToCore { t },
        7 => CoreToFloatStatus { t },
        _ => Undefined,
    }
}

fn transfer_pair(first: u16, second: u16) -> Instruction {
    if bits(second, 7, 6) != 0 || !bit(second, 4) {
        return Undefined;
    }
    let (t, t2) = (small(second, 15, 12), small(first, 3, 0));
    let (m, extra) = (small(second, 3, 0), small(second, 5, 5));
    let s = match (bit(second, 8), extra) {
        (false, _) => single(m, extra),
        (true, 0) => single(m, 0),
        (true, _) => return Undefined,
    };
    let to_core = bit(first, 4);
    let bad = |reg| reg == SP || reg == PC;
    if bad(t) || bad(t2) || s == 31 || (to_core && t == t2) {
        Unpredictable
    } else if to_core {
        FloatToCorePair { s, t, t2 }
    } else {
        CorePairToFloat { s, t, t2 }
    }
}

fn load_store(address: u32, first: u16, second: u16) -> Instruction {
    let (pre, up, writeback, load) = (bit(first, 8), bit(first, 7), bit(first, 5), bit(first, 4));
    let n = small(first, 3, 0);
    let double = bit(second, 8);
    let (vd, extra) = (small(second, 15, 12), small(first, 6, 6));
    if double && extra == 1 {
        return Undefined;
    }
    let first_single = single(vd, extra);
    let words = small(second, 7, 0);
    if pre && !writeback {
        let count = 1 + u8::from(double);
        let magnitude = i32::from(words) * 4;
        let offset = if up { magnitude } else { -magnitude };
        return match (load, n == PC) {
            (true, true) => FloatLoadLiteral {
                first: first_single,
                count,
                address: aligned_pc(address).wrapping_add_signed(offset),
            },
            (true, false) => FloatLoad {
                first: first_single,
                count,
                n,
                offset,
            },
            (false, true) => Unpredictable,
            (false, false) => FloatStore {
                first: first_single,
                count,
                n,
                offset,
            },
        };
    }
    let down = match (pre, up, writeback) {
        (false, true, _) => false,
        (true, false, true) => true,
        _ => return Undefined,
    };
    // An odd number of words for doubleword registers is the form FLDMX, which transfers one word less.
    let count = if double { words & !1 } else { words };
    if n == PC || count == 0 || count > 32 || first_single + count > 32 {
        return Unpredictable;
    }
    if load {
        FloatLoadMultiple {
            first: first_single,
            count,
            n,
            down,
            writeback,
            words,
        }
    } else {
        FloatStoreMultiple {
            first: first_single,
            count,
            n,
            down,
            writeback,
            words,
        }
    }
}
