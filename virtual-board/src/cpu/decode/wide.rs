//! 32-bit instructions, except those of the FPU.

use super::{aligned_pc, bit, bits, float, immediate_shift, register_shift, sign_extend, small};
use crate::cpu::instruction::Instruction::{self, *};
use crate::cpu::instruction::{
    Access, Alu, Condition, Extension, Index, LaneOp, Lanes, Long, PC, Reg, Reversal, SINK, SP,
    SetFlags, Shift, ShifterCarry,
};

pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    match bits(first, 12, 9) {
        0b0100 if bit(first, 6) => double_exclusive_or_table(address, first, second),
        0b0100 => multiple(first, second),
        0b0101 => shifted_register(first, second),
        0b0110 | 0b0111 | 0b1110 | 0b1111 => float::decode(address, first, second),
        0b1000..=0b1011 if bit(second, 15) => branch_or_control(address, first, second),
        0b1000 | 0b1010 => modified_immediate(first, second),
        0b1001 | 0b1011 => plain_immediate(address, first, second),
        0b1100 => load_store(address, first, second),
        0b1101 if !bit(first, 8) => register_data(first, second),
        0b1101 if !bit(first, 7) => multiply(first, second),
        0b1101 => multiply_long(first, second),
        _ => Undefined,
    }
}

/// Returns true for SP and PC, which most instructions do not accept as an operand.
fn bad(reg: Reg) -> bool {
    reg == SP || reg == PC
}

fn multiple(first: u16, second: u16) -> Instruction {
    let n = small(first, 3, 0);
    let down = match bits(first, 8, 7) {
        0b01 => false,
        0b10 => true,
        _ => return Undefined,
    };
    let (writeback, load) = (bit(first, 5), bit(first, 4));
    let list = second;
    let pc_and_lr = list >> 14 == 3;
    let base_changes_twice = writeback && list >> n & 1 == 1;
    if n == PC
        || list.count_ones() < 2
        || bit(list, SP.into())
        || base_changes_twice
        || (load && pc_and_lr)
        || (!load && bit(list, PC.into()))
    {
        Unpredictable
    } else if load {
        LoadMultiple {
            n,
            list,
            down,
            writeback,
        }
    } else {
        StoreMultiple {
            n,
            list,
            down,
            writeback,
        }
    }
}

fn double_exclusive_or_table(address: u32, first: u16, second: u16) -> Instruction {
    let (pre, up, writeback, load) = (bit(first, 8), bit(first, 7), bit(first, 5), bit(first, 4));
    let (n, t, t2) = (
        small(first, 3, 0),
        small(second, 15, 12),
        small(second, 11, 8),
    );
    let offset = bits(second, 7, 0) as i16 * 4;
    if !pre && !writeback {
        return match (up, load) {
            (false, false) => store_exclusive(Access::Word, n, t, t2, offset as u16),
            (false, true) if t2 != PC => Unpredictable,
            (false, true) => load_exclusive(Access::Word, n, t, offset as u16),
            (true, _) => byte_exclusive_or_table(load, n, second),
        };
    }
    let offset = if up { offset } else { -offset };
    let index = match (pre, writeback) {
        (true, false) => Index::Offset,
        (true, true) => Index::Pre,
        (false, _) => Index::Post,
    };
    if bad(t) || bad(t2) || (writeback && (n == t || n == t2)) || (load && t == t2) {
        return Unpredictable;
    }
    match (load, n == PC) {
        (true, true) if writeback => Unpredictable,
        (true, true) => LoadDoubleLiteral {
            t,
            t2,
            address: aligned_pc(address).wrapping_add_signed(offset.into()),
        },
        (true, false) => LoadDouble {
            t,
            t2,
            n,
            offset,
            index,
        },
        (false, true) => Unpredictable,
        (false, false) => StoreDouble {
            t,
            t2,
            n,
            offset,
            index,
        },
    }
}

fn load_exclusive(kind: Access, n: Reg, t: Reg, offset: u16) -> Instruction {
    if bad(t) || n == PC {
        Unpredictable
    } else {
        LoadExclusive { kind, t, n, offset }
    }
}

