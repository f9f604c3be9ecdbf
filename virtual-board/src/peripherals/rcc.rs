//! Reset and clock control: oscillators, clock tree, peripheral clock gates, and reset causes.

use super::{Answer, Lack, bit, field, require};

/// The internal oscillator, Hz.
pub const HSI_HZ: f64 = 16e6;
/// The slow internal oscillator of the watchdog, Hz, nominal. The data sheet allows 17 to 47 kHz.
pub const LSI_HZ: f64 = 32e3;
/// The crystal of the board, Hz.
pub const HSE_HZ: f64 = 8e6;

/// Start-up time of the crystal, s (data sheet, typical).
const HSE_STARTUP_S: f64 = 2e-3;
/// Lock time of the main PLL, s (data sheet, typical).
const PLL_LOCK_S: f64 = 75e-6;
/// Start-up time of the slow oscillator, s (data sheet, maximum).
const LSI_STARTUP_S: f64 = 40e-6;

const CR: u32 = 0x00;
const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CIR: u32 = 0x0C;
const BDCR: u32 = 0x70;
const CSR: u32 = 0x74;

const HSION: u32 = 0;
const HSEON: u32 = 16;
const CSSON: u32 = 19;
const PLLON: u32 = 24;
const PLLI2SON: u32 = 26;
const CSSF: u32 = 7;
const CSSC: u32 = 23;
const LSION: u32 = 0;
const RMVF: u32 = 24;

/// A bus with clock gates and resets. The number is the index of its register in a register group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names of the buses")]
pub enum Bus {
    Ahb1 = 0,
    Ahb2 = 1,
    Ahb3 = 2,
    Apb1 = 4,
    Apb2 = 5,
}

/// Number of words in a register group such as AHB1RSTR to APB2RSTR.
const BANK_WORDS: usize = 6;
const RSTR: u32 = 0x10;
const ENR: u32 = 0x30;
const LPENR: u32 = 0x50;

/// Implemented bits of the reset, enable and low-power enable registers.
const RESET_FIELDS: [u32; BANK_WORDS] = [
    0x2260_11FF,
    0x0000_00C1,
    0x0000_0001,
    0,
    0x36FE_C9FF,
    0x0007_5933,
];
const ENABLE_FIELDS: [u32; BANK_WORDS] = [
    0x7E74_11FF,
    0x0000_00C1,
    0x0000_0001,
    0,
    0x36FE_C9FF,
    0x0007_5F33,
];
const LOW_POWER_FIELDS: [u32; BANK_WORDS] = [
    0x7E67_91FF,
    0x0000_00F1,
    0x0000_0001,
    0,
    0x36FE_C9FF,
    0x0007_5F33,
];

/// Implemented bits of the register at `offset` of these groups.
fn fields(offset: u32) -> u32 {
    let (bank, first) = match offset {
        LPENR.. => (&LOW_POWER_FIELDS, LPENR),
        ENR.. => (&ENABLE_FIELDS, ENR),
        _ => (&RESET_FIELDS, RSTR),
    };
    let word = offset.wrapping_sub(first) / 4;
    bank.get(word as usize).copied().unwrap_or_default()
}

/// Clock gate of a peripheral: its bus, and its bit in the enable and reset registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gate(pub Bus, pub u32);

/// Cause of a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResetCause {
    /// Power-on or a supply that was too low.
    Power,
    /// The independent watchdog expired.
    IndependentWatchdog,
    /// The image requested it.
    Software,
    /// The reset pin was pulled low.
    Pin,
    /// The supply fell below the brown-out level.
    BrownOut,
}

impl ResetCause {
    /// Flags of RCC_CSR that this cause sets.
    const fn flags(self) -> u32 {
        const BOR: u32 = 1 << 25;
        const PIN: u32 = 1 << 26;
        const POR: u32 = 1 << 27;
        const SOFTWARE: u32 = 1 << 28;
        const IWDG: u32 = 1 << 29;
        match self {
            Self::Power => BOR | PIN | POR,
            Self::IndependentWatchdog => IWDG | PIN,
            Self::Software => SOFTWARE | PIN,
            Self::Pin => PIN,
            Self::BrownOut => BOR | PIN,
        }
    }
}

/// Clock frequencies that result from the registers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clocks {
    /// Frequency of core, memories and AHB, Hz.
    pub hclk_hz: f64,
    /// Core cycles per cycle of APB1.
    pub apb1_divider: u32,
    /// Core cycles per cycle of APB2.
    pub apb2_divider: u32,
}

impl Clocks {
    /// Core cycles per clock of a timer on a bus with this divider.
    pub const fn timer_divider(bus_divider: u32) -> u32 {
        if bus_divider == 1 { 1 } else { bus_divider / 2 }
    }
}

/// RCC.
#[derive(Debug, Clone)]
pub struct Rcc {
    cr: u32,
    pllcfgr: u32,
    cfgr: u32,
    cir: u32,
    resets: [u32; BANK_WORDS],
    enables: [u32; BANK_WORDS],
    low_power_enables: [u32; BANK_WORDS],
    bdcr: u32,
    csr: u32,
    hse_ready_at: u64,
    pll_ready_at: u64,
    lsi_ready_at: u64,
    crystal_runs: bool,
}

