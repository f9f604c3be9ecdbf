//! Reports of faults and panics across a reset. The bridge is turned off first. A record is then written to memory that
//! survives the reset.
//!
//! Afterwards the processor waits until the watchdog resets it or a debugger inspects it.
#![expect(
    unsafe_code,
    reason = "exception entry without a stack, and memory that outlives a reset"
)]

use core::cell::UnsafeCell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use haptic_paddle::safety::{FaultLog, FaultRecord, ResetCause, WORDS_PER_RECORD};
use stm32f4xx_hal::pac::RCC;

use crate::board;

/// Marks a valid record, to tell it from random RAM content at power-on.
const WRITTEN: u32 = 0x1A57_D0ED;
const TEXT_BYTES: usize = 160;

struct Record {
    mark: u32,
    length: usize,
    text: [u8; TEXT_BYTES],
}

/// The record, in memory that the start-up code does not initialise.
struct Keep(UnsafeCell<MaybeUninit<Record>>);

// SAFETY: it is written only by code that never returns and that only similar code can preempt. It is read only at boot.
unsafe impl Sync for Keep {}

#[unsafe(link_section = ".uninit.last_words")]
static KEEP: Keep = Keep(UnsafeCell::new(MaybeUninit::uninit()));

/// The stored faults, with a checksum.
struct Faults {
    mark: u32,
    length: u32,
    records: [[u32; WORDS_PER_RECORD]; FaultLog::CAPACITY],
    check: u32,
}

impl Faults {
    /// Checksum of the words.
    fn sum(&self) -> u32 {
        let words = self.records.iter().flatten();
        words.fold(self.length, |sum, word| {
            sum.rotate_left(5).wrapping_add(*word)
        })
    }
}

/// The stored faults, in memory that the start-up code does not initialise.
struct KeepFaults(UnsafeCell<MaybeUninit<Faults>>);

// SAFETY: it is read at boot before tasks begin, and written by the control interrupt only.
unsafe impl Sync for KeepFaults {}

#[unsafe(link_section = ".uninit.faults")]
static KEEP_FAULTS: KeepFaults = KeepFaults(UnsafeCell::new(MaybeUninit::uninit()));

/// Stores the faults so that they survive a reset. Only the control interrupt calls it.
#[cold]
pub fn keep_faults(log: &FaultLog) {
    // SAFETY: see `KeepFaults`. Any bit pattern is a valid `Faults`.
    let kept = unsafe { (*KEEP_FAULTS.0.get()).assume_init_mut() };
    kept.mark = 0;
    kept.records = Default::default();
    for (words, record) in kept.records.iter_mut().zip(log.iter()) {
        *words = record.to_words();
    }
    kept.length = log.len() as u32;
    kept.check = kept.sum();
    kept.mark = WRITTEN;
}

/// The faults from before the reset, with the cause of the reset. It is called at boot only.
pub fn recall_faults() -> FaultLog {
    // SAFETY: the start-up code has ended, tasks have not begun, and any bit pattern is a valid `Faults`.
    let kept = unsafe { (*KEEP_FAULTS.0.get()).assume_init_ref() };
    let mut log = FaultLog::default();
    log.reset = Some(reset_cause());
    if kept.mark == WRITTEN && kept.check == kept.sum() {
        for words in kept.records.iter().take(kept.length as usize) {
            if let Some(record) = FaultRecord::from_words(*words) {
                log.push(FaultRecord {
                    before_reset: true,
                    ..record
                });
                // Each stored fault is a first cause of its own.
                log.clear();
            }
        }
    }
    log
}

/// Reads the cause of the last reset and clears the flags.
fn reset_cause() -> ResetCause {
    // SAFETY: no other code uses this register.
    let rcc = unsafe { RCC::steal() };
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    // Every reset also sets the pin flag, and a power-on also sets the brown-out flag.
    if flags.wdgrstf().bit() || flags.wwdgrstf().bit() {
        ResetCause::Watchdog
    } else if flags.sftrstf().bit() {
        ResetCause::Software
    } else if flags.porrstf().bit() {
        ResetCause::Power
    } else if flags.borrstf().bit() {
        ResetCause::BrownOut
    } else {
        ResetCause::Pin
    }
}

