//! Exception entry and return: stacking, vectors, tail-chaining, late arrival, and escalation of faults.
//!
//! Lazy stacking of the FPU registers is used if FPCCR enables it, as after reset. Otherwise they are stacked at once. An
//! exception of higher priority that arrives before the first instruction of a handler takes over that handler's entry.

use super::exceptions::{BUS_FAULT, DEBUG_MONITOR, HARD_FAULT, MEM_MANAGE, NMI, SVCALL};
use super::fault::{Fault, FaultStatus};
use super::floating_point::Fpscr;
use super::instruction::{LR, SP};
use super::status::{Flags, ItState};
use super::system_space::SystemControl;
use super::{Bus, Cpu, Sleep, Stop, Trap, Trapped, Width, timing};

const BASIC_FRAME: u32 = 0x20;
const EXTENDED_FRAME: u32 = 0x68;
/// Offset of the FPU registers in a stack frame.
const FLOAT_PART: u32 = 0x20;
/// Offset of FPSCR in a stack frame.
const FLOAT_STATUS: u32 = 0x40;
const STACKED_ALIGNMENT: u32 = 1 << 9;
const THUMB: u32 = 1 << 24;

impl Cpu {
    /// Enters an exception that preempts the present code.
    pub(super) fn enter<B: Bus>(&mut self, bus: &mut B, number: u16) {
        if self.entered_at == Some(self.instructions) {
            let first = self.exception;
            let return_code = self.registers[usize::from(LR)];
            self.exceptions.active.set(first, false);
            self.exceptions.pending.set(first, true);
            self.spend(timing::TAIL_CHAIN);
            self.take_over_entry(bus, number, return_code);
            return;
        }
        self.account
            .open(number, self.exceptions.pended_at(number), self.now());
        let return_code = self.return_code();
        let stacked = self.stack(bus);
        self.spend(timing::ENTRY);
        if self.process_stack {
            self.swap_stacks();
        }
        self.in_float_context = false;
        match stacked {
            Ok(()) => self.begin(bus, number, return_code),
            Err(fault) => {
                let derived = self.derive(fault, number);
                self.take_over_entry(bus, derived, return_code);
            }
        }
    }

    /// Begins an exception in the entry that was started for another one.
    fn take_over_entry<B: Bus>(&mut self, bus: &mut B, number: u16, return_code: u32) {
        self.account
            .take_over(number, self.exceptions.pended_at(number));
        self.begin(bus, number, return_code);
    }

    /// Records a fault during the entry into exception `number`. Returns the exception that is handled first.
    fn derive(&mut self, fault: Fault, number: u16) -> u16 {
        self.faults.record(fault);
        let (derived, priority) = if self.system.handles(BUS_FAULT) {
            (BUS_FAULT, self.exceptions.priority(BUS_FAULT))
        } else {
            (HARD_FAULT, -1)
        };
        if priority >= self.exceptions.priority(number) {
            // The exception is at least as urgent as the fault. It begins without a complete frame, so its handler cannot
            // return.
            return number;
        }
        if derived == HARD_FAULT {
            self.faults.hard |= FaultStatus::FORCED;
        }
        self.exceptions.pend(derived, self.signals.cycle);
        derived
    }

    /// The value of EXC_RETURN for the present state.
    fn return_code(&self) -> u32 {
        let mode = match (self.exception, self.process_stack) {
            (0, false) => 9,
            (0, true) => 13,
            _ => 1,
        };
        0xFFFF_FFE0 | u32::from(!self.in_float_context) << 4 | mode
    }

