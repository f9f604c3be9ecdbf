//! The private peripheral bus: interrupt controller, system control, SysTick, cycle counter, FPU control.

use super::exceptions::{
    BUS_FAULT, DEBUG_MONITOR, INTERRUPT_0, MEM_MANAGE, NMI, PENDSV, SVCALL, SYSTICK, USAGE_FAULT,
};
use super::fault::Fault;
use super::{Cpu, Stop, Trapped, Width};

/// Number of interrupt lines of an STM32F407.
const LINES: u16 = 82;

/// Registers of system control, without those of faults and exceptions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SystemControl {
    auxiliary: u32,
    vector_table: u32,
    sleep: u32,
    configuration: u32,
    handlers: u32,
    coprocessors: u32,
    /// FPCCR.
    pub float_context: u32,
    /// FPCAR.
    pub float_frame: u32,
    /// FPDSCR.
    pub float_defaults: u32,
    debug: u32,
    cycle_counter: CycleCounter,
}

/// CYCCNT of the DWT.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct CycleCounter {
    counts: bool,
    /// While it counts: the offset to the core cycle. Otherwise its value.
    base: u32,
}

impl Default for SystemControl {
    fn default() -> Self {
        Self {
            auxiliary: 0,
            vector_table: 0,
            sleep: 0,
            configuration: STACK_ALIGN,
            handlers: 0,
            coprocessors: 0,
            float_context: Self::AUTOMATIC | Self::LAZY,
            float_frame: 0,
            float_defaults: 0,
            debug: 0,
            cycle_counter: CycleCounter::default(),
        }
    }
}

// ACTLR
const NO_WRITE_BUFFER: u32 = 1 << 1;
// SCR
const SLEEP_ON_EXIT: u32 = 1 << 1;
const EVENT_ON_PEND: u32 = 1 << 4;
// CCR
const NON_BASE_THREAD: u32 = 1;
const USER_SETS_PENDING: u32 = 1 << 1;
const TRAP_UNALIGNED: u32 = 1 << 3;
const TRAP_DIVIDE: u32 = 1 << 4;
const STACK_ALIGN: u32 = 1 << 9;
// DEMCR
const MONITOR_ENABLE: u32 = 1 << 16;
const TRACE_ENABLE: u32 = 1 << 24;

impl SystemControl {
    /// FPCCR.ASPEN.
    pub const AUTOMATIC: u32 = 1 << 31;
    /// FPCCR.LSPEN.
    pub const LAZY: u32 = 1 << 30;
    /// FPCCR.LSPACT.
    pub const LAZY_ACTIVE: u32 = 1;

    pub fn vector_table(&self) -> u32 {
        self.vector_table
    }

    pub fn buffers_writes(&self) -> bool {
        self.auxiliary & NO_WRITE_BUFFER == 0
    }

    pub fn sleeps_on_exit(&self) -> bool {
        self.sleep & SLEEP_ON_EXIT != 0
    }

    pub fn has_event_on_pend(&self) -> bool {
        self.sleep & EVENT_ON_PEND != 0
    }

    pub fn allows_non_base_thread(&self) -> bool {
        self.configuration & NON_BASE_THREAD != 0
    }

    pub fn traps_unaligned(&self) -> bool {
        self.configuration & TRAP_UNALIGNED != 0
    }

    pub fn traps_division_by_zero(&self) -> bool {
        self.configuration & TRAP_DIVIDE != 0
    }

    pub fn aligns_stack(&self) -> bool {
        self.configuration & STACK_ALIGN != 0
    }

    /// Returns true if the fault has its own enabled handler. Otherwise it escalates to HardFault.
    pub fn handles(&self, exception: u16) -> bool {
        match exception {
            MEM_MANAGE => self.handlers >> 16 & 1 == 1,
            BUS_FAULT => self.handlers >> 17 & 1 == 1,
            USAGE_FAULT => self.handlers >> 18 & 1 == 1,
            DEBUG_MONITOR => self.debug & MONITOR_ENABLE != 0,
            _ => true,
        }
    }

    /// Returns true if CPACR allows FPU access at this privilege.
    pub fn float_is_on(&self, privileged: bool) -> bool {
        match self.coprocessors >> 20 & 15 {
            0b1111 => true,
            0b0101 => privileged,
            _ => false,
        }
    }

    pub fn lazy_frame_is_due(&self) -> bool {
        self.float_context & Self::LAZY_ACTIVE != 0
    }
}

