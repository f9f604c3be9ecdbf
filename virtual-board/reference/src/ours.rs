//! The virtual processor core.

use virtual_board::cpu::{Bus, Cpu, Memories, Refusal, Signals, Stop, Unmodelled, Width};

use crate::machine::{DATA, Machine, RAM, SIZE};
use crate::outcome::Outcome;
use crate::state::{FLAGS, State};
use crate::words::Trial;

pub struct Ours {
    cpu: Cpu,
    board: Board,
    data: Vec<u8>,
}

/// Memories and nothing else.
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
        let mut memories = Memories::new(24, SIZE, 0);
        // Vectors, and code that turns the FPU on: LDR R0, [PC, #4]; LDR R1, [PC, #8]; STR R1, [R0]; B .
        memories.flash_mut()[..8].copy_from_slice(&[0, 0x20, 0, 0x20, 9, 0, 0, 8]);
        memories.flash_mut()[8..16].copy_from_slice(&[1, 0x48, 2, 0x49, 1, 0x60, 0xFE, 0xE7]);
        memories.flash_mut()[16..24].copy_from_slice(&[0x88, 0xED, 0, 0xE0, 0, 0, 0xF0, 0]);
        let mut board = Board(memories);
        let mut cpu = Cpu::new();
        cpu.reset(&mut board);
        assert_eq!(cpu.run(&mut board, 50), Stop::Deadline, "the FPU goes on");
        // From here on there is no flash, which Unicorn does not have either.
        board.0 = Memories::new(0, SIZE, 0);
        board.0.sram.copy_from_slice(memory);
        Self {
            cpu,
            board,
            data: memory[DATA].to_vec(),
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
        let before = self.board.0.sram[place.clone()].to_vec();
        self.board.0.sram[place.clone()].copy_from_slice(&code);
        let outcome = self.run(trial, address, state);
        self.board.0.sram[place].copy_from_slice(&before);
        outcome
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
        // The first instruction of the FPU in a context would reset it.
        prime_float(&mut cpu, &mut self.board, address);
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
                self.board.0.sram[DATA].copy_from_slice(&self.data);
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
        let memory = &mut self.board.0.sram[DATA];
        let changed = (memory != self.data).then(|| memory.to_vec());
        memory.copy_from_slice(&self.data);
        Ok(Outcome::Done {
            state: Box::new(State {
                registers,
                flags: cpu.program_status() & FLAGS,
                floats,
                float_status: cpu.float_status(),
            }),
            pc: cpu.register(15),
            memory: changed,
        })
    }
}

/// Lets the core execute VMOV S0, S0 from another place.
fn prime_float(cpu: &mut Cpu, board: &mut Board, address: u32) {
    const PLACE: usize = SIZE - 4;
    board.0.sram[PLACE..].copy_from_slice(&[0xB0, 0xEE, 0x40, 0x0A]);
    cpu.set_register(15, RAM + PLACE as u32);
    let next = cpu.signals.cycle() + 1;
    let stop = cpu.run(board, next);
    debug_assert_eq!(stop, Stop::Deadline);
    cpu.set_register(15, address);
}