    /// ExceptionTaken: sets the state in which a handler begins.
    fn begin<B: Bus>(&mut self, bus: &mut B, number: u16, return_code: u32) {
        self.registers[usize::from(LR)] = return_code;
        self.exception = number;
        self.it = ItState::default();
        self.exceptions.pending.set(number, false);
        self.exceptions.active.set(number, true);
        self.float.ready = false;
        self.exclusive = false;
        self.event = true;
        self.asleep = None;
        self.entered_at = Some(self.instructions);
        self.update_priority();
        let vector = self
            .system
            .vector_table()
            .wrapping_add(u32::from(number) * 4);
        match self.read(bus, vector, Width::Word) {
            Ok(handler) => {
                self.jump_unspent(handler);
                self.account.entered(self.signals.cycle);
            }
            Err(Trapped) => match self.trap.take() {
                Some(Trap::Stop(stop)) => self.halted = Some(stop),
                _ if number == HARD_FAULT => self.lock_up(),
                _ => self.take_fault(Fault::VectorTable),
            },
        }
    }

    /// Writes a word of a stack frame. An address outside RAM is a fault.
    fn stack_word<B: Bus>(&self, bus: &mut B, address: u32, word: u32) -> Result<(), Fault> {
        bus.memories()
            .write(address & !3, Width::Word, word)
            .ok_or(Fault::Stacking)
    }

    /// Reads a word of a stack frame.
    fn unstack_word<B: Bus>(&self, bus: &mut B, address: u32) -> Result<u32, Fault> {
        bus.memories()
            .read(address & !3, Width::Word)
            .ok_or(Fault::Unstacking)
    }

    /// PushStack.
    fn stack<B: Bus>(&mut self, bus: &mut B) -> Result<(), Fault> {
        let float = self.in_float_context;
        let size = if float { EXTENDED_FRAME } else { BASIC_FRAME };
        let sp = self.registers[usize::from(SP)];
        let align = sp & 4 != 0 && (self.system.aligns_stack() || float);
        let frame = sp.wrapping_sub(size) & !(u32::from(align) << 2);
        // The stack pointer moves even if the frame cannot be written.
        self.registers[usize::from(SP)] = frame;
        let status =
            self.program_status() & !STACKED_ALIGNMENT | if align { STACKED_ALIGNMENT } else { 0 };
        let [r0, r1, r2, r3] = [0, 1, 2, 3].map(|n| self.registers[n]);
        let words = [
            r0,
            r1,
            r2,
            r3,
            self.registers[12],
            self.registers[usize::from(LR)],
            self.pc,
            status,
        ];
        for (i, word) in (0..).zip(words) {
            self.stack_word(bus, frame.wrapping_add(4 * i), word)?;
        }
        if !float {
            return Ok(());
        }
        let context = self.system.float_context;
        if context & SystemControl::LAZY != 0 {
            self.system.float_frame = frame.wrapping_add(FLOAT_PART);
            self.system.float_context = self.lazy_context();
            Ok(())
        } else {
            self.spend(timing::FLOAT_FRAME);
            self.stack_float(bus, frame.wrapping_add(FLOAT_PART))
        }
    }

    /// Value of FPCCR at the entry of an exception with lazy stacking.
    fn lazy_context(&self) -> u32 {
        let ready = |number: u16, at: u32| {
            let enabled = self.system.handles(number);
            u32::from(enabled && self.exceptions.priority(number) < self.priority) << at
        };
        self.system.float_context & (SystemControl::AUTOMATIC | SystemControl::LAZY)
            | SystemControl::LAZY_ACTIVE
            | u32::from(!self.privileged()) << 1
            | u32::from(self.exception == 0) << 3
            | u32::from(self.priority > -1) << 4
            | ready(MEM_MANAGE, 5)
            | ready(BUS_FAULT, 6)
            | ready(DEBUG_MONITOR, 8)
    }

    fn stack_float<B: Bus>(&self, bus: &mut B, base: u32) -> Result<(), Fault> {
        for i in 0..16 {
            let word = self.float.registers[i as usize];
            self.stack_word(bus, base.wrapping_add(4 * i), word)?;
        }
        let status = self.float.status.bits();
        self.stack_word(bus, base.wrapping_add(FLOAT_STATUS), status)
    }