/// A register of the private peripheral bus.
enum Register {
    DwtControl,
    CycleCount,
    Unlock,
    ControllerType,
    Auxiliary,
    SysTick(u32),
    /// ISER and ICER, by first exception. The flag tells whether writing a one enables or disables.
    Enabled(u16, bool),
    /// ISPR and ICPR, in the same form.
    Pending(u16, bool),
    Active(u16),
    /// IPR and SHPR, by first exception.
    Priority(u16),
    Identity(u32),
    InterruptControl,
    VectorTable,
    ResetControl,
    Sleep,
    Configuration,
    Handlers,
    FaultStatus,
    HardFaultStatus,
    DebugFaultStatus,
    MemoryFaultAddress,
    BusFaultAddress,
    Coprocessors,
    DebugHalt,
    DebugMonitor,
    SoftwareTrigger,
    FloatContext,
    FloatFrame,
    FloatDefaults,
}

impl Register {
    fn at(address: u32) -> Option<Self> {
        let group = ((address & 0x7F) * 8) as u16 + INTERRUPT_0;
        Some(match address {
            0xE000_1000 => Self::DwtControl,
            0xE000_1004 => Self::CycleCount,
            0xE000_1FB0 => Self::Unlock,
            0xE000_E004 => Self::ControllerType,
            0xE000_E008 => Self::Auxiliary,
            0xE000_E010..=0xE000_E01C => Self::SysTick(address - 0xE000_E010),
            0xE000_E100..=0xE000_E11C => Self::Enabled(group, true),
            0xE000_E180..=0xE000_E19C => Self::Enabled(group, false),
            0xE000_E200..=0xE000_E21C => Self::Pending(group, true),
            0xE000_E280..=0xE000_E29C => Self::Pending(group, false),
            0xE000_E300..=0xE000_E31C => Self::Active(group),
            0xE000_E400..=0xE000_E4EC => {
                Self::Priority((address - 0xE000_E400) as u16 + INTERRUPT_0)
            }
            // CPUID: Cortex-M4 r0p1.
            0xE000_ED00 => Self::Identity(0x410F_C241),
            0xE000_ED04 => Self::InterruptControl,
            0xE000_ED08 => Self::VectorTable,
            0xE000_ED0C => Self::ResetControl,
            0xE000_ED10 => Self::Sleep,
            0xE000_ED14 => Self::Configuration,
            0xE000_ED18..=0xE000_ED20 => Self::Priority((address - 0xE000_ED18) as u16 + 4),
            0xE000_ED24 => Self::Handlers,
            0xE000_ED28 => Self::FaultStatus,
            0xE000_ED2C => Self::HardFaultStatus,
            0xE000_ED30 => Self::DebugFaultStatus,
            0xE000_ED34 => Self::MemoryFaultAddress,
            0xE000_ED38 => Self::BusFaultAddress,
            0xE000_ED88 => Self::Coprocessors,
            0xE000_EDF0 => Self::DebugHalt,
            0xE000_EDFC => Self::DebugMonitor,
            0xE000_EF00 => Self::SoftwareTrigger,
            0xE000_EF34 => Self::FloatContext,
            0xE000_EF38 => Self::FloatFrame,
            0xE000_EF3C => Self::FloatDefaults,
            // MVFR0 and MVFR1: single precision only.
            0xE000_EF40 => Self::Identity(0x1011_0021),
            0xE000_EF44 => Self::Identity(0x1100_0011),
            _ => return None,
        })
    }
}

/// Name of the block at an address of the private peripheral bus.
fn name(address: u32) -> String {
    let (block, base) = match address >> 12 {
        0xE0000 => ("ITM", 0xE000_0000),
        0xE0001 => ("DWT", 0xE000_1000),
        0xE0002 => ("FPB", 0xE000_2000),
        0xE000E if (0xE000_ED90..0xE000_EDF0).contains(&address) => ("MPU", 0xE000_ED90),
        0xE000E => ("SCS", 0xE000_E000),
        0xE0040 => ("TPIU", 0xE004_0000),
        0xE0041 => ("ETM", 0xE004_1000),
        _ => ("PPB", 0xE000_0000),
    };
    format!("{block} + {:#x}", address - base)
}

/// Implemented lines among the 32 from exception `first`, as bits.
fn implemented(first: u16) -> u32 {
    let lines = (INTERRUPT_0 + LINES).saturating_sub(first).min(32);
    ((1_u64 << lines) - 1) as u32
}

fn each(first: u16, bits: u32) -> impl Iterator<Item = u16> {
    (0..32)
        .filter(move |i| bits >> i & 1 == 1)
        .map(move |i| first + i)
}

impl Cpu {
    pub(super) fn read_private(&mut self, address: u32, width: Width) -> Result<u32, Trapped> {
        if !self.privileged() {
            return Err(self.fault(Fault::PreciseBus(address)));
        }
        self.check_aligned(address, width)?;
        let word = self
            .read_register(address & !3)
            .ok_or_else(|| self.unmodelled(name(address), address, width, None))?;
        let value = word >> (address % 4 * 8);
        Ok(match width {
            Width::Byte => value & 0xFF,
            Width::Half => value & 0xFFFF,
            Width::Word => value,
        })
    }

