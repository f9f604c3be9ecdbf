//! 16-bit instructions.

use super::{aligned_pc, bit, bits, immediate_shift, register_shift, sign_extend, small};
use crate::cpu::instruction::Instruction::{self, *};
use crate::cpu::instruction::{
    Access, Alu, Condition, Extension, Index, LR, PC, Reg, Reversal, SINK, SP, SetFlags, Shift,
    ShifterCarry,
};

pub fn decode(address: u32, half: u16) -> Instruction {
    match bits(half, 15, 10) {
        0b00_0000..=0b00_0101 => {
            let (shift, amount) = immediate_shift(bits(half, 12, 11), bits(half, 10, 6));
            let (d, m) = (small(half, 2, 0), small(half, 5, 3));
            register(Alu::Mov, d, d, m, shift, amount)
        }
        0b00_0110..=0b00_0111 => add_subtract(half),
        0b00_1000..=0b00_1111 => immediate(half),
        0b01_0000 => data_processing(half),
        0b01_0001 => high_registers(address, half),
        0b01_0010..=0b01_0011 => LoadLiteral {
            kind: Access::Word,
            t: small(half, 10, 8),
            address: aligned_pc(address).wrapping_add(bits(half, 7, 0) * 4),
        },
        0b01_0100..=0b01_0111 => register_offset(half),
        0b01_1000..=0b10_0111 => immediate_offset(half),
        0b10_1000..=0b10_1001 => DataImmediate {
            alu: Alu::Mov,
            set: SetFlags::Never,
            d: small(half, 10, 8),
            n: 0,
            carry: ShifterCarry::Unchanged,
            value: aligned_pc(address).wrapping_add(bits(half, 7, 0) * 4),
        },
        0b10_1010..=0b10_1011 => adjust_sp(Alu::Add, small(half, 10, 8), bits(half, 7, 0) * 4),
        0b10_1100..=0b10_1111 => miscellaneous(address, half),
        0b11_0000..=0b11_0011 => multiple(half),
        0b11_0100..=0b11_0111 => conditional(address, half),
        _ => Branch {
            condition: Condition::Always,
            target: branch_target(address, bits(half, 10, 0), 11),
        },
    }
}

fn branch_target(address: u32, halfwords: u32, width: u32) -> u32 {
    address
        .wrapping_add(4)
        .wrapping_add(sign_extend(halfwords << 1, width + 1))
}

fn register(alu: Alu, d: Reg, n: Reg, m: Reg, shift: Shift, amount: u8) -> Instruction {
    DataRegister {
        alu,
        set: SetFlags::OutsideIt,
        d,
        n,
        m,
        shift,
        amount,
    }
}

fn constant(alu: Alu, set: SetFlags, d: Reg, n: Reg, value: u32) -> Instruction {
    DataImmediate {
        alu,
        set,
        d,
        n,
        carry: ShifterCarry::Unchanged,
        value,
    }
}

fn adjust_sp(alu: Alu, d: Reg, value: u32) -> Instruction {
    constant(alu, SetFlags::Never, d, SP, value)
}

fn add_subtract(half: u16) -> Instruction {
    let (d, n) = (small(half, 2, 0), small(half, 5, 3));
    let alu = if bit(half, 9) { Alu::Sub } else { Alu::Add };
    if bit(half, 10) {
        constant(alu, SetFlags::OutsideIt, d, n, bits(half, 8, 6))
    } else {
        register(alu, d, n, small(half, 8, 6), Shift::Lsl, 0)
    }
}

fn immediate(half: u16) -> Instruction {
    let d = small(half, 10, 8);
    let value = bits(half, 7, 0);
    match bits(half, 12, 11) {
        0 => constant(Alu::Mov, SetFlags::OutsideIt, d, d, value),
        1 => constant(Alu::Sub, SetFlags::Always, SINK, d, value),
        2 => constant(Alu::Add, SetFlags::OutsideIt, d, d, value),
        _ => constant(Alu::Sub, SetFlags::OutsideIt, d, d, value),
    }
}