    /// ExecuteFPCheck: prepares the FPU for the first FPU instruction of a context.
    #[cold]
    pub(super) fn prepare_float<B: Bus>(&mut self, bus: &mut B) -> Result<(), Trapped> {
        if !self.system.float_is_on(self.privileged()) {
            return Err(self.fault(Fault::NoCoprocessor));
        }
        if self.system.lazy_frame_is_due() {
            self.stack_float(bus, self.system.float_frame)
                .map_err(|_| self.fault(Fault::LazyStacking))?;
            self.system.float_context &= !SystemControl::LAZY_ACTIVE;
            self.spent += timing::FLOAT_FRAME;
        }
        if self.system.float_context & SystemControl::AUTOMATIC != 0 && !self.in_float_context {
            self.in_float_context = true;
            self.float.status = Fpscr::from_defaults(self.system.float_defaults);
        }
        self.float.ready = true;
        Ok(())
    }

    /// ExceptionReturn.
    pub(super) fn return_from_exception<B: Bus>(&mut self, bus: &mut B, code: u32) {
        // The cycles of the returning instruction count for its handler.
        self.spend(0);
        let number = self.exception;
        let nested = self.exceptions.active.len() > 1;
        let allowed = match code & 15 {
            1 => nested,
            9 | 13 => !nested || self.system.allows_non_base_thread(),
            _ => false,
        };
        let valid = self.exceptions.active.contains(number) && allowed && code >= 0xFFFF_FFE0;
        self.exceptions.active.set(number, false);
        if self.line_is_high(number) {
            self.exceptions.pend(number, self.signals.cycle);
        }
        if number != NMI {
            self.faultmask = false;
        }
        self.update_priority();
        if !valid {
            self.refuse_return(bus, Fault::InvalidPc, code | 0xF000_0000);
            return;
        }
        if let Some((next, priority)) = self.exceptions.next()
            && priority < self.priority
        {
            self.chain(bus, next, code);
            return;
        }
        self.spend(timing::RETURN);
        if let Err(fault) = self.unstack(bus, code) {
            self.refuse_return(bus, fault, code);
            return;
        }
        self.account.close(self.now());
        self.event = true;
        self.exclusive = false;
        self.update_priority();
        self.attend_soon();
        if self.exception == 0 && self.system.sleeps_on_exit() {
            self.asleep = Some(Sleep::UntilInterrupt);
        }
    }

    /// Tail-chaining: goes from the end of one handler to the next and keeps the stack frame.
    fn chain<B: Bus>(&mut self, bus: &mut B, next: u16, return_code: u32) {
        self.account.close(self.now());
        self.account
            .open(next, self.exceptions.pended_at(next), self.now());
        self.spend(timing::TAIL_CHAIN);
        self.begin(bus, next, return_code);
    }

    /// A return that faults tail-chains to the exception of the fault.
    fn refuse_return<B: Bus>(&mut self, bus: &mut B, fault: Fault, code: u32) {
        self.take_fault(fault);
        if self.halted.is_none()
            && let Some((next, _)) = self.exceptions.next()
        {
            self.chain(bus, next, code);
        }
    }

    /// PopStack.
    fn unstack<B: Bus>(&mut self, bus: &mut B, code: u32) -> Result<(), Fault> {
        let to_process_stack = code & 4 != 0;
        let to_thread = code & 8 != 0;
        let float = code & 16 == 0;
        let frame = if to_process_stack {
            self.other_sp
        } else {
            self.registers[usize::from(SP)]
        };
        let mut words = [0; 8];
        for (i, word) in (0..).zip(&mut words) {
            *word = self.unstack_word(bus, frame.wrapping_add(4 * i))?;
        }
        let [r0, r1, r2, r3, r12, lr, pc, status] = words;
        let stacked_exception = (status & 0x1FF) as u16;
        if (stacked_exception == 0) != to_thread {
            return Err(Fault::InvalidPc);
        }
        if float {
            self.unstack_float(bus, frame.wrapping_add(FLOAT_PART))?;
        }
        let size = if float { EXTENDED_FRAME } else { BASIC_FRAME };
        let aligned = status & STACKED_ALIGNMENT != 0 && (self.system.aligns_stack() || float);
        let sp = frame.wrapping_add(size) | u32::from(aligned) << 2;
        self.exception = stacked_exception;
        if to_process_stack {
            self.other_sp = self.registers[usize::from(SP)];
        }
        self.process_stack = to_process_stack;
        self.registers[usize::from(SP)] = sp;
        self.registers[..4].copy_from_slice(&[r0, r1, r2, r3]);
        self.registers[12] = r12;
        self.registers[usize::from(LR)] = lr;
        self.flags = Flags::from_bits(status);
        self.it = ItState::from_bits(status);
        self.in_float_context = float;
        self.float.ready = false;
        self.jump_unspent(pc & !1 | u32::from(status & THUMB != 0));
        Ok(())
    }

