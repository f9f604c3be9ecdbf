//! Special registers, interrupt masks and wait instructions.

use super::super::instruction::Reg;
use super::super::status::Flags;
use super::super::{Sleep, Stop, Trapped, Unmodelled, timing};
use crate::cpu::Cpu;
use crate::cpu::instruction::SP;

// SYSm: each bit of a number below 8 selects a part of the program status register.
const NOT_APSR: u8 = 4;
const IPSR: u8 = 1;
const LAST_STATUS: u8 = 7;
const MSP: u8 = 8;
const PSP: u8 = 9;
const PRIMASK: u8 = 16;
const BASEPRI: u8 = 17;
const BASEPRI_MAX: u8 = 18;
const FAULTMASK: u8 = 19;
const CONTROL: u8 = 20;

impl Cpu {
    pub(super) fn read_special(&mut self, d: Reg, special: u8) -> Result<(), Trapped> {
        self.spent += timing::SPECIAL;
        let privileged = self.privileged();
        let value = match special {
            ..=LAST_STATUS => {
                let flags = if special & NOT_APSR == 0 {
                    self.flags.bits()
                } else {
                    0
                };
                let number = if special & IPSR != 0 && privileged {
                    u32::from(self.exception)
                } else {
                    0
                };
                flags | number
            }
            CONTROL => {
                u32::from(self.unprivileged_thread)
                    | u32::from(self.process_stack) << 1
                    | u32::from(self.in_float_context) << 2
            }
            MSP | PSP | PRIMASK | BASEPRI | BASEPRI_MAX | FAULTMASK if !privileged => 0,
            MSP | PSP => {
                if self.process_stack == (special == PSP) {
                    self.get(SP)
                } else {
                    self.other_sp
                }
            }
            PRIMASK => self.primask.into(),
            BASEPRI | BASEPRI_MAX => self.basepri.into(),
            FAULTMASK => self.faultmask.into(),
            _ => return Err(self.no_such_register(special)),
        };
        self.set(d, value);
        Ok(())
    }

    pub(super) fn write_special(&mut self, n: Reg, special: u8, mask: u8) -> Result<(), Trapped> {
        self.spent += timing::SPECIAL;
        let value = self.get(n);
        match special {
            ..=LAST_STATUS => {
                if special & NOT_APSR == 0 {
                    self.write_flags(value, mask);
                }
            }
            MSP | PSP | PRIMASK | BASEPRI | BASEPRI_MAX | FAULTMASK | CONTROL
                if !self.privileged() => {}
            MSP | PSP => {
                if self.process_stack == (special == PSP) {
                    self.set(SP, value);
                } else {
                    self.other_sp = value & !3;
                }
            }
            PRIMASK => self.primask = value & 1 == 1,
            BASEPRI => self.basepri = value as u8 & 0xF0,
            BASEPRI_MAX => {
                let new = value as u8 & 0xF0;
                if new != 0 && (new < self.basepri || self.basepri == 0) {
                    self.basepri = new;
                }
            }
            FAULTMASK => {
                if self.priority > -1 {
                    self.faultmask = value & 1 == 1;
                }
            }
            CONTROL => self.write_control(value),
            _ => return Err(self.no_such_register(special)),
        }
        self.update_priority();
        self.attend_soon();
        Ok(())
    }

    fn write_flags(&mut self, value: u32, mask: u8) {
        let new = Flags::from_bits(value);
        if mask & 2 != 0 {
            self.flags = Flags {
                ge: self.flags.ge,
                ..new
            };
        }
        if mask & 1 != 0 {
            self.flags.ge = new.ge;
        }
    }

    fn write_control(&mut self, value: u32) {
        self.unprivileged_thread = value & 1 == 1;
        let process_stack = value & 2 != 0;
        if self.exception == 0 && process_stack != self.process_stack {
            self.swap_stacks();
        }
        self.in_float_context = value & 4 != 0;
        self.float.ready = false;
    }

    #[cold]
    fn no_such_register(&mut self, special: u8) -> Trapped {
        self.stop(Stop::Unmodelled(Unmodelled::Instruction {
            word: special.into(),
            pc: self.instruction_address,
            why: "no special register has this number",
        }))
    }

    /// CPS.
    pub(super) fn change_state(&mut self, disable: bool, primask: bool, faultmask: bool) {
        if !self.privileged() {
            return;
        }
        if primask {
            self.primask = disable;
        }
        if faultmask && (self.priority > -1 || !disable) {
            self.faultmask = disable;
        }
        self.update_priority();
        self.attend_soon();
    }

    pub(super) fn wait_for_interrupt(&mut self) {
        self.asleep = Some(Sleep::UntilInterrupt);
        self.attend_soon();
    }

    pub(super) fn wait_for_event(&mut self) {
        if !std::mem::take(&mut self.event) {
            self.asleep = Some(Sleep::UntilEvent);
            self.attend_soon();
        }
    }
}