fn data_processing(half: u16) -> Instruction {
    let (d, m) = (small(half, 2, 0), small(half, 5, 3));
    let plain = |alu| register(alu, d, d, m, Shift::Lsl, 0);
    let test = |alu| DataRegister {
        alu,
        set: SetFlags::Always,
        d: SINK,
        n: d,
        m,
        shift: Shift::Lsl,
        amount: 0,
    };
    let shift = |kind| ShiftRegister {
        shift: register_shift(kind),
        set: SetFlags::OutsideIt,
        d,
        n: d,
        m,
    };
    match bits(half, 9, 6) {
        0 => plain(Alu::And),
        1 => plain(Alu::Eor),
        2 => shift(0),
        3 => shift(1),
        4 => shift(2),
        5 => plain(Alu::Adc),
        6 => plain(Alu::Sbc),
        7 => shift(3),
        8 => test(Alu::And),
        9 => constant(Alu::Rsb, SetFlags::OutsideIt, d, m, 0),
        10 => test(Alu::Sub),
        11 => test(Alu::Add),
        12 => plain(Alu::Orr),
        13 => Multiply {
            d,
            n: m,
            m: d,
            set: SetFlags::OutsideIt,
        },
        14 => plain(Alu::Bic),
        _ => plain(Alu::Mvn),
    }
}

fn high_registers(address: u32, half: u16) -> Instruction {
    let d = small(half, 2, 0) | small(half, 7, 7) << 3;
    let m = small(half, 6, 3);
    let pc = address.wrapping_add(4);
    match bits(half, 9, 8) {
        0 if d == PC && m == PC => Unpredictable,
        0 if d == PC => AddToPc { m, base: pc },
        0 if m == PC => constant(Alu::Add, SetFlags::Never, d, d, pc),
        0 => DataRegister {
            alu: Alu::Add,
            set: SetFlags::Never,
            d,
            n: d,
            m,
            shift: Shift::Lsl,
            amount: 0,
        },
        1 if d == PC || m == PC || (d < 8 && m < 8) => Unpredictable,
        1 => DataRegister {
            alu: Alu::Sub,
            set: SetFlags::Always,
            d: SINK,
            n: d,
            m,
            shift: Shift::Lsl,
            amount: 0,
        },
        2 if d == PC && m == PC => Branch {
            condition: Condition::Always,
            target: pc,
        },
        2 if d == PC => MoveToPc { m },
        2 if m == PC => constant(Alu::Mov, SetFlags::Never, d, d, pc),
        2 => DataRegister {
            alu: Alu::Mov,
            set: SetFlags::Never,
            d,
            n: d,
            m,
            shift: Shift::Lsl,
            amount: 0,
        },
        _ if bits(half, 2, 0) != 0 || m == PC => Unpredictable,
        _ => BranchExchange {
            m,
            link: bit(half, 7),
        },
    }
}

fn register_offset(half: u16) -> Instruction {
    let (t, n, m) = (small(half, 2, 0), small(half, 5, 3), small(half, 8, 6));
    let store = |kind| StoreRegister {
        kind,
        t,
        n,
        m,
        shift: 0,
    };
    let load = |kind| LoadRegister {
        kind,
        t,
        n,
        m,
        shift: 0,
    };
    match bits(half, 11, 9) {
        0 => store(Access::Word),
        1 => store(Access::Half),
        2 => store(Access::Byte),
        3 => load(Access::SignedByte),
        4 => load(Access::Word),
        5 => load(Access::Half),
        6 => load(Access::Byte),
        _ => load(Access::SignedHalf),
    }
}

