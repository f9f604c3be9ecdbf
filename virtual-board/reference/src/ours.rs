//! The virtual processor core.

use virtual_board::cpu::{Bus, Cpu, Memories, Refusal, Signals, Stop, Unmodelled, Width};

use crate::machine::{Machine, RAM, SIZE};
use crate::outcome::Outcome;
use crate::state::{FLAGS, State};
use crate::words::Trial;

pub struct Ours {
    cpu: Cpu,
    board: Board,
    memory: Vec<u8>,
}

/// A board with memories only.
struct Board(Memories);

impl Bus for Board {
    fn memories(&mut self) -> &mut Memories {
        &mut self.0
    }

    fn read(&mut self, _: u32, _: Width, _: &mut Signals) -> Result<u32, Refusal> {
        Err(Refusal::BusFault)
    }

    fn write(&mut self, _: u32, _: Width, _: u32, _: &mut Signals) -> Result<(), Refusal> {
        Err(Refusal::BusFault)
    }
}

impl Ours {
    pub fn new(memory: &[u8]) -> Self {
        // A vector table, and code that enables the FPU and creates an FPU context.
        let mut memories = Memories::new(28, SIZE, 0);
        memories.flash_mut().copy_from_slice(&[
            0, 0x20, 0, 0x20, 9, 0, 0, 8, // SP, start
            2, 0x48, // LDR R0, CPACR
            3, 0x49, // LDR R1, full access
            1, 0x60, // STR R1, [R0]
            0xB0, 0xEE, 0x40, 0x0A, // VMOV S0, S0
            0xFE, 0xE7, // B .
            0x88, 0xED, 0, 0xE0, 0, 0, 0xF0, 0,
        ]);
        let mut board = Board(memories);
        let mut cpu = Cpu::new();
        cpu.reset(&mut board);
        assert_eq!(cpu.run(&mut board, 50), Stop::Deadline, "the FPU goes on");
        // From here on there is no flash, because Unicorn has none.
        board.0 = Memories::new(0, SIZE, 0);
        board.0.sram.copy_from_slice(memory);
        Self {
            cpu,
            board,
            memory: memory.to_vec(),
        }
    }
}

impl Machine for Ours {
    fn execute(
        &mut self,
        trial: &Trial,
        address: u32,
        state: &State,
    ) -> Result<Outcome, Box<dyn std::error::Error>> {
        let code = trial.code();
        let at = (address - RAM) as usize;
        let place = at..at + code.len();
        self.board.0.sram[place.clone()].copy_from_slice(&code);
        let mut outcome = self.run(trial, address, state)?;
        let memory = &mut self.board.0.sram;
        memory[place.clone()].copy_from_slice(&self.memory[place]);
        if let Outcome::Done {
            memory: changed, ..
        } = &mut outcome
        {
            *changed = (*memory != self.memory).then(|| memory.clone());
        }
        memory.copy_from_slice(&self.memory);
        Ok(outcome)
    }
}

impl Ours {
    fn run(
        &mut self,
        trial: &Trial,
        address: u32,
        state: &State,
    ) -> Result<Outcome, Box<dyn std::error::Error>> {
        let mut cpu = self.cpu.clone();
        for (number, &value) in state.registers.iter().enumerate() {
            cpu.set_register(number, value);
        }
        for (number, &bits) in state.floats.iter().enumerate() {
            cpu.set_float_register(number, bits);
        }
        cpu.set_register(15, address);
        cpu.set_program_status(state.flags);
        cpu.set_float_status(state.float_status);
        for _ in 0..trial.instructions() {
            let next = cpu.signals.cycle() + 1;
            match cpu.run(&mut self.board, next) {
                Stop::Deadline => {}
                Stop::Unmodelled(Unmodelled::Instruction { .. }) => {
                    return Ok(Outcome::Unpredictable);
                }
                Stop::Unmodelled(Unmodelled::Access { .. }) => return Ok(Outcome::Fault),
                stop => return Err(format!("{trial} stops with {stop:?}").into()),
            }
            let thumb = cpu.program_status() >> 24 & 1 == 1;
            if cpu.fault_status() != (0, 0) || !thumb {
                return Ok(Outcome::Fault);
            }
        }
        let mut registers = [0; 15];
        for (number, register) in registers.iter_mut().enumerate() {
            *register = cpu.register(number);
        }
        let mut floats = [0; 32];
        for (number, register) in floats.iter_mut().enumerate() {
            *register = cpu.float_register(number);
        }
        Ok(Outcome::Done {
            state: Box::new(State {
                registers,
                flags: cpu.program_status() & FLAGS,
                floats,
                float_status: cpu.float_status(),
            }),
            pc: cpu.register(15),
            memory: None,
        })
    }
}
