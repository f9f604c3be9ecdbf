//! Memory map of the STM32F407 peripherals.

use crate::peripherals::rcc::{Bus, Gate};

/// A peripheral that is modelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names of the reference manual")]
pub enum Unit {
    Tim2,
    Tim3,
    Tim5,
    Iwdg,
    Usart2,
    Pwr,
    Tim8,
    Adc,
    Syscfg,
    Exti,
    /// A GPIO port, counted from A.
    Gpio(usize),
    Rcc,
    Flash,
    Dma1,
    Dma2,
    Dbgmcu,
    /// The factory-programmed words.
    Factory,
}

/// What an address belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A modelled peripheral, and the offset in it.
    Modelled(Unit, u32),
    /// A peripheral that is not modelled: its name and the offset in it.
    Known(&'static str, u32),
    /// No peripheral. The chip answers with a bus error.
    Nothing,
}

/// Ports A to I.
pub const PORTS: usize = 9;
const PORT_BYTES: u32 = 0x400;
const GPIOA: u32 = 0x4002_0000;

/// Peripherals: name, first address, end address (exclusive), and unit if it is modelled.
const MAP: [(&str, u32, u32, Option<Unit>); 67] = [
    ("system memory", 0x1FFF_0000, 0x1FFF_7A10, None),
    (
        "factory words",
        0x1FFF_7A10,
        0x1FFF_7A30,
        Some(Unit::Factory),
    ),
    ("option bytes", 0x1FFF_C000, 0x1FFF_C010, None),
    ("TIM2", 0x4000_0000, 0x4000_0400, Some(Unit::Tim2)),
    ("TIM3", 0x4000_0400, 0x4000_0800, Some(Unit::Tim3)),
    ("TIM4", 0x4000_0800, 0x4000_0C00, None),
    ("TIM5", 0x4000_0C00, 0x4000_1000, Some(Unit::Tim5)),
    ("TIM6", 0x4000_1000, 0x4000_1400, None),
    ("TIM7", 0x4000_1400, 0x4000_1800, None),
    ("TIM12", 0x4000_1800, 0x4000_1C00, None),
    ("TIM13", 0x4000_1C00, 0x4000_2000, None),
    ("TIM14", 0x4000_2000, 0x4000_2400, None),
    ("RTC", 0x4000_2800, 0x4000_2C00, None),
    ("WWDG", 0x4000_2C00, 0x4000_3000, None),
    ("IWDG", 0x4000_3000, 0x4000_3400, Some(Unit::Iwdg)),
    ("I2S2ext", 0x4000_3400, 0x4000_3800, None),
    ("SPI2", 0x4000_3800, 0x4000_3C00, None),
    ("SPI3", 0x4000_3C00, 0x4000_4000, None),
    ("I2S3ext", 0x4000_4000, 0x4000_4400, None),
    ("USART2", 0x4000_4400, 0x4000_4800, Some(Unit::Usart2)),
    ("USART3", 0x4000_4800, 0x4000_4C00, None),
    ("UART4", 0x4000_4C00, 0x4000_5000, None),
    ("UART5", 0x4000_5000, 0x4000_5400, None),
    ("I2C1", 0x4000_5400, 0x4000_5800, None),
    ("I2C2", 0x4000_5800, 0x4000_5C00, None),
    ("I2C3", 0x4000_5C00, 0x4000_6000, None),
    ("CAN1", 0x4000_6400, 0x4000_6800, None),
    ("CAN2", 0x4000_6800, 0x4000_6C00, None),
    ("PWR", 0x4000_7000, 0x4000_7400, Some(Unit::Pwr)),
    ("DAC", 0x4000_7400, 0x4000_7800, None),
    ("TIM1", 0x4001_0000, 0x4001_0400, None),
    ("TIM8", 0x4001_0400, 0x4001_0800, Some(Unit::Tim8)),
    ("USART1", 0x4001_1000, 0x4001_1400, None),
    ("USART6", 0x4001_1400, 0x4001_1800, None),
    ("ADC", 0x4001_2000, 0x4001_2400, Some(Unit::Adc)),
    ("SDIO", 0x4001_2C00, 0x4001_3000, None),
    ("SPI1", 0x4001_3000, 0x4001_3400, None),
    ("SYSCFG", 0x4001_3800, 0x4001_3C00, Some(Unit::Syscfg)),
    ("EXTI", 0x4001_3C00, 0x4001_4000, Some(Unit::Exti)),
    ("TIM9", 0x4001_4000, 0x4001_4400, None),
    ("TIM10", 0x4001_4400, 0x4001_4800, None),
    ("TIM11", 0x4001_4800, 0x4001_4C00, None),
    ("GPIOA", 0x4002_0000, 0x4002_0400, Some(Unit::Gpio(0))),
    ("GPIOB", 0x4002_0400, 0x4002_0800, Some(Unit::Gpio(1))),
    ("GPIOC", 0x4002_0800, 0x4002_0C00, Some(Unit::Gpio(2))),
    ("GPIOD", 0x4002_0C00, 0x4002_1000, Some(Unit::Gpio(3))),
    ("GPIOE", 0x4002_1000, 0x4002_1400, Some(Unit::Gpio(4))),
    ("GPIOF", 0x4002_1400, 0x4002_1800, Some(Unit::Gpio(5))),
    ("GPIOG", 0x4002_1800, 0x4002_1C00, Some(Unit::Gpio(6))),
    ("GPIOH", 0x4002_1C00, 0x4002_2000, Some(Unit::Gpio(7))),
    ("GPIOI", 0x4002_2000, 0x4002_2400, Some(Unit::Gpio(8))),
    ("CRC", 0x4002_3000, 0x4002_3400, None),
    ("RCC", 0x4002_3800, 0x4002_3C00, Some(Unit::Rcc)),
    ("FLASH", 0x4002_3C00, 0x4002_4000, Some(Unit::Flash)),
    ("backup SRAM", 0x4002_4000, 0x4002_5000, None),
    ("DMA1", 0x4002_6000, 0x4002_6400, Some(Unit::Dma1)),
    ("DMA2", 0x4002_6400, 0x4002_6800, Some(Unit::Dma2)),
    ("ETHERNET", 0x4002_8000, 0x4002_9400, None),
    ("USB OTG HS", 0x4004_0000, 0x4008_0000, None),
    ("USB OTG FS", 0x5000_0000, 0x5004_0000, None),
    ("DCMI", 0x5005_0000, 0x5005_0400, None),
    ("CRYP", 0x5006_0000, 0x5006_0400, None),
    ("HASH", 0x5006_0400, 0x5006_0800, None),
    ("RNG", 0x5006_0800, 0x5006_0C00, None),
    ("FSMC banks", 0x6000_0000, 0xA000_0000, None),
    ("FSMC", 0xA000_0000, 0xA000_1000, None),
    ("DBGMCU", 0xE004_2000, 0xE004_2400, Some(Unit::Dbgmcu)),
];