fn store_exclusive(kind: Access, n: Reg, t: Reg, d: Reg, offset: u16) -> Instruction {
    if bad(t) || bad(d) || n == PC || d == n || d == t {
        Unpredictable
    } else {
        StoreExclusive {
            kind,
            d,
            t,
            n,
            offset,
        }
    }
}

fn byte_exclusive_or_table(load: bool, n: Reg, second: u16) -> Instruction {
    let t = small(second, 15, 12);
    let m = small(second, 3, 0);
    let half = bit(second, 4);
    let kind = if half { Access::Half } else { Access::Byte };
    let ones = bits(second, 11, 8);
    match (bits(second, 7, 5), load) {
        (0, true) if bad(m) || n == SP || bits(second, 15, 8) != 0xF0 => Unpredictable,
        (0, true) => TableBranch { n, m, half },
        (2, true) if ones != 15 || m != PC => Unpredictable,
        (2, false) if ones != 15 => Unpredictable,
        (2, true) => load_exclusive(kind, n, t, 0),
        (2, false) => store_exclusive(kind, n, t, m, 0),
        _ => Undefined,
    }
}

/// Decodes the four-bit operation field of immediates and shifted registers. SP or PC as destination or first operand select
/// other operations.
fn alu(op: u32, set: bool, d: Reg, n: Reg) -> Option<(Alu, Reg, bool)> {
    let test = d == PC && set;
    let d_or_sink = if test { SINK } else { d };
    let (alu, d, n_is_used) = match op {
        0b0000 => (Alu::And, d_or_sink, true),
        0b0001 => (Alu::Bic, d, true),
        0b0010 if n == PC => (Alu::Mov, d, false),
        0b0010 => (Alu::Orr, d, true),
        0b0011 if n == PC => (Alu::Mvn, d, false),
        0b0011 => (Alu::Orn, d, true),
        0b0100 => (Alu::Eor, d_or_sink, true),
        0b1000 => (Alu::Add, d_or_sink, true),
        0b1010 => (Alu::Adc, d, true),
        0b1011 => (Alu::Sbc, d, true),
        0b1101 => (Alu::Sub, d_or_sink, true),
        0b1110 => (Alu::Rsb, d, true),
        _ => return None,
    };
    Some((alu, d, n_is_used))
}

/// Returns true if the effect is unpredictable with these registers. SP may be adjusted, compared and copied.
fn open(alu: Alu, d: Reg, n: Reg, n_is_used: bool) -> bool {
    let sp_is_fine = matches!(alu, Alu::Add | Alu::Sub);
    let d_is_bad = d == PC || (d == SP && !(sp_is_fine && n == SP));
    let n_is_bad = n_is_used && (n == PC || (n == SP && !sp_is_fine));
    d_is_bad || n_is_bad
}

fn shifted_register(first: u16, second: u16) -> Instruction {
    let (d, n, m) = (
        small(second, 11, 8),
        small(first, 3, 0),
        small(second, 3, 0),
    );
    let amount = bits(second, 14, 12) << 2 | bits(second, 7, 6);
    let (shift, amount) = immediate_shift(bits(second, 5, 4), amount);
    let set = bit(first, 4);
    let op = bits(first, 8, 5);
    if bit(second, 15) {
        return Unpredictable;
    }
    if op == 0b0110 {
        return if set || bit(second, 4) {
            Undefined
        } else if bad(d) || bad(n) || bad(m) {
            Unpredictable
        } else {
            PackHalfwords {
                d,
                n,
                m,
                top: bit(second, 5),
                shift,
                amount,
            }
        };
    }
    let Some((alu, d, n_is_used)) = alu(op, set, d, n) else {
        return Undefined;
    };
    let plain_move = alu == Alu::Mov && !set && shift == Shift::Lsl && amount == 0;
    let copies_sp = plain_move && d != PC && m != PC && !(d == SP && m == SP);
    let sp_shift_is_bad = d == SP && !(shift == Shift::Lsl && amount <= 3);
    if !copies_sp && (bad(m) || open(alu, d, n, n_is_used) || sp_shift_is_bad) {
        return Unpredictable;
    }
    DataRegister {
        alu,
        set: always(set),
        d,
        n: if n_is_used { n } else { 0 },
        m,
        shift,
        amount,
    }
}

