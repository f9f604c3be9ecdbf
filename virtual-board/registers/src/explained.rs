//! Intended differences from the SVD, each with its reason.

/// Marks the reset value instead of bits.
const RESET: u32 = u32::MAX;

/// Register, bits, and the reason of the difference. A name that ends with an asterisk matches every name with that
/// beginning.
const EXPLAINED: &[(&str, &str, u32, &str)] = &[
    (
        "TIM*",
        "ARR",
        RESET,
        "all ones after a reset (RM0090, sections 17.4.12 and 18.4.12); the SVD has 0",
    ),
    (
        "TIM*",
        "SR",
        0x1EFF,
        "flags: the program clears them by a zero, and cannot set them",
    ),
    (
        "ADC*",
        "SR",
        0x3F,
        "flags: the program clears them by a zero, and cannot set them",
    ),
    (
        "ADC*",
        "CR2",
        1 << 30,
        "SWSTART starts a conversion at once, and falls",
    ),
    (
        "USART2",
        "SR",
        RESET,
        "the transmitter is empty after a reset, TC and TXE (RM0090, section 30.6.1); the SVD has 0",
    ),
    (
        "USART2",
        "SR",
        1 << 5 | 1 << 8 | 1 << 9,
        "flags: the program clears them by a zero, and cannot set them",
    ),
    (
        "IWDG",
        "RLR",
        RESET,
        "0xFFF after a reset (RM0090, section 21.4.3); the SVD has 0",
    ),
    ("IWDG", "PR", 0b111, "locked until KR has its key"),
    ("IWDG", "RLR", 0xFFF, "locked until KR has its key"),
    (
        "PWR",
        "CR",
        RESET,
        "VOS is scale 1 after a reset (RM0090, section 5.4.1); the SVD has 0",
    ),
    ("PWR", "CSR", RESET, "VOSRDY follows VOS at once"),
    (
        "EXTI",
        "SWIER",
        0x007F_FFFF,
        "acts on lines that IMR lets through only, and falls",
    ),
    (
        "EXTI",
        "PR",
        0x007F_FFFF,
        "flags: the program clears them by a one, and cannot set them",
    ),
    (
        "GPIOA",
        "OSPEEDR",
        RESET,
        "0x0C00_0000 after a reset (RM0090, section 8.4.3), as port B's is not 0; the SVD has 0",
    ),
    (
        "GPIO*",
        "IDR",
        RESET,
        "the levels of the debug pins, which are pulled",
    ),
    (
        "RCC",
        "CFGR",
        0b11 << 2,
        "SWS is for reading only (RM0090, section 6.3.3)",
    ),
    (
        "RCC",
        "CSR",
        0xFF << 24,
        "RMVF clears the flags, which are for reading only (RM0090, section 6.3.21)",
    ),
    (
        "RCC",
        "AHB2LPENR",
        0b11 << 4,
        "the crypto units of the STM32F417; the reset value has them, and the fields of the SVD have not",
    ),
    (
        "FLASH",
        "ACR",
        0b11 << 11,
        "resets of the caches: they act at once, with the caches off",
    ),
    (
        "FLASH",
        "SR",
        0xF3,
        "flags: the program clears them by a one, and cannot set them",
    ),
    ("FLASH", "CR", 0x8001_037F, "locked until KEYR has its keys"),
    (
        "FLASH",
        "OPTCR",
        RESET,
        "the option bytes as delivered (RM0090, section 3.9.6); the SVD has another value",
    ),
    (
        "FLASH",
        "OPTCR",
        u32::MAX >> 1,
        "locked until OPTKEYR has its keys",
    ),
    ("DBGMCU", "IDCODE", RESET, "another revision of the chip"),
];

/// The reason of an intended difference in a bit of a register or in its reset value. `None` if it is not intended.
pub fn reason(peripheral: &str, register: &str, bit: Option<u32>) -> Option<&'static str> {
    EXPLAINED
        .iter()
        .find(|(known, name, bits, _)| {
            let same = match known.strip_suffix('*') {
                Some(start) => peripheral.starts_with(start),
                None => peripheral == *known,
            };
            let covers = match bit {
                Some(bit) => *bits != RESET && bits >> bit & 1 == 1,
                None => *bits == RESET,
            };
            same && *name == register && covers
        })
        .map(|(_, _, _, reason)| *reason)
}