impl Rcc {
    /// The state after a reset. The flag of the cause is added to those of `before`.
    pub fn reset(cause: ResetCause, before: Option<&Self>) -> Self {
        const CAUSES: u32 = 0xFE00_0000;
        let known = match (cause, before) {
            (ResetCause::Power, _) | (_, None) => 0,
            (_, Some(before)) => before.csr & CAUSES,
        };
        Self {
            cr: 0x0000_0083,
            pllcfgr: 0x2400_3010,
            cfgr: 0,
            cir: 0,
            resets: [0; BANK_WORDS],
            enables: [0x0010_0000, 0, 0, 0, 0, 0],
            low_power_enables: [0x7E67_91FF, 0xF1, 0x1, 0, 0x36FE_C9FF, 0x0007_5F33],
            bdcr: 0,
            csr: known | cause.flags(),
            hse_ready_at: 0,
            pll_ready_at: 0,
            lsi_ready_at: 0,
            crystal_runs: before.is_none_or(|before| before.crystal_runs),
        }
    }

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Answer<u32> {
        let ready = |on: bool, at: u64, place: u32| u32::from(on && now >= at) << place;
        Ok(match offset {
            CR => {
                self.cr
                    | ready(
                        self.on(HSEON) && self.crystal_runs,
                        self.hse_ready_at,
                        HSEON + 1,
                    )
                    | ready(self.on(PLLON), self.pll_ready_at, PLLON + 1)
            }
            PLLCFGR => self.pllcfgr,
            // The clock switch is immediate: SWS equals SW.
            CFGR => self.cfgr | (self.cfgr & 0b11) << 2,
            CIR => self.cir,
            BDCR => self.bdcr,
            CSR => self.csr | ready(bit(self.csr, LSION), self.lsi_ready_at, LSION + 1),
            _ => *self.bank(offset)?,
        })
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Answer {
        let hclk_hz = self.clocks().hclk_hz;
        let after = |seconds: f64| now + (seconds * hclk_hz) as u64;
        match offset {
            CR => {
                require(bit(value, HSION), "switching the internal oscillator off")?;
                require(!bit(value, PLLI2SON), "the I2S PLL")?;
                let rises = value & !self.cr;
                if bit(rises, HSEON) {
                    self.hse_ready_at = after(HSE_STARTUP_S);
                }
                if bit(rises, PLLON) {
                    self.pll_ready_at = after(PLL_LOCK_S);
                }
                const READY: u32 = 1 << 1 | 1 << (HSEON + 1) | 1 << (PLLON + 1);
                const FIELDS: u32 = 0x050D_00F9;
                self.cr = value & FIELDS & !READY | 1 << 1;
            }
            PLLCFGR => {
                require(
                    !self.on(PLLON) || value == self.pllcfgr,
                    "a change while the PLL runs",
                )?;
                // Bit 29 is reserved and set.
                self.pllcfgr = value & 0x0F43_7FFF | 1 << 29;
            }
            CFGR => {
                let ready = match value & 0b11 {
                    0 => true,
                    1 => self.on(HSEON) && now >= self.hse_ready_at && self.crystal_runs,
                    2 => self.on(PLLON) && now >= self.pll_ready_at,
                    _ => false,
                };
                require(ready, "a switch to a clock that is not ready")?;
                const RESERVED: u32 = 0b11 << 8;
                self.cfgr = value & !(0b1100 | RESERVED);
            }
            CIR => {
                const ENABLES: u32 = 0x3F00;
                require(value & ENABLES == 0, "interrupts of the clocks")?;
                if bit(value, CSSC) {
                    self.cir &= !(1 << CSSF);
                }
            }
            BDCR => return Err(Lack::Register),
            CSR => {
                if bit(value & !self.csr, LSION) {
                    self.lsi_ready_at = after(LSI_STARTUP_S);
                }
                if bit(value, RMVF) {
                    self.csr = 0;
                }
                self.csr = self.csr & !(1 << LSION) | value & 1 << LSION;
            }
            _ => {
                let fields = fields(offset);
                *self.bank(offset)? = value & fields;
            }
        }
        Ok(())
    }

    fn on(&self, place: u32) -> bool {
        bit(self.cr, place)
    }

    fn bank(&mut self, offset: u32) -> Answer<&mut u32> {
        let (bank, first) = match offset {
            LPENR.. => (&mut self.low_power_enables, LPENR),
            ENR.. => (&mut self.enables, ENR),
            _ => (&mut self.resets, RSTR),
        };
        let word = offset.wrapping_sub(first) / 4;
        // The fourth word of each group does not exist.
        match bank.get_mut(word as usize) {
            Some(register) if word != 3 => Ok(register),
            _ => Err(Lack::Register),
        }
    }

    /// Returns true if the clock of a peripheral is on.
    #[inline]
    pub fn enabled(&self, Gate(bus, place): Gate) -> bool {
        bit(self.enables[bus as usize], place)
    }

    /// Returns true if a peripheral is held in reset.
    pub fn held_in_reset(&self, Gate(bus, place): Gate) -> bool {
        bit(self.resets[bus as usize], place)
    }

    /// Stops or restarts the crystal. Returns true if the clock security system raises the non-maskable interrupt. The core
    /// then runs from the internal oscillator.
    pub fn set_crystal(&mut self, runs: bool) -> bool {
        self.crystal_runs = runs;
        let watched = !runs && self.on(CSSON) && self.on(HSEON);
        if watched {
            self.cir |= 1 << CSSF;
            self.cr &= !(1 << HSEON | 1 << PLLON | 1 << CSSON);
            self.cfgr &= !0b11;
        }
        watched
    }

    /// Returns true if the clock security system has raised the non-maskable interrupt.
    pub fn clock_failed(&self) -> bool {
        bit(self.cir, CSSF)
    }

    /// The clock frequencies. A stopped clock has 0 Hz.
    pub fn clocks(&self) -> Clocks {
        let hse_hz = if self.crystal_runs { HSE_HZ } else { 0.0 };
        let system_hz = match self.cfgr & 0b11 {
            0 => HSI_HZ,
            1 => hse_hz,
            _ => {
                let source_hz = if bit(self.pllcfgr, 22) {
                    hse_hz
                } else {
                    HSI_HZ
                };
                let m = field(self.pllcfgr, 0, 6).max(1);
                let n = field(self.pllcfgr, 6, 9);
                let p = 2 * (field(self.pllcfgr, 16, 2) + 1);
                source_hz * f64::from(n) / (f64::from(m) * f64::from(p))
            }
        };
        const AHB: [u32; 8] = [2, 4, 8, 16, 64, 128, 256, 512];
        let hpre = field(self.cfgr, 4, 4);
        let ahb_divider = match hpre {
            0..8 => 1,
            _ => AHB[hpre as usize - 8],
        };
        let apb = |code: u32| match code {
            0..4 => 1,
            _ => 2 << (code - 4),
        };
        Clocks {
            hclk_hz: system_hz / f64::from(ahb_divider),
            apb1_divider: apb(field(self.cfgr, 10, 3)),
            apb2_divider: apb(field(self.cfgr, 13, 3)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn started() -> Rcc {
        let mut rcc = Rcc::reset(ResetCause::Power, None);
        let hse = 0x83 | 1 << HSEON;
        rcc.write(CR, hse, 0).unwrap();
        rcc.write(PLLCFGR, 4 | 168 << 6 | 1 << 22 | 7 << 24, 0)
            .unwrap();
        rcc.write(CR, hse | 1 << PLLON, 40_000).unwrap();
        rcc
    }

    #[test]
    fn oscillators_need_a_start_up_time() {
        let mut rcc = Rcc::reset(ResetCause::Power, None);
        rcc.write(CR, 0x83 | 1 << HSEON, 100).unwrap();
        let ready_at = 100 + (HSE_STARTUP_S * HSI_HZ) as u64;
        assert_eq!(rcc.read(CR, ready_at - 1).unwrap() >> 17 & 1, 0);
        assert_eq!(rcc.read(CR, ready_at).unwrap() >> 17 & 1, 1);
    }

    #[test]
    fn the_pll_gives_168_mhz_and_the_bus_clocks() {
        let mut rcc = started();
        let dividers = 0b101 << 10 | 0b100 << 13;
        assert!(
            rcc.write(CFGR, dividers | 2, 40_001).is_err(),
            "not locked yet"
        );
        rcc.write(CFGR, dividers | 2, 50_000).unwrap();
        assert_eq!(rcc.read(CFGR, 50_000).unwrap() & 0b1111, 0b1010);
        assert_eq!(
            rcc.clocks(),
            Clocks {
                hclk_hz: 168e6,
                apb1_divider: 4,
                apb2_divider: 2
            }
        );
    }

    #[test]
    fn after_a_crystal_failure_the_core_runs_from_the_internal_oscillator() {
        let mut rcc = started();
        rcc.write(CFGR, 2, 50_000).unwrap();
        assert!(!rcc.clone().set_crystal(false), "not watched");
        rcc.write(CR, 0x83 | 1 << HSEON | 1 << PLLON | 1 << CSSON, 50_000)
            .unwrap();
        assert!(rcc.set_crystal(false));
        assert_eq!(rcc.clocks().hclk_hz, HSI_HZ);
        assert!(rcc.clock_failed());
        rcc.write(CIR, 1 << CSSC, 60_000).unwrap();
        assert!(!rcc.clock_failed());
    }

    #[test]
    fn reset_cause_flags_accumulate_until_they_are_cleared() {
        let power = Rcc::reset(ResetCause::Power, None);
        let mut both = Rcc::reset(ResetCause::IndependentWatchdog, Some(&power));
        assert_eq!(both.read(CSR, 0).unwrap() >> 24, 0b0010_1110);
        both.write(CSR, 1 << RMVF, 0).unwrap();
        assert_eq!(both.read(CSR, 0).unwrap() >> 24, 0);
    }
}