    fn unstack_float<B: Bus>(&mut self, bus: &mut B, base: u32) -> Result<(), Fault> {
        if self.system.lazy_frame_is_due() {
            // The FPU registers still hold the values that were to be stacked.
            self.system.float_context &= !SystemControl::LAZY_ACTIVE;
            return Ok(());
        }
        if !self.system.float_is_on(true) {
            return Err(Fault::NoCoprocessor);
        }
        self.spend(timing::FLOAT_FRAME);
        for i in 0..16 {
            self.float.registers[i as usize] = self.unstack_word(bus, base.wrapping_add(4 * i))?;
        }
        let status = self.unstack_word(bus, base.wrapping_add(FLOAT_STATUS))?;
        self.float.status = Fpscr::new(status);
        Ok(())
    }

    /// Records a synchronous fault and pends its exception, or HardFault if that exception is disabled or masked.
    pub(super) fn take_fault(&mut self, fault: Fault) {
        self.faults.record(fault);
        // The handler of the fault gets an entry of its own.
        self.entered_at = None;
        if fault == Fault::Debug && self.system.handles(DEBUG_MONITOR) {
            // If the present code is at least as urgent as the monitor, the debug event escalates to HardFault.
            if self.exceptions.priority(DEBUG_MONITOR) < self.priority {
                self.faults.hard &= !(1 << 31);
                self.pend_now(DEBUG_MONITOR);
                return;
            }
        }
        let number = fault.exception();
        if number != HARD_FAULT && self.can_take(number) {
            self.pend_now(number);
        } else {
            self.escalate(number);
        }
    }

    /// SVC: pends SVCall, or HardFault if SVCall is masked.
    pub(super) fn call_supervisor(&mut self) {
        if self.can_take(SVCALL) {
            self.pend_now(SVCALL);
        } else {
            self.escalate(SVCALL);
        }
    }

    /// Pends a bus fault that is not attributed to an instruction.
    pub(super) fn pend_imprecise_bus_fault(&mut self) {
        self.faults.record(Fault::ImpreciseBus);
        if self.system.handles(BUS_FAULT) {
            self.pend_now(BUS_FAULT);
        } else {
            self.faults.hard |= FaultStatus::FORCED;
            self.pend_now(HARD_FAULT);
        }
    }

    fn can_take(&self, number: u16) -> bool {
        self.system.handles(number) && self.exceptions.priority(number) < self.priority
    }

    fn escalate(&mut self, number: u16) {
        if number != HARD_FAULT {
            self.faults.hard |= FaultStatus::FORCED;
        }
        if self.priority <= -1 {
            self.lock_up();
        } else {
            self.pend_now(HARD_FAULT);
        }
    }

    fn pend_now(&mut self, number: u16) {
        self.exceptions.pend(number, self.signals.cycle);
        self.attend_soon();
    }

    fn lock_up(&mut self) {
        self.halted = Some(Stop::Lockup { pc: self.pc });
        self.attend_soon();
    }

    /// ExecutionPriority, cached because every instruction checks it.
    pub(super) fn update_priority(&mut self) {
        let mut priority = self.exceptions.active_priority();
        if self.basepri != 0 {
            priority = priority.min(self.exceptions.group_priority(self.basepri));
        }
        if self.primask {
            priority = priority.min(0);
        }
        if self.faultmask {
            priority = priority.min(-1);
        }
        self.priority = priority;
    }
}
