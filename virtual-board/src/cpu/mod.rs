//! A processor core: ARMv7E-M with the single-precision FPU, the Cortex-M4F of an STM32F4.
//!
//! It interprets. An instruction is decoded once and kept; a run goes from one instruction to the next until the
//! board wants to be asked again. Names are those of the architecture manual (ARM DDI 0403).
//!
//! Instructions are counted exactly. Cycles are model cycles, see `timing.rs`.
//!
//! Not modelled, and an error that names it: the MPU, trace and debug units beside the cycle counter, instructions
//! whose effect the manual leaves open. LDRT and its kin access as the privileged do.

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

/// The core.
#[derive(Debug, Clone)]
pub struct Cpu {
    /// The wires between board and core.
    pub signals: Signals,

    /// R0 to R12, the stack pointer in use, LR, an unused place, and the sink of results that nobody reads.
    registers: [u32; 17],
    /// The stack pointer that is not in use.
    other_sp: u32,
    /// Address of the next instruction.
    pc: u32,
    /// Address of the instruction in execution.
    instruction_address: u32,
    thumb: bool,
    flags: Flags,
    it: ItState,
    /// True if the instruction in execution is in an IT block.
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
    /// Priority of what is being executed.
    priority: i16,
    exceptions: Exceptions,
    faults: FaultStatus,
    system: SystemControl,
    systick: SysTick,
    /// The exclusive monitor; it guards all memory.
    exclusive: bool,
    /// The event register.
    event: bool,
    asleep: Option<Sleep>,
    /// What no run goes beyond until a reset.
    halted: Option<Stop>,

    trap: Option<Trap>,

    /// Cycles of the instruction in execution.
    spent: u32,
    instructions: u64,
    slept: u64,
    /// Instructions at the last exception entry, while a late one may still take it over.
    entered_at: Option<u64>,
    /// Number of the last instruction that made a load which another access may overlap, and the register.
    last_load_at: u64,
    last_loaded: Reg,
    /// Number of the last instruction that gave a core register a result, and the register.
    last_result_at: u64,
    last_result: Reg,
    /// Cycle at which the run loop looks up; 0 if something is to be attended to.
    look_up_at: u64,
    account: Account,

    decoded: Vec<Decoded>,
    decoded_edition: u64,
    breakpoints: BTreeSet<u32>,
    /// A breakpoint that has been reported and is to be executed.
    passed_breakpoint: Option<u32>,
    accelerator: FlashAccelerator,
    fetch_line: u32,
    data_line: u32,
}

/// What makes an instruction end early.
#[derive(Debug, Clone)]
enum Trap {
    Fault(Fault),
    Stop(Stop),
}

/// Says that an instruction has ended early; why is in [`Cpu::trap`].
#[derive(Debug)]
struct Trapped;

/// What the core waits for.
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
    /// True while an instruction of the FPU needs no preparation.
    ready: bool,
    /// Number of the last instruction that gave a register a result, and the register.
    last_result_at: u64,
    last_result: u8,
}