impl Write for Record {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            let slot = self.text.get_mut(self.length).ok_or(fmt::Error)?;
            *slot = byte;
            self.length += 1;
        }
        Ok(())
    }
}

/// Writes to the console and the log why the last run ended, and invalidates the record.
pub fn report(reset: Option<ResetCause>, console: &mut impl Write) {
    // SAFETY: the start-up code has ended, tasks have not begun, and any bit pattern is a valid `Record`.
    let record = unsafe { (*KEEP.0.get()).assume_init_mut() };
    if record.mark == WRITTEN {
        let text = record.text.get(..record.length).unwrap_or_default();
        let text = core::str::from_utf8(text).unwrap_or("(not readable)");
        defmt::error!("before the reset: {}", text);
        let _ = write!(console, "before the reset: {text}\r\n");
    } else if reset == Some(ResetCause::Watchdog) {
        defmt::error!("reset by the watchdog: the program was stuck");
        let _ = write!(console, "reset by the watchdog: the program was stuck\r\n");
    } else if let Some(cause) = reset.filter(|cause| *cause != ResetCause::Power) {
        defmt::warn!("reset by {}", defmt::Display2Format(&cause));
        let _ = write!(console, "reset by {cause}\r\n");
    }
    record.mark = 0;
}

/// Stores the message and stops the processor.
fn stop(message: fmt::Arguments) -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: see `Keep`.
    let record = unsafe { (*KEEP.0.get()).assume_init_mut() };
    record.length = 0;
    // A long message is cut. Its beginning names the place.
    let _ = record.write_fmt(message);
    record.mark = WRITTEN;
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    board::bridge_off();
    stop(format_args!("{info}"))
}

/// Handler of every exception and interrupt without a handler of its own. The stack may be corrupt. The code therefore turns
/// the bridge off without using the stack, and then sets up a new one.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn DefaultHandler() {
    core::arch::naked_asm!(
        "movw r1, #{register_low}",
        "movt r1, #{register_high}",
        "mov.w r2, #{pins_low}",
        "str r2, [r1]",
        "mrs r0, msp",
        "ldr r1, =_stack_start",
        "msr msp, r1",
        "b {rest}",
        register_low = const board::ENABLE_BSRR & 0xFFFF,
        register_high = const board::ENABLE_BSRR >> 16,
        pins_low = const board::ENABLE_OFF,
        rest = sym unserved,
    )
}

/// A fault of the processor. It is handled like every other unserved exception.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn HardFault() {
    core::arch::naked_asm!("b {handler}", handler = sym DefaultHandler)
}

/// Reports the exception. `frame` is the former stack pointer, at the registers that the processor has stacked.
extern "C" fn unserved(frame: *const u32) -> ! {
    /// Index of pc in the stacked r0 to r3, r12, lr, pc, xpsr.
    const PROGRAM_COUNTER: usize = 6;
    // SAFETY: these registers are only read.
    let scb = unsafe { &*SCB::PTR };
    let exception = scb.icsr.read() & 0x1FF;
    let at = if board::RAM.contains(&(frame as usize)) && frame.is_aligned() {
        // SAFETY: the condition ensures that the address is aligned and inside RAM.
        unsafe { frame.add(PROGRAM_COUNTER).read_volatile() }
    } else {
        0
    };
    stop(format_args!(
        "exception {exception} at {at:#010x}, CFSR {:#010x}, HFSR {:#x}, MMFAR {:#010x}, BFAR {:#010x}",
        scb.cfsr.read(),
        scb.hfsr.read(),
        scb.mmfar.read(),
        scb.bfar.read(),
    ))
}