    pub(super) fn write_private(
        &mut self,
        address: u32,
        width: Width,
        value: u32,
    ) -> Result<(), Trapped> {
        let allowed = self.privileged()
            || address == 0xE000_EF00 && self.system.configuration & USER_SETS_PENDING != 0;
        if !allowed {
            return Err(self.fault(Fault::PreciseBus(address)));
        }
        self.check_aligned(address, width)?;
        self.write_register(address, width, value)
            .ok_or_else(|| self.unmodelled(name(address), address, width, Some(value)))?;
        self.attend_soon();
        Ok(())
    }

    fn read_register(&mut self, address: u32) -> Option<u32> {
        let exceptions = &self.exceptions;
        let cycle = self.signals.cycle;
        let register = Register::at(address)?;
        Some(match register {
            // The DWT has four comparators.
            Register::DwtControl => 0x4000_0000 | u32::from(self.system.cycle_counter.counts),
            Register::CycleCount => self.cycle_count(),
            Register::ControllerType => u32::from((LINES - 1) / 32),
            Register::Auxiliary => self.system.auxiliary,
            Register::SysTick(offset) => self.systick.read(offset, cycle)?,
            Register::Enabled(first, _) => exceptions.enabled.word(first) & implemented(first),
            Register::Pending(first, _) => exceptions.pending.word(first) & implemented(first),
            Register::Active(first) => exceptions.active.word(first) & implemented(first),
            Register::Priority(first) => {
                u32::from_le_bytes([0, 1, 2, 3].map(|i| exceptions.priority_byte(first + i)))
            }
            Register::Identity(value) => value,
            Register::InterruptControl => self.interrupt_control(),
            Register::VectorTable => self.system.vector_table,
            Register::ResetControl => 0xFA05_0000 | u32::from(exceptions.group) << 8,
            Register::Sleep => self.system.sleep,
            Register::Configuration => self.system.configuration,
            Register::Handlers => self.handler_state(),
            Register::FaultStatus => self.faults.configurable,
            Register::HardFaultStatus => self.faults.hard,
            Register::DebugFaultStatus | Register::DebugHalt => 0,
            Register::MemoryFaultAddress => self.faults.memory_address,
            Register::BusFaultAddress => self.faults.bus_address,
            Register::Coprocessors => self.system.coprocessors,
            Register::DebugMonitor => self.system.debug,
            Register::FloatContext => self.system.float_context,
            Register::FloatFrame => self.system.float_frame,
            Register::FloatDefaults => self.system.float_defaults,
            Register::Unlock | Register::SoftwareTrigger => return None,
        })
    }

    fn write_register(&mut self, address: u32, width: Width, value: u32) -> Option<()> {
        let cycle = self.signals.cycle;
        let register = Register::at(address & !3)?;
        if let Register::Priority(first) = register {
            let bytes = value.to_le_bytes();
            for (i, &byte) in (0..).zip(&bytes[..width.bytes() as usize]) {
                let number = first + (address % 4) as u16 + i;
                if number < INTERRUPT_0 + LINES {
                    self.exceptions.set_priority_byte(number, byte);
                }
            }
            self.update_priority();
            return Some(());
        }
        if width != Width::Word {
            return None;
        }
        match register {
            Register::DwtControl if value & !1 == 0 => {
                let now = self.cycle_count();
                self.system.cycle_counter.counts = value & 1 == 1;
                self.set_cycle_count(now);
            }
            Register::CycleCount => self.set_cycle_count(value),
            Register::Unlock | Register::DebugHalt => {}
            Register::Auxiliary => self.system.auxiliary = value,
            Register::SysTick(offset) => self.systick.write(offset, value, cycle)?,
            Register::Enabled(first, on) => {
                for number in each(first, value & implemented(first)) {
                    self.exceptions.enabled.set(number, on);
                }
            }
            Register::Pending(first, on) => {
                for number in each(first, value & implemented(first)) {
                    if on {
                        self.exceptions.pend(number, cycle);
                    } else {
                        let held =
                            self.line_is_high(number) && !self.exceptions.active.contains(number);
                        self.exceptions.pending.set(number, held);
                    }
                }
            }
            Register::InterruptControl => self.set_interrupt_control(value),
            Register::VectorTable => self.system.vector_table = value & 0x3FFF_FF80,
            Register::ResetControl => return self.set_reset_control(value),
            Register::Sleep => self.system.sleep = value & (SLEEP_ON_EXIT | EVENT_ON_PEND | 4),
            Register::Configuration => {
                // BFHFNMIGN is not modelled. It would let a handler test whether an address is mapped.
                const MODELLED: u32 = NON_BASE_THREAD
                    | USER_SETS_PENDING
                    | TRAP_UNALIGNED
                    | TRAP_DIVIDE
                    | STACK_ALIGN;
                if value & !MODELLED != 0 {
                    return None;
                }
                self.system.configuration = value;
            }
            Register::Handlers => {
                const ENABLES: u32 = 7 << 16;
                if (value ^ self.handler_state()) & !ENABLES != 0 {
                    return None;
                }
                self.system.handlers = value & ENABLES;
            }
            Register::FaultStatus => self.faults.configurable &= !value,
            Register::HardFaultStatus => self.faults.hard &= !value,
            Register::DebugFaultStatus => {}
            Register::MemoryFaultAddress => self.faults.memory_address = value,
            Register::BusFaultAddress => self.faults.bus_address = value,
            Register::Coprocessors => {
                self.system.coprocessors = value & 0x00F0_0000;
                self.float.ready = false;
            }
            Register::DebugMonitor if value & !(TRACE_ENABLE | MONITOR_ENABLE) == 0 => {
                self.system.debug = value;
            }
            Register::SoftwareTrigger => {
                let number = (value & 0x1FF) as u16 + INTERRUPT_0;
                if number < INTERRUPT_0 + LINES {
                    self.exceptions.pend(number, cycle);
                }
            }
            Register::FloatContext => {
                const CONTROLS: u32 = SystemControl::AUTOMATIC | SystemControl::LAZY;
                let state = self.system.float_context & !(CONTROLS | SystemControl::LAZY_ACTIVE);
                self.system.float_context = state | value & (CONTROLS | SystemControl::LAZY_ACTIVE);
                self.float.ready = false;
            }
            Register::FloatFrame => self.system.float_frame = value & !7,
            Register::FloatDefaults => self.system.float_defaults = value & 0x07C0_0000,
            _ => return None,
        }
        Some(())
    }

