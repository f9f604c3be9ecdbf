//! The processor core: ARMv7E-M with the single-precision FPU, the Cortex-M4F of an STM32F4.
//!
//! The core is an interpreter. An instruction is decoded once and cached. A run executes instructions until the board needs
//! control again. Names are those of the architecture manual (ARM DDI 0403).
//!
//! Instructions are counted exactly. Cycles are model cycles, see `timing.rs`.
//!
//! Not modelled are the MPU, the trace and debug units except the cycle counter, and unpredictable instructions. Using them
//! ends the run with an error that names them. LDRT and its variants access memory with privilege.

mod access;
mod account;
mod arithmetic;
mod bus;
mod decode;
mod entry_and_return;
mod exceptions;
mod execute;
mod fault;
mod flash_accelerator;
mod floating_point;
mod instruction;
mod memory;
mod signals;
mod status;
mod stop;
mod system_space;
mod systick;
mod timing;

use std::collections::BTreeSet;

pub use account::{Activation, Totals};
pub use bus::{Bus, Refusal, Width};
pub use memory::Memories;
pub use signals::{FlashTiming, Signals};
pub use stop::{Stop, Unmodelled};

use account::{Account, Now};
use exceptions::{Exceptions, SYSTICK, Set, THREAD_PRIORITY};
use fault::{Fault, FaultStatus};
use flash_accelerator::FlashAccelerator;
use floating_point::Fpscr;
use instruction::{Instruction, Reg, SP};
use status::{Flags, ItState};
use system_space::SystemControl;
use systick::SysTick;

/// The processor core.
#[derive(Debug, Clone)]
pub struct Cpu {
    /// The signals between board and core.
    pub signals: Signals,

    /// R0 to R12, the active stack pointer, LR, an unused entry, and the sink of discarded results.
    registers: [u32; 17],
    /// The inactive stack pointer.
    other_sp: u32,
    /// Address of the next instruction.
    pc: u32,
    /// Address of the present instruction.
    instruction_address: u32,
    thumb: bool,
    flags: Flags,
    it: ItState,
    /// True if the present instruction is in an IT block.
    in_it_block: bool,
    float: FloatUnit,
    /// CONTROL.FPCA.
    in_float_context: bool,
    /// CONTROL.SPSEL.
    process_stack: bool,
    /// CONTROL.nPRIV.
    unprivileged_thread: bool,
    /// IPSR.
    exception: u16,
    primask: bool,
    faultmask: bool,
    basepri: u8,
    /// Execution priority of the present code.
    priority: i16,
    exceptions: Exceptions,
    faults: FaultStatus,
    system: SystemControl,
    systick: SysTick,
    /// The exclusive monitor. It covers all memory.
    exclusive: bool,
    /// The event register.
    event: bool,
    asleep: Option<Sleep>,
    /// Reason of a permanent stop, until the next reset.
    halted: Option<Stop>,

    trap: Option<Trap>,

    /// Cycles of the present instruction.
    spent: u32,
    instructions: u64,
    slept: u64,
    /// Instruction count at the last exception entry, while a late exception may still take it over.
    entered_at: Option<u64>,
    /// Instruction count at the last load that another access may overlap. `last_loaded` is its register.
    last_load_at: u64,
    last_loaded: Reg,
    /// Instruction count at the last result in a core register. `last_result` is that register.
    last_result_at: u64,
    last_result: Reg,
    /// Cycle at which the run loop checks for events. 0 requests a check at once.
    look_up_at: u64,
    account: Account,

    decoded: Vec<Decoded>,
    decoded_edition: u64,
    breakpoints: BTreeSet<u32>,
    /// A breakpoint that has been reported and is executed next.
    passed_breakpoint: Option<u32>,
    accelerator: FlashAccelerator,
    fetch_line: u32,
    data_line: u32,
}

/// Why an instruction ends early.
#[derive(Debug, Clone)]
enum Trap {
    Fault(Fault),
    Stop(Stop),
}

/// Marks that an instruction has ended early. The reason is in [`Cpu::trap`].
#[derive(Debug)]
struct Trapped;

