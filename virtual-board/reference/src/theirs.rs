//! Unicorn, which is QEMU's translator without its machines.

use unicorn_engine::{Arch, ArmCpuModel, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::machine::{Machine, RAM, SIZE};
use crate::outcome::Outcome;
use crate::state::{FLAGS, State};
use crate::words::Trial;

pub struct Theirs {
    unicorn: Unicorn<'static, ()>,
    fresh: unicorn_engine::Context,
    memory: Vec<u8>,
}

const CORE: [RegisterARM; 15] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R4,
    RegisterARM::R5,
    RegisterARM::R6,
    RegisterARM::R7,
    RegisterARM::R8,
    RegisterARM::R9,
    RegisterARM::R10,
    RegisterARM::R11,
    RegisterARM::R12,
    RegisterARM::SP,
    RegisterARM::LR,
];

fn double(number: usize) -> i32 {
    i32::from(RegisterARM::D0) + number as i32
}

impl Theirs {
    pub fn new(memory: &[u8]) -> Result<Self, Box<dyn std::error::Error>> {
        let fail = |error| format!("Unicorn: {error:?}");
        let mut unicorn = Unicorn::new(Arch::ARM, Mode::THUMB | Mode::MCLASS).map_err(fail)?;
        unicorn
            .ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .map_err(fail)?;
        unicorn
            .mem_map(RAM.into(), SIZE as u64, Prot::ALL)
            .map_err(fail)?;
        unicorn.mem_write(RAM.into(), memory).map_err(fail)?;
        // The first FPU instruction of a context resets the FPU state. This is VMOV S0, S0.
        const PLACE: u64 = (RAM as usize + SIZE - 8) as u64;
        unicorn
            .mem_write(PLACE, &[0xB0, 0xEE, 0x40, 0x0A])
            .map_err(fail)?;
        unicorn.emu_start(PLACE | 1, 0, 0, 1).map_err(fail)?;
        unicorn
            .mem_write(PLACE, &memory[SIZE - 8..SIZE - 4])
            .map_err(fail)?;
        let mut fresh = unicorn.context_alloc().map_err(fail)?;
        unicorn.context_save(&mut fresh).map_err(fail)?;
        Ok(Self {
            unicorn,
            fresh,
            memory: memory.to_vec(),
        })
    }

    fn run(&mut self, trial: &Trial, address: u32, state: &State) -> Result<Outcome, uc_error> {
        let unicorn = &mut self.unicorn;
        // A translation can outlive a change of the code at its address.
        unicorn.ctl_flush_tb()?;
        let code = trial.code();
        let at = (address - RAM) as usize;
        let place = at..at + code.len();
        unicorn.mem_write(address.into(), &code)?;
        unicorn.context_restore(&self.fresh)?;
        for (register, &value) in CORE.into_iter().zip(&state.registers) {
            unicorn.reg_write(register, value.into())?;
        }
        unicorn.reg_write(RegisterARM::APSR_NZCVQG, state.flags.into())?;
        for (number, pair) in state.floats.chunks_exact(2).enumerate() {
            let bits = u64::from(pair[1]) << 32 | u64::from(pair[0]);
            unicorn.reg_write(double(number), bits)?;
        }
        unicorn.reg_write(RegisterARM::FPSCR, state.float_status.into())?;
        // Unicorn counts IT and the instruction in its block as one.
        let ran = unicorn.emu_start(u64::from(address | 1), 0, 0, 1);
        unicorn.mem_write(address.into(), &self.memory[place])?;
        let mut memory = vec![0; SIZE];
        unicorn.mem_read(RAM.into(), &mut memory)?;
        let changed = memory != self.memory;
        if changed {
            unicorn.mem_write(RAM.into(), &self.memory)?;
        }
        let pc = unicorn.reg_read(RegisterARM::PC)? as u32;
        // A jump to an unmapped address has still been executed.
        let jumped = !(RAM..RAM + SIZE as u32).contains(&pc);
        let thumb = unicorn.reg_read(RegisterARM::XPSR)? >> 24 & 1 == 1;
        if ran.is_err() && !jumped || !thumb {
            return Ok(Outcome::Fault);
        }
        let mut registers = [0; 15];
        for (register, value) in CORE.into_iter().zip(&mut registers) {
            *value = unicorn.reg_read(register)? as u32;
        }
        let mut floats = [0; 32];
        for (number, pair) in floats.chunks_exact_mut(2).enumerate() {
            let bits = unicorn.reg_read(double(number))?;
            pair.copy_from_slice(&[bits as u32, (bits >> 32) as u32]);
        }
        Ok(Outcome::Done {
            state: Box::new(State {
                registers,
                flags: unicorn.reg_read(RegisterARM::APSR)? as u32 & FLAGS,
                floats,
                float_status: unicorn.reg_read(RegisterARM::FPSCR)? as u32,
            }),
            pc,
            memory: changed.then_some(memory),
        })
    }
}

impl Machine for Theirs {
    fn execute(
        &mut self,
        trial: &Trial,
        address: u32,
        state: &State,
    ) -> Result<Outcome, Box<dyn std::error::Error>> {
        self.run(trial, address, state)
            .map_err(|error| format!("Unicorn: {error:?} at {trial}").into())
    }
}