fn always(set: bool) -> SetFlags {
    if set {
        SetFlags::Always
    } else {
        SetFlags::Never
    }
}

/// ThumbExpandImm_C. `None` where the result is unpredictable.
fn expand_immediate(first: u16, second: u16) -> Option<(u32, ShifterCarry)> {
    let byte = bits(second, 7, 0);
    let rotation = bits(first, 10, 10) << 4 | bits(second, 14, 12) << 1 | byte >> 7;
    let value = match rotation >> 1 {
        0 => byte,
        1..=3 if byte == 0 => return None,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte * 0x0101_0101,
        _ => {
            let value = (0x80 | byte).rotate_right(rotation);
            let carry = if value >> 31 == 1 {
                ShifterCarry::Set
            } else {
                ShifterCarry::Clear
            };
            return Some((value, carry));
        }
    };
    Some((value, ShifterCarry::Unchanged))
}

fn modified_immediate(first: u16, second: u16) -> Instruction {
    let (d, n, set) = (small(second, 11, 8), small(first, 3, 0), bit(first, 4));
    let Some((alu, d, n_is_used)) = alu(bits(first, 8, 5), set, d, n) else {
        return Undefined;
    };
    let Some((value, carry)) = expand_immediate(first, second) else {
        return Unpredictable;
    };
    if open(alu, d, n, n_is_used) {
        return Unpredictable;
    }
    DataImmediate {
        alu,
        set: always(set),
        d,
        n: if n_is_used { n } else { 0 },
        carry,
        value,
    }
}

fn plain_immediate(address: u32, first: u16, second: u16) -> Instruction {
    let (d, n) = (small(second, 11, 8), small(first, 3, 0));
    let imm12 = bits(first, 10, 10) << 11 | bits(second, 14, 12) << 8 | bits(second, 7, 0);
    let imm16 = bits(first, 3, 0) << 12 | imm12;
    let lsb = small(second, 14, 12) << 2 | small(second, 7, 6);
    let low = small(second, 4, 0);
    let op = bits(first, 8, 4);
    let without_flags = |alu, n, value| DataImmediate {
        alu,
        set: SetFlags::Never,
        d,
        n,
        carry: ShifterCarry::Unchanged,
        value,
    };
    let d_may_be_sp = matches!(op, 0b00000 | 0b01010) && n == SP;
    if d == PC || (d == SP && !d_may_be_sp) {
        return Unpredictable;
    }
    match op {
        0b00000 if n == PC => without_flags(Alu::Mov, 0, aligned_pc(address).wrapping_add(imm12)),
        0b00000 => without_flags(Alu::Add, n, imm12),
        0b01010 if n == PC => without_flags(Alu::Mov, 0, aligned_pc(address).wrapping_sub(imm12)),
        0b01010 => without_flags(Alu::Sub, n, imm12),
        0b00100 => without_flags(Alu::Mov, 0, imm16),
        0b01100 => MoveTop {
            d,
            value: imm16 as u16,
        },
        0b10000.. if bit(first, 10) || bit(second, 5) => Unpredictable,
        0b10110 if n == SP || low < lsb => Unpredictable,
        0b10110 => BitFieldInsert {
            d,
            n: if n == PC { SINK } else { n },
            mask: (u32::MAX >> (31 - (low - lsb))) << lsb,
            lsb,
        },
        _ if bad(n) => Unpredictable,
        0b10010 | 0b11010 if lsb == 0 && bit(second, 4) => Unpredictable,
        0b10010 | 0b11010 if lsb == 0 => SaturateHalves {
            signed: op == 0b10010,
            d,
            n,
            to: small(second, 3, 0) + u8::from(op == 0b10010),
        },
        0b10000 | 0b10010 | 0b11000 | 0b11010 => {
            let (shift, amount) = immediate_shift(bits(first, 5, 5) << 1, lsb.into());
            let signed = !bit(first, 7);
            Saturate {
                signed,
                d,
                n,
                to: low + u8::from(signed),
                shift,
                amount,
            }
        }
        0b10100 | 0b11100 if lsb + low > 31 => Unpredictable,
        0b10100 | 0b11100 => BitFieldExtract {
            d,
            n,
            lsb,
            width: low + 1,
            signed: op == 0b10100,
        },
        _ => Undefined,
    }
}