/// Kind of sleep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sleep {
    UntilInterrupt,
    UntilEvent,
}

/// Registers of the FPU.
#[derive(Debug, Clone, Default)]
struct FloatUnit {
    registers: [u32; 32],
    status: Fpscr,
    /// True while FPU instructions need no preparation.
    ready: bool,
    /// Instruction count at the last result in an FPU register, followed by that register.
    last_result_at: u64,
    last_result: u8,
}

/// An entry of the decode cache. A size of 0 marks an empty entry.
#[derive(Debug, Clone, Copy)]
struct Decoded {
    instruction: Instruction,
    size: u8,
}

impl Decoded {
    const EMPTY: Self = Self {
        instruction: Instruction::Undefined,
        size: 0,
    };
}

const NO_LINE: u32 = u32::MAX;
const NO_REGISTER: Reg = Reg::MAX;
/// An instruction count that is never reached.
const LONG_AGO: u64 = u64::MAX - 1;

impl Default for Cpu {
    fn default() -> Self {
        Self {
            signals: Signals::default(),
            registers: [0; 17],
            other_sp: 0,
            pc: 0,
            instruction_address: 0,
            thumb: true,
            flags: Flags::default(),
            it: ItState::default(),
            in_it_block: false,
            float: FloatUnit {
                last_result_at: LONG_AGO,
                ..FloatUnit::default()
            },
            in_float_context: false,
            process_stack: false,
            unprivileged_thread: false,
            exception: 0,
            primask: false,
            faultmask: false,
            basepri: 0,
            priority: THREAD_PRIORITY,
            exceptions: Exceptions::default(),
            faults: FaultStatus::default(),
            system: SystemControl::default(),
            systick: SysTick::default(),
            exclusive: false,
            event: false,
            asleep: None,
            halted: None,
            trap: None,
            spent: 0,
            instructions: 0,
            slept: 0,
            entered_at: None,
            last_load_at: LONG_AGO,
            last_loaded: NO_REGISTER,
            last_result_at: LONG_AGO,
            last_result: NO_REGISTER,
            look_up_at: 0,
            account: Account::default(),
            decoded: Vec::new(),
            decoded_edition: 0,
            breakpoints: BTreeSet::new(),
            passed_breakpoint: None,
            accelerator: FlashAccelerator::default(),
            fetch_line: NO_LINE,
            data_line: NO_LINE,
        }
    }
}

impl Cpu {
    /// A core at power-on. [`Cpu::reset`] must be called before it can run.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Resets the core. Stack pointer and start address are read from the vector table at address 0. Time, interrupt lines,
    /// statistics and breakpoints are kept.
    pub fn reset<B: Bus>(&mut self, bus: &mut B) {
        let mut account = std::mem::take(&mut self.account);
        account.reset(self.now());
        let mut signals = std::mem::take(&mut self.signals);
        signals.rises = signals.levels;
        signals.risen = true;
        signals.board_called = false;
        *self = Self {
            signals,
            account,
            instructions: self.instructions,
            slept: self.slept,
            decoded: std::mem::take(&mut self.decoded),
            decoded_edition: self.decoded_edition,
            breakpoints: std::mem::take(&mut self.breakpoints),
            ..Self::default()
        };
        let memories = bus.memories();
        match (memories.read(0, Width::Word), memories.read(4, Width::Word)) {
            (Some(sp), Some(start)) => {
                self.set_register(usize::from(SP), sp);
                self.jump_unspent(start);
            }
            _ => self.halted = Some(Stop::Lockup { pc: 0 }),
        }
    }

    /// Executes until `cycle`, or until something else ends the run. A sleeping core skips to the next event.
    pub fn run<B: Bus>(&mut self, bus: &mut B, cycle: u64) -> Stop {
        self.attend_soon();
        // Taken out of `self`, so that instructions can be read without copying.
        let mut decoded = std::mem::take(&mut self.decoded);
        let stop = loop {
            if self.signals.cycle >= self.look_up_at {
                let edition = bus.memories().flash_edition();
                if edition != self.decoded_edition {
                    self.decoded_edition = edition;
                    decoded.clear();
                }
                if let Some(stop) = self.attend(bus, cycle) {
                    break stop;
                }
            } else if self.step(bus, &mut decoded).is_err()
                && let Some(stop) = self.end_early()
            {
                break stop;
            }
        };
        self.decoded = decoded;
        stop
    }

