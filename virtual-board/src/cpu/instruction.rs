//! Decoded instructions, as the decoder creates, the decode cache stores and the executor executes them.
//!
//! Names are those of the architecture manual (ARM DDI 0403). Values that depend on the address of the instruction (branch
//! targets, literals) are already computed.

/// Number of a core register, 0 to 15, or [`SINK`].
pub type Reg = u8;

/// Destination of a result that is discarded, as of CMP and TST.
pub const SINK: Reg = 16;
/// The stack pointer.
pub const SP: Reg = 13;
/// The link register.
pub const LR: Reg = 14;
/// The program counter.
pub const PC: Reg = 15;

/// One instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Instruction {
    // Data processing
    DataImmediate { alu: Alu, set: SetFlags, d: Reg, n: Reg, carry: ShifterCarry, value: u32 },
    DataRegister { alu: Alu, set: SetFlags, d: Reg, n: Reg, m: Reg, shift: Shift, amount: u8 },
    ShiftRegister { shift: Shift, set: SetFlags, d: Reg, n: Reg, m: Reg },
    MoveTop { d: Reg, value: u16 },
    CountLeadingZeros { d: Reg, m: Reg },
    Reverse { reverse: Reversal, d: Reg, m: Reg },
    BitFieldInsert { d: Reg, n: Reg, mask: u32, lsb: u8 },
    BitFieldExtract { d: Reg, n: Reg, lsb: u8, width: u8, signed: bool },
    Extend { extend: Extension, d: Reg, n: Option<Reg>, m: Reg, rotation: u8 },
    Saturate { signed: bool, d: Reg, n: Reg, to: u8, shift: Shift, amount: u8 },
    SaturateHalves { signed: bool, d: Reg, n: Reg, to: u8 },
    SaturatingAdd { d: Reg, n: Reg, m: Reg, double: bool, subtract: bool },
    PackHalfwords { d: Reg, n: Reg, m: Reg, top: bool, shift: Shift, amount: u8 },
    Select { d: Reg, n: Reg, m: Reg },
    Parallel { parallel: LaneOp, lanes: Lanes, d: Reg, n: Reg, m: Reg },
    SumOfDifferences { d: Reg, n: Reg, m: Reg, a: Option<Reg> },

    // Multiply and divide
    Multiply { d: Reg, n: Reg, m: Reg, set: SetFlags },
    MultiplyAdd { d: Reg, n: Reg, m: Reg, a: Reg, subtract: bool },
    MultiplyLong { long: Long, low: Reg, high: Reg, n: Reg, m: Reg },
    MultiplyHalves { d: Reg, n: Reg, m: Reg, a: Option<Reg>, n_top: bool, m_top: bool },
    MultiplyWordByHalf { d: Reg, n: Reg, m: Reg, a: Option<Reg>, m_top: bool },
    MultiplyDual { d: Reg, n: Reg, m: Reg, a: Option<Reg>, subtract: bool, exchange: bool },
    MultiplyHalvesLong { low: Reg, high: Reg, n: Reg, m: Reg, n_top: bool, m_top: bool },
    MultiplyDualLong { low: Reg, high: Reg, n: Reg, m: Reg, subtract: bool, exchange: bool },
    MultiplyMostSignificant { d: Reg, n: Reg, m: Reg, a: Option<Reg>, subtract: bool, round: bool },
    Divide { d: Reg, n: Reg, m: Reg, signed: bool },

    // Branches
    Branch { condition: Condition, target: u32 },
    BranchLink { target: u32 },
    BranchExchange { m: Reg, link: bool },
    MoveToPc { m: Reg },
    AddToPc { m: Reg, base: u32 },
    CompareBranch { n: Reg, nonzero: bool, target: u32 },
    TableBranch { n: Reg, m: Reg, half: bool },
    IfThen { state: u8 },

    // Loads and stores
    Load { kind: Access, t: Reg, n: Reg, offset: i32, index: Index },
    LoadRegister { kind: Access, t: Reg, n: Reg, m: Reg, shift: u8 },
    LoadLiteral { kind: Access, t: Reg, address: u32 },
    Store { kind: Access, t: Reg, n: Reg, offset: i32, index: Index },
    StoreRegister { kind: Access, t: Reg, n: Reg, m: Reg, shift: u8 },
    LoadDouble { t: Reg, t2: Reg, n: Reg, offset: i16, index: Index },
    LoadDoubleLiteral { t: Reg, t2: Reg, address: u32 },
    StoreDouble { t: Reg, t2: Reg, n: Reg, offset: i16, index: Index },
    LoadMultiple { n: Reg, list: u16, down: bool, writeback: bool },
    StoreMultiple { n: Reg, list: u16, down: bool, writeback: bool },
    LoadExclusive { kind: Access, t: Reg, n: Reg, offset: u16 },
    StoreExclusive { kind: Access, d: Reg, t: Reg, n: Reg, offset: u16 },
    ClearExclusive,

    // System
    ReadSpecial { d: Reg, special: u8 },
    WriteSpecial { n: Reg, special: u8, mask: u8 },
    ChangeState { disable: bool, primask: bool, faultmask: bool },
    Barrier,
    Nop,
    SendEvent,
    WaitForEvent,
    WaitForInterrupt,
    SupervisorCall,
    Breakpoint,
    /// Permanently or architecturally undefined.
    Undefined,
    /// An instruction of a coprocessor that does not exist.
    NoCoprocessor,
    /// The manual calls the effect unpredictable.
    Unpredictable,

    // Floating point; `d`, `n` and `m` are numbers of single-precision registers, 0 to 31
    FloatArithmetic { float: FloatOp, d: u8, n: u8, m: u8 },
    FloatUnary { float: UnaryOp, d: u8, m: u8 },
    FloatImmediate { d: u8, bits: u32 },
    FloatCompare { d: u8, m: Option<u8>, quiet_is_invalid: bool },
    FloatToInteger { d: u8, m: u8, signed: bool, round_to_zero: bool },
    IntegerToFloat { d: u8, m: u8, signed: bool },
    FloatToFixed { d: u8, signed: bool, bits: u8, fraction: u8 },
    FixedToFloat { d: u8, signed: bool, bits: u8, fraction: u8 },
    HalfToFloat { d: u8, m: u8, top: bool },
    FloatToHalf { d: u8, m: u8, top: bool },
    FloatLoad { first: u8, count: u8, n: Reg, offset: i32 },
    FloatLoadLiteral { first: u8, count: u8, address: u32 },
    FloatStore { first: u8, count: u8, n: Reg, offset: i32 },
    FloatLoadMultiple { first: u8, count: u8, n: Reg, down: bool, writeback: bool, words: u8 },
    FloatStoreMultiple { first: u8, count: u8, n: Reg, down: bool, writeback: bool, words: u8 },
    CoreToFloat { s: u8, t: Reg },
    FloatToCore { s: u8, t: Reg },
    CorePairToFloat { s: u8, t: Reg, t2: Reg },
    FloatToCorePair { s: u8, t: Reg, t2: Reg },
    FloatStatusToCore { t: Reg },
    FloatStatusToFlags,
    CoreToFloatStatus { t: Reg },
}