fn branch_or_control(address: u32, first: u16, second: u16) -> Instruction {
    let sign = bits(first, 10, 10);
    let (j1, j2) = (bits(second, 13, 13), bits(second, 11, 11));
    let low = bits(second, 10, 0) << 1;
    let from = |offset, width| {
        address
            .wrapping_add(4)
            .wrapping_add(sign_extend(offset, width))
    };
    if bit(second, 12) {
        let (i1, i2) = (j1 ^ sign ^ 1, j2 ^ sign ^ 1);
        let target = from(
            sign << 24 | i1 << 23 | i2 << 22 | bits(first, 9, 0) << 12 | low,
            25,
        );
        return if bit(second, 14) {
            BranchLink { target }
        } else {
            Branch {
                condition: Condition::Always,
                target,
            }
        };
    }
    if bit(second, 14) {
        return Undefined;
    }
    if bits(first, 9, 7) != 0b111 {
        return Branch {
            condition: Condition::from_field(bits(first, 9, 6)),
            target: from(
                sign << 20 | j2 << 19 | j1 << 18 | bits(first, 5, 0) << 12 | low,
                21,
            ),
        };
    }
    control(first, second)
}

fn control(first: u16, second: u16) -> Instruction {
    let n = small(first, 3, 0);
    match bits(first, 10, 4) {
        _ if bit(second, 13) => Unpredictable,
        0b011_1001 | 0b011_1111 => Unpredictable,
        0b011_1000 => {
            if bad(n) || bits(second, 9, 8) != 0 {
                return Unpredictable;
            }
            WriteSpecial {
                n,
                special: small(second, 7, 0),
                mask: small(second, 11, 10),
            }
        }
        0b011_1010..=0b011_1110 if n != 15 => Unpredictable,
        0b011_1010 if bit(second, 11) => Unpredictable,
        0b011_1010 if bits(second, 10, 8) == 0 => match bits(second, 7, 0) {
            2 => WaitForEvent,
            3 => WaitForInterrupt,
            4 => SendEvent,
            _ => Nop,
        },
        0b011_1011 => match bits(second, 7, 4) {
            2 | 4..=6 if bits(second, 11, 8) != 15 => Unpredictable,
            2 if bits(second, 3, 0) != 15 => Unpredictable,
            2 => ClearExclusive,
            4..=6 => Barrier,
            _ => Undefined,
        },
        0b011_1110 => {
            let d = small(second, 11, 8);
            if bad(d) {
                return Unpredictable;
            }
            ReadSpecial {
                d,
                special: small(second, 7, 0),
            }
        }
        _ => Undefined,
    }
}