    /// Advances time to `cycle` without executing anything, as when a debugger halts the core.
    pub fn stand_still(&mut self, cycle: u64) {
        self.signals.cycle = self.signals.cycle.max(cycle);
        self.attend_soon();
    }

    /// Instructions executed since power-on.
    #[must_use]
    pub fn instructions(&self) -> u64 {
        self.instructions
    }

    /// Cycles of sleep since power-on.
    #[must_use]
    pub fn slept(&self) -> u64 {
        self.slept
    }

    /// True while the core waits for an interrupt or an event.
    #[must_use]
    pub fn asleep(&self) -> bool {
        self.asleep.is_some()
    }

    /// Value of register `number`, 0 to 15. Register 15 is the address of the next instruction.
    ///
    /// # Panics
    ///
    /// If `number` is above 15.
    #[must_use]
    pub fn register(&self, number: usize) -> u32 {
        match number {
            15 => self.pc,
            _ => self.registers[..15][number],
        }
    }

    /// Sets register `number`, 0 to 15.
    ///
    /// # Panics
    /// If `number` is above 15.
    pub fn set_register(&mut self, number: usize, value: u32) {
        match number {
            13 => self.registers[13] = value & !3,
            15 => {
                self.pc = value & !1;
                self.passed_breakpoint = None;
            }
            _ => self.registers[..15][number] = value,
        }
    }

    /// Bits of register S`number` of the FPU, 0 to 31.
    ///
    /// # Panics
    /// If `number` is above 31.
    #[must_use]
    pub fn float_register(&self, number: usize) -> u32 {
        self.float.registers[number]
    }

    /// Sets the bits of register S`number` of the FPU, 0 to 31.
    ///
    /// # Panics
    /// If `number` is above 31.
    pub fn set_float_register(&mut self, number: usize, bits: u32) {
        self.float.registers[number] = bits;
    }

    /// FPSCR.
    #[must_use]
    pub fn float_status(&self) -> u32 {
        self.float.status.bits()
    }

    /// Sets FPSCR.
    pub fn set_float_status(&mut self, bits: u32) {
        self.float.status = Fpscr::new(bits);
    }

    /// The program status register: flags, IT block, Thumb bit, exception number.
    #[must_use]
    pub fn program_status(&self) -> u32 {
        self.flags.bits() | self.it.bits() | u32::from(self.thumb) << 24 | u32::from(self.exception)
    }

    /// Sets the flags and the IT block from the bits of the program status register.
    pub fn set_program_status(&mut self, bits: u32) {
        self.flags = Flags::from_bits(bits);
        self.it = ItState::from_bits(bits);
    }

    /// Number of the exception that is being handled. 0 in thread mode.
    #[must_use]
    pub fn exception(&self) -> u16 {
        self.exception
    }

    /// CFSR and HFSR: the faults since the reset, or since the image cleared them.
    #[must_use]
    pub fn fault_status(&self) -> (u32, u32) {
        (self.faults.configurable, self.faults.hard)
    }

    /// Sets or removes a breakpoint at `address` in flash. A run ends before the instruction there.
    pub fn set_breakpoint(&mut self, address: u32, on: bool) {
        let address = address & !1;
        if on {
            self.breakpoints.insert(address);
        } else {
            self.breakpoints.remove(&address);
        }
        // An instruction with a breakpoint is not cached. Cached instructions need no check.
        if let Some(place) = self.decoded.get_mut(place(address)) {
            *place = Decoded::EMPTY;
        }
    }

    /// Totals of exception `number` since power-on.
    #[must_use]
    pub fn totals(&self, number: u16) -> Totals {
        self.account.totals(number)
    }

