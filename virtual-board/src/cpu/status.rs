//! The program status register: flags, conditions and the IT block.

use super::instruction::Condition;

/// APSR: N, Z, C, V, Q and GE.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags {
    pub n: bool,
    pub z: bool,
    pub c: bool,
    pub v: bool,
    pub q: bool,
    /// GE, four bits.
    pub ge: u8,
}

impl Flags {
    pub fn bits(self) -> u32 {
        u32::from(self.n) << 31
            | u32::from(self.z) << 30
            | u32::from(self.c) << 29
            | u32::from(self.v) << 28
            | u32::from(self.q) << 27
            | u32::from(self.ge) << 16
    }

    pub fn from_bits(bits: u32) -> Self {
        Self {
            n: bits >> 31 & 1 == 1,
            z: bits >> 30 & 1 == 1,
            c: bits >> 29 & 1 == 1,
            v: bits >> 28 & 1 == 1,
            q: bits >> 27 & 1 == 1,
            ge: (bits >> 16 & 15) as u8,
        }
    }

    /// ConditionPassed.
    #[inline]
    pub fn hold(self, condition: Condition) -> bool {
        match condition {
            Condition::Eq => self.z,
            Condition::Ne => !self.z,
            Condition::Cs => self.c,
            Condition::Cc => !self.c,
            Condition::Mi => self.n,
            Condition::Pl => !self.n,
            Condition::Vs => self.v,
            Condition::Vc => !self.v,
            Condition::Hi => self.c && !self.z,
            Condition::Ls => !self.c || self.z,
            Condition::Ge => self.n == self.v,
            Condition::Lt => self.n != self.v,
            Condition::Gt => !self.z && self.n == self.v,
            Condition::Le => self.z || self.n != self.v,
            Condition::Always => true,
        }
    }
}

/// ITSTATE: the condition of the next instruction and the number of remaining ones. 0 outside an IT block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ItState(pub u8);

impl ItState {
    #[inline]
    pub fn active(self) -> bool {
        self.0 != 0
    }

    pub fn condition(self) -> Condition {
        Condition::from_field(u32::from(self.0 >> 4))
    }

    /// ITAdvance.
    pub fn advanced(self) -> Self {
        if self.0 & 7 == 0 {
            Self(0)
        } else {
            Self(self.0 & 0xE0 | self.0 << 1 & 0x1F)
        }
    }

    /// The bits at their positions in xPSR.
    pub fn bits(self) -> u32 {
        u32::from(self.0 >> 2) << 10 | u32::from(self.0 & 3) << 25
    }

    pub fn from_bits(bits: u32) -> Self {
        Self((bits >> 10 & 0x3F) as u8 * 4 + (bits >> 25 & 3) as u8)
    }
}
