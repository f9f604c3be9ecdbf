//! A test bench for the core: code in flash, RAM, and one device with an interrupt line.

mod exceptions;
mod faults;
mod instructions;
mod time;

use super::{Bus, Cpu, Memories, Refusal, Signals, Stop, Width};

/// Address of `Bench::main`.
const MAIN: u32 = 0x0800_0400;
/// Top of the stack.
const STACK: u32 = 0x2000_1000;
/// Address of a device. Writing it sets the level of interrupt line 1. It reads as the last written value.
const DEVICE: u32 = 0x4000_0000;
/// Address of a device that the board does not model.
const UNMODELLED: u32 = 0x4000_0100;
/// An unmapped address.
const NOWHERE: u32 = 0x6000_0000;

const SELF_LOOP: u16 = 0xE7FE;
const NOP: u16 = 0xBF00;
const RETURN: u16 = 0x4770;
const WAIT_FOR_INTERRUPT: u16 = 0xBF30;

struct Board {
    memories: Memories,
    device: u32,
}

impl Bus for Board {
    fn memories(&mut self) -> &mut Memories {
        &mut self.memories
    }

    fn read(&mut self, address: u32, _: Width, _: &mut Signals) -> Result<u32, Refusal> {
        match address {
            DEVICE => Ok(self.device),
            UNMODELLED => Err(Refusal::Unmodelled("DEVICE + 0x100".into())),
            _ => Err(Refusal::BusFault),
        }
    }

    fn write(
        &mut self,
        address: u32,
        _: Width,
        value: u32,
        signals: &mut Signals,
    ) -> Result<(), Refusal> {
        if address != DEVICE {
            return Err(Refusal::BusFault);
        }
        self.device = value;
        signals.set_line(1, value & 1 == 1);
        Ok(())
    }
}

struct Bench {
    cpu: Cpu,
    board: Board,
}

impl Bench {
    /// A core after reset that executes `main`. The FPU is on, and each handler records its number in R7.
    fn new(main: &[u16]) -> Self {
        let board = Board {
            memories: Memories::new(0x1_0000, 0x1_0000, 0x1000),
            device: 0,
        };
        let cpu = Cpu::new();
        let mut bench = Self { cpu, board };
        bench.vector(0, STACK);
        bench.vector(1, MAIN | 1);
        for number in 2..20_u16 {
            let handler = 0x0800_0200 + u32::from(number) * 16;
            // R7 = 16 * R7 + number.
            bench.code(handler, &[0x013F, 0x3700 | number, RETURN]);
            bench.vector(number, handler | 1);
        }
        bench.code(MAIN, main);
        bench.code(MAIN + 2 * main.len() as u32, &[SELF_LOOP]);
        bench.cpu.reset(&mut bench.board);
        bench.poke(0xE000_ED88, 0x00F0_0000);
        bench
    }

    fn vector(&mut self, number: u16, address: u32) {
        let at = usize::from(number) * 4;
        self.board.memories.flash_mut()[at..at + 4].copy_from_slice(&address.to_le_bytes());
    }

    fn code(&mut self, address: u32, halfwords: &[u16]) {
        let mut at = (address - Memories::FLASH) as usize;
        for half in halfwords {
            self.board.memories.flash_mut()[at..at + 2].copy_from_slice(&half.to_le_bytes());
            at += 2;
        }
    }

    /// Replaces the handler of an exception.
    fn handler(&mut self, number: u16, code: &[u16]) {
        let at = 0x0800_1000 + u32::from(number) * 64;
        self.code(at, code);
        self.vector(number, at | 1);
    }

    /// Writes a word through the core.
    fn poke(&mut self, address: u32, value: u32) {
        let Ok(()) = self.cpu.write(&mut self.board, address, Width::Word, value) else {
            panic!("{address:#x} cannot be written");
        };
    }

    /// Reads a word through the core.
    fn peek(&mut self, address: u32) -> u32 {
        match self.cpu.read(&mut self.board, address, Width::Word) {
            Ok(value) => value,
            Err(_) => panic!("{address:#x} cannot be read"),
        }
    }

    fn enable(&mut self, line: u16, priority: u8) {
        self.poke(0xE000_E100, 1 << line);
        self.cpu.exceptions.set_priority_byte(16 + line, priority);
    }

    fn run(&mut self, cycles: u64) -> Stop {
        let until = self.cpu.signals.cycle() + cycles;
        self.cpu.run(&mut self.board, until)
    }

    /// Runs for `cycles` and checks that nothing ends the run early.
    fn go(&mut self, cycles: u64) {
        assert_eq!(self.run(cycles), Stop::Deadline);
    }

    fn r(&self, number: usize) -> u32 {
        self.cpu.register(number)
    }

    /// The handled exceptions, as hexadecimal digits.
    fn handled(&self) -> u32 {
        self.r(7)
    }
}

fn nops(count: usize) -> Vec<u16> {
    vec![NOP; count]
}