    /// Takes the completed activations since the last call, oldest first. Empty unless [`Cpu::record_activations`] is on.
    pub fn take_activations(&mut self) -> Vec<Activation> {
        std::mem::take(&mut self.account.completed)
    }

    /// Starts or stops recording every activation.
    pub fn record_activations(&mut self, on: bool) {
        self.account.record = on;
    }

    fn now(&self) -> Now {
        Now {
            cycle: self.signals.cycle,
            instructions: self.instructions,
        }
    }

    fn privileged(&self) -> bool {
        self.exception != 0 || !self.unprivileged_thread
    }

    fn line_is_high(&self, number: u16) -> bool {
        self.signals.levels.contains(number)
    }

    fn swap_stacks(&mut self) {
        std::mem::swap(&mut self.registers[usize::from(SP)], &mut self.other_sp);
        self.process_stack = !self.process_stack;
    }

    /// Makes the run loop check for events before the next instruction.
    #[inline]
    fn attend_soon(&mut self) {
        self.look_up_at = 0;
    }

    /// Adds `cycles` and those of the present instruction to the time.
    #[inline(always)]
    fn spend(&mut self, cycles: u32) {
        self.signals.cycle += u64::from(std::mem::take(&mut self.spent) + cycles);
    }

    /// Continues at an address whose lowest bit is the Thumb state.
    #[inline]
    fn jump_unspent(&mut self, address: u32) {
        self.pc = address & !1;
        self.thumb = address & 1 == 1;
        if !self.thumb {
            self.attend_soon();
        }
    }

    /// Handles everything except the next instruction: signals of the board, sleep, exceptions, and the end of the run.
    #[cold]
    fn attend<B: Bus>(&mut self, bus: &mut B, until: u64) -> Option<Stop> {
        if self.signals.risen {
            self.signals.risen = false;
            let rises = std::mem::take(&mut self.signals.rises);
            self.pend_all(&rises);
        }
        if self.systick.pass(self.signals.cycle) {
            let mut systick = Set::default();
            systick.set(SYSTICK, true);
            self.pend_all(&systick);
        }
        if let Some(stop) = &self.halted {
            if matches!(stop, Stop::Lockup { .. }) {
                self.signals.cycle = self.signals.cycle.max(until);
            }
            return Some(stop.clone());
        }
        if std::mem::take(&mut self.signals.board_called) {
            return Some(Stop::Event);
        }
        if let Some(sleep) = self.asleep {
            if !self.wakes(sleep) {
                return self.sleep_on(until);
            }
            self.asleep = None;
        }
        if self.signals.cycle >= until {
            return Some(Stop::Deadline);
        }
        if let Some((number, priority)) = self.exceptions.next()
            && priority < self.priority
        {
            self.enter(bus, number);
            return None;
        }
        if !self.thumb {
            self.take_fault(Fault::InvalidState);
            return None;
        }
        self.look_up_at = until.min(self.systick.next_zero());
        None
    }

    fn pend_all(&mut self, numbers: &Set) {
        for number in numbers.common(numbers) {
            self.exceptions.pend(number, self.signals.cycle);
        }
        if self.system.has_event_on_pend() {
            self.event = true;
        }
    }

    /// Returns true if a pending exception or event ends the sleep. PRIMASK does not prevent waking up.
    fn wakes(&mut self, sleep: Sleep) -> bool {
        if sleep == Sleep::UntilEvent && std::mem::take(&mut self.event) {
            return true;
        }
        let masked = std::mem::take(&mut self.primask);
        self.update_priority();
        let unmasked = self.priority;
        self.primask = masked;
        self.update_priority();
        self.exceptions
            .next()
            .is_some_and(|(_, priority)| priority < unmasked)
    }

    /// Sleeps until the deadline, or until SysTick may wake the core.
    fn sleep_on(&mut self, until: u64) -> Option<Stop> {
        let to = until.min(self.systick.next_zero());
        let from = self.signals.cycle;
        if from >= until {
            return Some(Stop::Deadline);
        }
        self.signals.cycle = to.max(from);
        self.slept += self.signals.cycle - from;
        None
    }