    fn interrupt_control(&self) -> u32 {
        let exceptions = &self.exceptions;
        let first = exceptions.next().map_or(0, |(number, _)| number);
        let interrupt = (INTERRUPT_0..INTERRUPT_0 + LINES).any(|n| exceptions.pending.contains(n));
        let pending = |number| u32::from(exceptions.pending.contains(number));
        let returns_to_base = self.exception != 0 && exceptions.active.len() == 1;
        u32::from(self.exception)
            | u32::from(returns_to_base) << 11
            | u32::from(first) << 12
            | u32::from(interrupt) << 22
            | pending(SYSTICK) << 26
            | pending(PENDSV) << 28
            | pending(NMI) << 31
    }

    fn set_interrupt_control(&mut self, value: u32) {
        let cycle = self.signals.cycle;
        for (set, clear, number) in [
            (31, None, NMI),
            (28, Some(27), PENDSV),
            (26, Some(25), SYSTICK),
        ] {
            if value >> set & 1 == 1 {
                self.exceptions.pend(number, cycle);
            } else if clear.is_some_and(|at| value >> at & 1 == 1) {
                self.exceptions.pending.set(number, false);
            }
        }
    }

    fn set_reset_control(&mut self, value: u32) -> Option<()> {
        const KEY: u32 = 0x05FA;
        const SYSTEM_RESET: u32 = 1 << 2;
        if value >> 16 != KEY {
            return Some(());
        }
        if value & 3 != 0 {
            return None;
        }
        self.exceptions.group = (value >> 8 & 7) as u8;
        self.update_priority();
        if value & SYSTEM_RESET != 0 {
            self.halted = Some(Stop::Reset);
        }
        Some(())
    }

    /// SHCSR.
    fn handler_state(&self) -> u32 {
        let active = |number, at: u32| u32::from(self.exceptions.active.contains(number)) << at;
        let pending = |number, at: u32| u32::from(self.exceptions.pending.contains(number)) << at;
        self.system.handlers
            | active(MEM_MANAGE, 0)
            | active(BUS_FAULT, 1)
            | active(USAGE_FAULT, 3)
            | active(SVCALL, 7)
            | active(DEBUG_MONITOR, 8)
            | active(PENDSV, 10)
            | active(SYSTICK, 11)
            | pending(USAGE_FAULT, 12)
            | pending(MEM_MANAGE, 13)
            | pending(BUS_FAULT, 14)
            | pending(SVCALL, 15)
    }

    /// CYCCNT. It stops while the core sleeps.
    fn cycle_count(&self) -> u32 {
        let counter = self.system.cycle_counter;
        if counter.counts {
            self.awake_cycles().wrapping_add(counter.base)
        } else {
            counter.base
        }
    }

    fn set_cycle_count(&mut self, value: u32) {
        self.system.cycle_counter.base = if self.system.cycle_counter.counts {
            value.wrapping_sub(self.awake_cycles())
        } else {
            value
        };
    }

    fn awake_cycles(&self) -> u32 {
        (self.signals.cycle - self.slept) as u32
    }
}