fn load_store(address: u32, first: u16, second: u16) -> Instruction {
    let (n, t) = (small(first, 3, 0), small(second, 15, 12));
    let (signed, load) = (bit(first, 8), bit(first, 4));
    let kind = match (bits(first, 6, 5), signed) {
        (0, false) => Access::Byte,
        (0, true) => Access::SignedByte,
        (1, false) => Access::Half,
        (1, true) => Access::SignedHalf,
        (2, false) => Access::Word,
        _ => return Undefined,
    };
    if !load && (signed || n == PC) {
        return Undefined;
    }
    // A load of a byte or halfword into PC encodes PLD or PLI.
    let hint = load && t == PC && kind != Access::Word;
    if hint {
        return preload(n, first, second);
    }
    let narrow_sp = t == SP && kind != Access::Word;
    if narrow_sp || (!load && t == PC) {
        return Unpredictable;
    }
    if n == PC {
        let offset = bits(second, 11, 0);
        let base = aligned_pc(address);
        let address = if bit(first, 7) {
            base.wrapping_add(offset)
        } else {
            base.wrapping_sub(offset)
        };
        return LoadLiteral { kind, t, address };
    }
    if !bit(first, 7) && !bit(second, 11) {
        let (m, shift) = (small(second, 3, 0), small(second, 5, 4));
        return match (bits(second, 10, 6), load) {
            (0, _) if bad(m) => Unpredictable,
            (0, true) => LoadRegister {
                kind,
                t,
                n,
                m,
                shift,
            },
            (0, false) => StoreRegister {
                kind,
                t,
                n,
                m,
                shift,
            },
            _ => Undefined,
        };
    }
    let (offset, index) = if bit(first, 7) {
        (bits(second, 11, 0) as i32, Index::Offset)
    } else {
        let magnitude = bits(second, 7, 0) as i32;
        let offset = if bit(second, 9) {
            magnitude
        } else {
            -magnitude
        };
        let index = match (bit(second, 10), bit(second, 8)) {
            (true, false) => Index::Offset,
            (true, true) => Index::Pre,
            (false, true) => Index::Post,
            (false, false) => return Undefined,
        };
        (offset, index)
    };
    if index != Index::Offset && n == t {
        return Unpredictable;
    }
    if load {
        Load {
            kind,
            t,
            n,
            offset,
            index,
        }
    } else {
        Store {
            kind,
            t,
            n,
            offset,
            index,
        }
    }
}

/// PLD and PLI in their four forms. They have no effect here.
fn preload(n: Reg, first: u16, second: u16) -> Instruction {
    let registers = bits(second, 11, 6) == 0;
    let negative_offset = bits(second, 11, 8) == 0b1100;
    if n == PC || bit(first, 7) || registers || negative_offset {
        Nop
    } else if bit(second, 11) {
        Unpredictable
    } else {
        Undefined
    }
}

fn register_data(first: u16, second: u16) -> Instruction {
    if bits(second, 15, 12) != 15 {
        return Undefined;
    }
    let (d, n, m) = (
        small(second, 11, 8),
        small(first, 3, 0),
        small(second, 3, 0),
    );
    let op = bits(first, 7, 4);
    let decoded = match (bit(first, 7), bits(second, 7, 4)) {
        (false, 0) => ShiftRegister {
            shift: register_shift(bits(first, 6, 5)),
            set: always(bit(first, 4)),
            d,
            n,
            m,
        },
        (false, 0b1000..) => {
            let extend = match op {
                0 => Extension::SignedHalf,
                1 => Extension::Half,
                2 => Extension::SignedBytes,
                3 => Extension::Bytes,
                4 => Extension::SignedByte,
                5 => Extension::Byte,
                _ => return Undefined,
            };
            return if bad(d) || bad(m) || n == SP || bit(second, 6) {
                Unpredictable
            } else {
                Extend {
                    extend,
                    d,
                    n: (n != PC).then_some(n),
                    m,
                    rotation: small(second, 5, 4) * 8,
                }
            };
        }
        (true, 0b0000..=0b0111) => {
            let parallel = match op & 7 {
                0 => LaneOp::Add8,
                1 => LaneOp::Add16,
                2 => LaneOp::AddSubExchange,
                4 => LaneOp::Sub8,
                5 => LaneOp::Sub16,
                6 => LaneOp::SubAddExchange,
                _ => return Undefined,
            };
            let lanes = match bits(second, 6, 4) {
                0 => Lanes::Signed,
                1 => Lanes::SignedSaturating,
                2 => Lanes::SignedHalving,
                4 => Lanes::Unsigned,
                5 => Lanes::UnsignedSaturating,
                6 => Lanes::UnsignedHalving,
                _ => return Undefined,
            };
            Parallel {
                parallel,
                lanes,
                d,
                n,
                m,
            }
        }
        (true, op2 @ 0b1000..=0b1011) => match op & 7 {
            0 => SaturatingAdd {
                d,
                n,
                m,
                double: op2 & 1 == 1,
                subtract: op2 & 2 == 2,
            },
            1 => Reverse {
                reverse: match op2 & 3 {
                    0 => Reversal::Bytes,
                    1 => Reversal::BytesOfHalves,
                    2 => Reversal::Bits,
                    _ => Reversal::SignedHalf,
                },
                d,
                m,
            },
            2 if op2 == 8 => Select { d, n, m },
            3 if op2 == 8 => CountLeadingZeros { d, m },
            _ => return Undefined,
        },
        _ => return Undefined,
    };
    let n_twice = matches!(decoded, Reverse { .. } | CountLeadingZeros { .. });
    if bad(d) || bad(n) || bad(m) || (n_twice && n != m) {
        Unpredictable
    } else {
        decoded
    }
}