/// When an instruction sets the flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetFlags {
    Never,
    Always,
    /// Only outside an IT block, as most 16-bit instructions do.
    OutsideIt,
}

/// Operation of the arithmetic and logic unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Alu { And, Bic, Orr, Orn, Eor, Mov, Mvn, Add, Adc, Sub, Sbc, Rsb }

/// Carry out of a shifter whose operand is known at decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum ShifterCarry { Unchanged, Clear, Set }

/// Shift of a register operand. LSR and ASR shift by up to 32. RRX has no amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Shift { Lsl, Lsr, Asr, Ror, Rrx }

/// RBIT, REV, REV16, REVSH.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Reversal { Bits, Bytes, BytesOfHalves, SignedHalf }

/// Operand of SXTB and its variants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Extension { SignedByte, Byte, SignedHalf, Half, SignedBytes, Bytes }

/// Operation of a parallel addition or subtraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum LaneOp { Add8, Sub8, Add16, Sub16, AddSubExchange, SubAddExchange }

/// Treatment of the result lanes: the prefixes S, Q, SH, U, UQ and UH.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Lanes { Signed, SignedSaturating, SignedHalving, Unsigned, UnsignedSaturating, UnsignedHalving }

/// SMULL, UMULL, SMLAL, UMLAL, UMAAL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Long { Signed, Unsigned, SignedAccumulate, UnsignedAccumulate, UnsignedAccumulateTwice }

/// Width and sign of a load or store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Access { Byte, Half, Word, SignedByte, SignedHalf }

/// Addressing with an immediate offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Index { Offset, Pre, Post }

/// Two-operand and accumulating arithmetic of the FPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum FloatOp { Add, Sub, Mul, Nmul, Div, Mla, Mls, Nmla, Nmls, Fma, Fms, Fnma, Fnms }

/// One-operand arithmetic of the FPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum UnaryOp { Mov, Abs, Neg, Sqrt }

/// Condition of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[rustfmt::skip]
pub enum Condition { Eq, Ne, Cs, Cc, Mi, Pl, Vs, Vc, Hi, Ls, Ge, Lt, Gt, Le, Always }

impl Condition {
    /// The condition of a four-bit `cond` field. 15 also gives [`Condition::Always`].
    pub const fn from_field(field: u32) -> Self {
        use Condition::*;
        const ALL: [Condition; 16] = [
            Eq, Ne, Cs, Cc, Mi, Pl, Vs, Vc, Hi, Ls, Ge, Lt, Gt, Le, Always, Always,
        ];
        ALL[(field & 15) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instruction_takes_twelve_bytes_at_most() {
        assert!(size_of::<Instruction>() <= 12);
    }
}