fn immediate_offset(half: u16) -> Instruction {
    let (kind, scale) = match bits(half, 15, 12) {
        0b0110 | 0b1001 => (Access::Word, 4),
        0b0111 => (Access::Byte, 1),
        _ => (Access::Half, 2),
    };
    let (t, n, offset) = if bits(half, 15, 12) == 0b1001 {
        (small(half, 10, 8), SP, bits(half, 7, 0))
    } else {
        (small(half, 2, 0), small(half, 5, 3), bits(half, 10, 6))
    };
    let offset = (offset * scale) as i32;
    let index = Index::Offset;
    if bit(half, 11) {
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

fn miscellaneous(address: u32, half: u16) -> Instruction {
    let (d, m) = (small(half, 2, 0), small(half, 5, 3));
    let extend = |extend| Extend {
        extend,
        d,
        n: None,
        m,
        rotation: 0,
    };
    let reverse = |reverse| Reverse { reverse, d, m };
    match bits(half, 11, 8) {
        0b0000 => adjust_sp(
            if bit(half, 7) { Alu::Sub } else { Alu::Add },
            SP,
            bits(half, 6, 0) * 4,
        ),
        0b0001 | 0b0011 | 0b1001 | 0b1011 => CompareBranch {
            n: d,
            nonzero: bit(half, 11),
            target: address
                .wrapping_add(4)
                .wrapping_add(bits(half, 9, 9) << 6 | bits(half, 7, 3) << 1),
        },
        0b0010 => extend(match bits(half, 7, 6) {
            0 => Extension::SignedHalf,
            1 => Extension::SignedByte,
            2 => Extension::Half,
            _ => Extension::Byte,
        }),
        0b0100 | 0b0101 => push_pop(half, true),
        0b0110 if bits(half, 7, 5) == 0b011 && matches!(bits(half, 3, 0), 0 | 4..) => Unpredictable,
        0b0110 if bits(half, 7, 5) == 0b011 => ChangeState {
            disable: bit(half, 4),
            primask: bit(half, 1),
            faultmask: bit(half, 0),
        },
        0b1010 => match bits(half, 7, 6) {
            0 => reverse(Reversal::Bytes),
            1 => reverse(Reversal::BytesOfHalves),
            3 => reverse(Reversal::SignedHalf),
            _ => Undefined,
        },
        0b1100 | 0b1101 => push_pop(half, false),
        0b1110 => Breakpoint,
        0b1111 => match (bits(half, 7, 4), bits(half, 3, 0)) {
            (2, 0) => WaitForEvent,
            (3, 0) => WaitForInterrupt,
            (4, 0) => SendEvent,
            (_, 0) => Nop,
            (15, _) => Unpredictable,
            (14, mask) if mask != 8 => Unpredictable,
            _ => IfThen {
                state: small(half, 7, 0),
            },
        },
        _ => Undefined,
    }
}

fn push_pop(half: u16, push: bool) -> Instruction {
    let extra = if push { LR } else { PC };
    let list = bits(half, 7, 0) as u16 | (bits(half, 8, 8) << extra) as u16;
    match (list, push) {
        (0, _) => Unpredictable,
        (_, true) => StoreMultiple {
            n: SP,
            list,
            down: true,
            writeback: true,
        },
        (_, false) => LoadMultiple {
            n: SP,
            list,
            down: false,
            writeback: true,
        },
    }
}

fn multiple(half: u16) -> Instruction {
    let n = small(half, 10, 8);
    let list = bits(half, 7, 0) as u16;
    if list == 0 {
        Unpredictable
    } else if bit(half, 11) {
        LoadMultiple {
            n,
            list,
            down: false,
            writeback: list >> n & 1 == 0,
        }
    } else {
        StoreMultiple {
            n,
            list,
            down: false,
            writeback: true,
        }
    }
}

fn conditional(address: u32, half: u16) -> Instruction {
    match bits(half, 11, 8) {
        14 => Undefined,
        15 => SupervisorCall,
        condition => Branch {
            condition: Condition::from_field(condition),
            target: branch_target(address, bits(half, 7, 0), 8),
        },
    }
}