fn multiply(first: u16, second: u16) -> Instruction {
    let (d, n, m, a) = (
        small(second, 11, 8),
        small(first, 3, 0),
        small(second, 3, 0),
        small(second, 15, 12),
    );
    if bits(second, 7, 6) != 0 {
        return Undefined;
    }
    if bad(d) || bad(n) || bad(m) || a == SP {
        return Unpredictable;
    }
    let (high, low) = (bit(second, 5), bit(second, 4));
    let addend = (a != PC).then_some(a);
    match (bits(first, 6, 4), high) {
        (0, false) if low => match addend {
            Some(a) => MultiplyAdd {
                d,
                n,
                m,
                a,
                subtract: true,
            },
            None => Unpredictable,
        },
        (0, false) => match addend {
            Some(a) => MultiplyAdd {
                d,
                n,
                m,
                a,
                subtract: false,
            },
            None => Multiply {
                d,
                n,
                m,
                set: SetFlags::Never,
            },
        },
        (1, n_top) => MultiplyHalves {
            d,
            n,
            m,
            a: addend,
            n_top,
            m_top: low,
        },
        (op @ (2 | 4), false) => MultiplyDual {
            d,
            n,
            m,
            a: addend,
            subtract: op == 4,
            exchange: low,
        },
        (3, false) => MultiplyWordByHalf {
            d,
            n,
            m,
            a: addend,
            m_top: low,
        },
        (6, false) if addend.is_none() => Unpredictable,
        (op @ (5 | 6), false) => MultiplyMostSignificant {
            d,
            n,
            m,
            a: addend,
            subtract: op == 6,
            round: low,
        },
        (7, false) if !low => SumOfDifferences { d, n, m, a: addend },
        _ => Undefined,
    }
}

fn multiply_long(first: u16, second: u16) -> Instruction {
    let (low, high, n, m) = (
        small(second, 15, 12),
        small(second, 11, 8),
        small(first, 3, 0),
        small(second, 3, 0),
    );
    let op = bits(first, 6, 4);
    if matches!(op, 1 | 3) {
        return if bits(second, 7, 4) != 15 {
            Undefined
        } else if bad(high) || bad(n) || bad(m) || low != 15 {
            Unpredictable
        } else {
            Divide {
                d: high,
                n,
                m,
                signed: op == 1,
            }
        };
    }
    let op2 = bits(second, 7, 4);
    let long = |long| MultiplyLong {
        long,
        low,
        high,
        n,
        m,
    };
    let decoded = match (op, op2) {
        (0, 0) => long(Long::Signed),
        (2, 0) => long(Long::Unsigned),
        (4, 0) => long(Long::SignedAccumulate),
        (6, 0) => long(Long::UnsignedAccumulate),
        (6, 6) => long(Long::UnsignedAccumulateTwice),
        (4, 0b1000..=0b1011) => MultiplyHalvesLong {
            low,
            high,
            n,
            m,
            n_top: op2 & 2 == 2,
            m_top: op2 & 1 == 1,
        },
        (4 | 5, 0b1100 | 0b1101) => MultiplyDualLong {
            low,
            high,
            n,
            m,
            subtract: op == 5,
            exchange: op2 & 1 == 1,
        },
        _ => return Undefined,
    };
    if bad(low) || bad(high) || bad(n) || bad(m) || low == high {
        Unpredictable
    } else {
        decoded
    }
}