    /// Executes the next instruction.
    #[inline(always)]
    fn step<B: Bus>(&mut self, bus: &mut B, decoded: &mut Vec<Decoded>) -> Result<(), Trapped> {
        let address = self.pc;
        let uncached;
        let Decoded { instruction, size } = match decoded.get(place(address)) {
            Some(decoded) if decoded.size != 0 => decoded,
            _ => {
                uncached = self.decode(bus, address, decoded)?;
                &uncached
            }
        };
        self.instruction_address = address;
        self.spent = 1;
        if address >> 4 != self.fetch_line {
            self.begin_line(address >> 4);
        }
        self.instructions += 1;
        self.pc = address.wrapping_add((*size).into());
        let it = self.it;
        if it.active() && !self.advance_it_block(instruction) {
            self.spend(0);
            return Ok(());
        }
        let result = self.execute(bus, instruction);
        self.in_it_block = false;
        self.spend(0);
        if result.is_err() {
            self.pc = address;
            self.it = it;
        }
        result
    }

    /// Advances the IT block. Returns true if the next instruction is to be executed.
    fn advance_it_block(&mut self, instruction: &Instruction) -> bool {
        let condition = self.it.condition();
        self.it = self.it.advanced();
        self.in_it_block = self.flags.hold(condition) || *instruction == Instruction::Breakpoint;
        self.in_it_block
    }

    /// Decodes an instruction that is not cached. Instructions in flash are cached.
    #[cold]
    fn decode<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        cache: &mut Vec<Decoded>,
    ) -> Result<Decoded, Trapped> {
        if self.passed_breakpoint != Some(address) && self.breakpoints.contains(&address) {
            self.passed_breakpoint = Some(address);
            return Err(self.stop(Stop::Breakpoint(address)));
        }
        self.passed_breakpoint = None;
        let decoded = self
            .decode_at(bus, address)
            .map_err(|fault| self.fault(fault))?;
        let place = place(address);
        if place < bus.memories().flash().len() / 2 && !self.breakpoints.contains(&address) {
            if cache.len() <= place {
                cache.resize(place + 1, Decoded::EMPTY);
            }
            cache[place] = decoded;
        }
        Ok(decoded)
    }

    fn decode_at<B: Bus>(&self, bus: &mut B, address: u32) -> Result<Decoded, Fault> {
        let first = self.fetch(bus, address)?;
        let wide = decode::is_wide(first);
        let second = if wide {
            self.fetch(bus, address.wrapping_add(2))?
        } else {
            0
        };
        Ok(Decoded {
            instruction: decode::decode(address, first, second),
            size: if wide { 4 } else { 2 },
        })
    }

    /// Waits for flash when execution reaches another line of 128 bits.
    #[inline(always)]
    fn begin_line(&mut self, line: u32) {
        self.fetch_line = line;
        if line < Memories::CCM >> 4 {
            let timing = self.signals.flash_timing;
            self.spent += self.accelerator.fetch(line, self.signals.cycle, timing);
        }
    }

    /// Records a fault of the present instruction.
    #[cold]
    fn fault(&mut self, fault: Fault) -> Trapped {
        self.trap = Some(Trap::Fault(fault));
        Trapped
    }

    /// Records that the run ends at the present instruction.
    #[cold]
    fn stop(&mut self, stop: Stop) -> Trapped {
        self.trap = Some(Trap::Stop(stop));
        Trapped
    }

    /// Handles an instruction that ended early. Returns a reason if the run ends too.
    #[cold]
    fn end_early(&mut self) -> Option<Stop> {
        match self.trap.take()? {
            Trap::Fault(fault) => {
                self.take_fault(fault);
                None
            }
            Trap::Stop(stop) => Some(stop),
        }
    }
}

/// Index of an address in the decode cache.
fn place(address: u32) -> usize {
    (address.wrapping_sub(Memories::FLASH) >> 1) as usize
}

#[cfg(test)]
mod tests;