/// Finds what `address` belongs to.
#[inline]
pub fn place(address: u32) -> Place {
    // Peripherals that a control loop accesses all the time are found first.
    match address & !0x3FF {
        0x4001_0400 => return Place::Modelled(Unit::Tim8, address & 0x3FF),
        0x4001_2000 => return Place::Modelled(Unit::Adc, address & 0x3FF),
        0x4000_0000 => return Place::Modelled(Unit::Tim2, address & 0x3FF),
        0x4000_0C00 => return Place::Modelled(Unit::Tim5, address & 0x3FF),
        0x4000_4400 => return Place::Modelled(Unit::Usart2, address & 0x3FF),
        0x4000_3000 => return Place::Modelled(Unit::Iwdg, address & 0x3FF),
        _ => {}
    }
    if let Some(offset) = address.checked_sub(GPIOA)
        && offset < PORTS as u32 * PORT_BYTES
    {
        let port = Unit::Gpio((offset / PORT_BYTES) as usize);
        return Place::Modelled(port, offset % PORT_BYTES);
    }
    let found = MAP
        .iter()
        .find(|(_, first, behind, _)| (*first..*behind).contains(&address));
    match found {
        Some((_, first, _, Some(unit))) => Place::Modelled(*unit, address - first),
        Some((name, first, _, None)) => Place::Known(name, address - first),
        None => Place::Nothing,
    }
}

/// Name of the register at `offset` of a peripheral.
pub fn register(unit: Unit, offset: u32) -> String {
    /// The converters share one address range. Each has its own registers in it.
    const CONVERTERS: [&str; 4] = ["ADC1", "ADC2", "ADC3", "ADC common"];
    let (name, offset) = match unit {
        Unit::Adc => (CONVERTERS[offset as usize >> 8 & 3], offset & 0xFF),
        unit => {
            let known = MAP.iter().find(|(.., known)| *known == Some(unit));
            (known.map_or("?", |(name, ..)| name), offset)
        }
    };
    format!("{name} + {offset:#04x}")
}

/// Clock gate of the register at `offset` of a peripheral. `None` if its clock cannot be switched off.
#[inline]
pub const fn gate(unit: Unit, offset: u32) -> Option<Gate> {
    Some(match unit {
        Unit::Gpio(port) => Gate(Bus::Ahb1, port as u32),
        Unit::Dma1 => Gate(Bus::Ahb1, 21),
        Unit::Dma2 => Gate(Bus::Ahb1, 22),
        Unit::Tim2 => Gate(Bus::Apb1, 0),
        Unit::Tim3 => Gate(Bus::Apb1, 1),
        Unit::Tim5 => Gate(Bus::Apb1, 3),
        Unit::Usart2 => Gate(Bus::Apb1, 17),
        Unit::Pwr => Gate(Bus::Apb1, 28),
        Unit::Tim8 => Gate(Bus::Apb2, 1),
        // Each converter has its own clock. The common registers use that of the first.
        Unit::Adc => match offset >> 8 {
            1 => Gate(Bus::Apb2, 9),
            2 => Gate(Bus::Apb2, 10),
            _ => Gate(Bus::Apb2, 8),
        },
        Unit::Syscfg => Gate(Bus::Apb2, 14),
        Unit::Iwdg | Unit::Exti | Unit::Rcc | Unit::Flash | Unit::Dbgmcu | Unit::Factory => {
            return None;
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_are_found_and_named() {
        assert_eq!(place(0x4002_0C18), Place::Modelled(Unit::Gpio(3), 0x18));
        assert_eq!(place(0x4001_2208), Place::Modelled(Unit::Adc, 0x208));
        assert_eq!(register(Unit::Adc, 0x208), "ADC3 + 0x08");
        assert_eq!(register(Unit::Tim8, 0x4C), "TIM8 + 0x4c");
        assert_eq!(place(0x4000_5410), Place::Known("I2C1", 0x10));
        assert_eq!(place(0x4000_7800), Place::Nothing);
    }
}