/// A place of the decode cache. A size of 0 says that it is empty.
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
/// A number that no instruction reaches, nor the one after it.
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
    /// A core at power-on. It does nothing sensible before [`Cpu::reset`].
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the reset: stack pointer and first address from the vector table at address 0. Time, interrupt lines,
    /// accounts and breakpoints go on.
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

    /// Executes until `cycle`, or until something else ends the run. Waiting for an interrupt is a jump of time.
    pub fn run<B: Bus>(&mut self, bus: &mut B, cycle: u64) -> Stop {
        self.attend_soon();
        // Apart from the rest, so that what is decoded can be read in place.
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

    /// Lets time pass to `cycle` without executing anything, as when a debugger has halted the core.
    pub fn stand_still(&mut self, cycle: u64) {
        self.signals.cycle = self.signals.cycle.max(cycle);
        self.attend_soon();
    }

    /// Instructions executed since power-on.
    #[must_use]
    pub fn instructions(&self) -> u64 {
        self.instructions
    }

    /// Cycles slept since power-on.
    #[must_use]
    pub fn slept(&self) -> u64 {
        self.slept
    }

    /// True while the core waits for an interrupt or an event.
    #[must_use]
    pub fn asleep(&self) -> bool {
        self.asleep.is_some()
    }

    /// Value of register `number`, 0 to 15; 15 is the address of the next instruction.
    ///
    /// # Panics
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

    /// Number of the exception that is being handled; 0 in thread mode.
    #[must_use]
    pub fn exception(&self) -> u16 {
        self.exception
    }

    /// CFSR and HFSR: which faults there have been since the reset, or since the image cleared them.
    #[must_use]
    pub fn fault_status(&self) -> (u32, u32) {
        (self.faults.configurable, self.faults.hard)
    }

    /// Makes runs end before the instruction at `address` in flash, or no longer.
    pub fn set_breakpoint(&mut self, address: u32, on: bool) {
        let address = address & !1;
        if on {
            self.breakpoints.insert(address);
        } else {
            self.breakpoints.remove(&address);
        }
        // What has a breakpoint stays out of the cache, where it costs nothing to look for one.
        if let Some(place) = self.decoded.get_mut(place(address)) {
            *place = Decoded::EMPTY;
        }
    }

    /// What exception `number` has taken since power-on.
    #[must_use]
    pub fn totals(&self, number: u16) -> Totals {
        self.account.totals(number)
    }

    /// Completed activations since the last call, oldest first, if [`Cpu::record_activations`] asked for them.
    pub fn take_activations(&mut self) -> Vec<Activation> {
        std::mem::take(&mut self.account.completed)
    }

    /// Starts or ends keeping every activation.
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

    /// Makes the run loop look up before the next instruction.
    #[inline]
    fn attend_soon(&mut self) {
        self.look_up_at = 0;
    }

    /// Lets cycles pass, and those that the instruction in execution has taken so far.
    #[inline(always)]
    fn spend(&mut self, cycles: u32) {
        self.signals.cycle += u64::from(std::mem::take(&mut self.spent) + cycles);
    }

    /// Goes on at an address whose lowest bit is the Thumb state.
    #[inline]
    fn jump_unspent(&mut self, address: u32) {
        self.pc = address & !1;
        self.thumb = address & 1 == 1;
        if !self.thumb {
            self.attend_soon();
        }
    }

    /// Everything that is not the next instruction: what the board said, sleep, exceptions, the end of the run.
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

    /// True if what is pending ends the sleep. PRIMASK does not keep the core asleep.
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

    /// The next instruction.
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

    /// Comes to the next instruction of an IT block; true if it is to be executed.
    fn advance_it_block(&mut self, instruction: &Instruction) -> bool {
        let condition = self.it.condition();
        self.it = self.it.advanced();
        self.in_it_block = self.flags.hold(condition) || *instruction == Instruction::Breakpoint;
        self.in_it_block
    }

    /// Decodes what is not in the cache, and keeps it if it is in flash.
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

    /// Waits for flash where execution comes to another 128 bits of it.
    #[inline(always)]
    fn begin_line(&mut self, line: u32) {
        self.fetch_line = line;
        if line < Memories::CCM >> 4 {
            let timing = self.signals.flash_timing;
            self.spent += self.accelerator.fetch(line, self.signals.cycle, timing);
        }
    }

    /// Notes a fault of the instruction in execution.
    #[cold]
    fn fault(&mut self, fault: Fault) -> Trapped {
        self.trap = Some(Trap::Fault(fault));
        Trapped
    }

    /// Notes that the run is to end at the instruction in execution.
    #[cold]
    fn stop(&mut self, stop: Stop) -> Trapped {
        self.trap = Some(Trap::Stop(stop));
        Trapped
    }

    /// What becomes of an instruction that ended early; the reason, if the run ends too.
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

/// Place of an address in the decode cache.
fn place(address: u32) -> usize {
    (address.wrapping_sub(Memories::FLASH) >> 1) as usize
}

#[cfg(test)]
mod tests;
