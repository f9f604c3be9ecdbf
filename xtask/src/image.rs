//! Reads a firmware image from its ELF file.

use std::collections::BTreeMap;
use std::ops::Range;

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SymbolKind};

/// Addresses of the flash and of the main RAM.
const FLASH: Range<u64> = 0x0800_0000..0x0810_0000;
const RAM: Range<u64> = 0x2000_0000..0x2002_0000;
/// Flash sectors of the stored settings, 1 to 3 (RM0090, section 3.3, table 5). The image must not use them.
const SETTINGS: Range<u64> = 0x0800_4000..0x0801_0000;
/// Number of vectors before the interrupts on the Cortex-M4: the initial stack pointer and the exceptions.
const EXCEPTIONS: usize = 16;
const RESET: usize = 1;
const HARD_FAULT: usize = 3;
/// Exceptions that the architecture reserves. Their vectors are zero.
const RESERVED: [usize; 5] = [7, 8, 9, 10, 13];
/// Bit 0 of a function address, which selects the Thumb instruction set.
const THUMB: u64 = 1;

/// Reason why an image must not be flashed.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    #[error("the firmware image cannot be read: {0}")]
    Unreadable(#[from] object::Error),
    #[error("the firmware image has no {0}")]
    Missing(String),
    #[error("vector {index} of the firmware image points to {found:#x}, not to {expected}")]
    Vector {
        index: usize,
        found: u64,
        expected: String,
    },
    #[error(
        "double-precision arithmetic in the firmware image: {}; find it by `f64` in the callers",
        .0.join(", ")
    )]
    DoublePrecision(Vec<String>),
    #[error("the firmware image has bytes at {0:#x}, where the stored settings are: see memory.x")]
    OverSettings(u64),
    #[error("the firmware takes {bytes} bytes of flash, more than {limit}")]
    TooLarge { bytes: u64, limit: u64 },
    #[error(
        "the firmware's variables take {statics} bytes of RAM and its stack up to {stack}, together more than {limit}"
    )]
    TooMuchRam {
        statics: u64,
        stack: u64,
        limit: u64,
    },
    #[error("the firmware's function {0} calls itself: its stack has no bound")]
    Recursion(String),
}

/// An image and its functions by address.
pub struct Image<'a> {
    elf: ElfFile32<'a, Endianness>,
    functions: BTreeMap<u64, Function>,
}

/// A function of the image.
pub struct Function {
    pub name: String,
    pub size: u64,
}

impl<'a> Image<'a> {
    pub fn read(bytes: &'a [u8]) -> Result<Self, ImageError> {
        let elf = ElfFile32::parse(bytes)?;
        let functions = elf
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .map(|symbol| {
                let function = Function {
                    name: symbol.name().unwrap_or("?").to_owned(),
                    size: symbol.size(),
                };
                (symbol.address() & !THUMB, function)
            })
            .collect();
        Ok(Self { elf, functions })
    }

    /// All functions by address.
    pub fn functions(&self) -> &BTreeMap<u64, Function> {
        &self.functions
    }

    /// Address of the function with this name.
    pub fn function(&self, name: &str) -> Result<u64, ImageError> {
        self.functions
            .iter()
            .find(|(_, function)| function.name == name)
            .map(|(address, _)| *address)
            .ok_or_else(|| ImageError::Missing(format!("function {name}")))
    }

    /// Address and bytes of a section.
    pub fn section(&self, name: &str) -> Result<(u64, &'a [u8]), ImageError> {
        let section = self
            .elf
            .section_by_name(name)
            .ok_or_else(|| ImageError::Missing(format!("section {name}")))?;
        Ok((section.address(), section.data()?))
    }

    /// Address ranges of data within the code, from the mapping symbols `$d` and `$t` of the ARM ABI.
    pub fn literals(&self) -> Vec<Range<u64>> {
        let mut marks: Vec<_> = self
            .elf
            .symbols()
            .filter_map(|symbol| match symbol.name() {
                Ok(name) if name.starts_with("$d") => Some((symbol.address(), true)),
                Ok(name) if name.starts_with("$t") => Some((symbol.address(), false)),
                _ => None,
            })
            .collect();
        marks.sort_unstable();
        marks
            .windows(2)
            .filter(|pair| pair[0].1)
            .map(|pair| pair[0].0..pair[1].0)
            .collect()
    }

    /// Checks the vector table. The stack must begin at the end of RAM. Every vector that `served` names must lead to its
    /// own function, and every other vector to the handler that turns the bridge off.
    pub fn check_vectors(&self, served: &[(usize, &str)]) -> Result<(), ImageError> {
        let (address, table) = self.section(".vector_table")?;
        let expect = |index: usize, found: u64, value: u64, expected: &str| {
            if found == value {
                Ok(())
            } else {
                Err(ImageError::Vector {
                    index,
                    found,
                    expected: expected.to_owned(),
                })
            }
        };
        expect(0, address, FLASH.start, "the beginning of the flash")?;
        for (index, found) in words(table).enumerate() {
            let name = match index {
                0 => {
                    expect(index, found, RAM.end, "the end of RAM")?;
                    continue;
                }
                RESET => "Reset",
                HARD_FAULT => "HardFault",
                _ if RESERVED.contains(&index) => {
                    expect(index, found, 0, "nothing")?;
                    continue;
                }
                _ => index
                    .checked_sub(EXCEPTIONS)
                    .and_then(|number| served.iter().find(|(served, _)| *served == number))
                    .map_or("DefaultHandler", |(_, name)| name),
            };
            // The chip does not have these interrupts.
            if index >= EXCEPTIONS && found == 0 {
                continue;
            }
            expect(index, found, self.function(name)? | THUMB, name)?;
        }
        for (number, name) in served {
            if words(table).nth(EXCEPTIONS + number).is_none_or(|v| v == 0) {
                return Err(ImageError::Missing(format!("vector of {name}")));
            }
        }
        Ok(())
    }

    /// Checks that the image has no routines of double-precision arithmetic. The processor has no such instructions, and a
    /// sine in double precision takes longer than a control period allows.
    pub fn check_single_precision(&self) -> Result<(), ImageError> {
        let found: Vec<_> = self
            .functions
            .values()
            .filter(|function| is_double_precision(&function.name))
            .map(|function| function.name.clone())
            .collect();
        if found.is_empty() {
            Ok(())
        } else {
            Err(ImageError::DoublePrecision(found))
        }
    }

    /// Checks that the image has no byte in the sectors of the stored settings, so that flashing preserves them.
    pub fn check_settings_are_spared(&self) -> Result<(), ImageError> {
        match self
            .flashed()
            .find(|span| span.start < SETTINGS.end && span.end > SETTINGS.start)
        {
            Some(span) => Err(ImageError::OverSettings(span.start)),
            None => Ok(()),
        }
    }

    /// Flash use, bytes.
    pub fn flash_bytes(&self) -> u64 {
        self.flashed().map(|span| span.end - span.start).sum()
    }

    /// Flash ranges that the image fills.
    fn flashed(&self) -> impl Iterator<Item = Range<u64>> {
        let endian = self.elf.endian();
        self.elf
            .elf_program_headers()
            .iter()
            .filter(move |header| header.p_type(endian) == object::elf::PT_LOAD)
            .map(move |header| {
                let start = u64::from(header.p_paddr(endian));
                start..start + u64::from(header.p_filesz(endian))
            })
            .filter(|span| FLASH.contains(&span.start) && !span.is_empty())
    }

    /// RAM use of the variables, bytes.
    pub fn static_ram_bytes(&self) -> u64 {
        self.statics().map(|span| span.end - span.start).sum()
    }

    fn statics(&self) -> impl Iterator<Item = Range<u64>> {
        self.elf
            .sections()
            .map(|section| section.address()..section.address() + section.size())
            .filter(|span| RAM.contains(&span.start))
    }
}

/// Little-endian 32-bit words.
pub fn words(bytes: &[u8]) -> impl Iterator<Item = u64> + '_ {
    bytes.chunks_exact(4).map(|word| {
        word.iter()
            .rev()
            .fold(0, |sum, byte| sum << 8 | u64::from(*byte))
    })
}

/// Whether a function is a double-precision routine: `__aeabi_dadd` and similar, conversions such as `__aeabi_f2d`, and
/// their names in the compiler's own library, such as `__adddf3`.
fn is_double_precision(name: &str) -> bool {
    let arm = name.strip_prefix("__aeabi_");
    arm.is_some_and(|name| name.starts_with('d') || name.ends_with("2d"))
        || name.starts_with("__") && (name.ends_with("df2") || name.ends_with("df3"))
}

#[cfg(test)]
mod tests {
    use super::is_double_precision;

    #[test]
    fn double_precision_routines_are_recognized_by_name() {
        for name in [
            "__aeabi_dmul",
            "__aeabi_d2iz",
            "__aeabi_f2d",
            "__muldf3",
            "__extendsfdf2",
        ] {
            assert!(is_double_precision(name), "{name}");
        }
        for name in [
            "__aeabi_f2lz",
            "__aeabi_memcpy",
            "__aeabi_idiv",
            "__mulsf3",
            "find2d",
        ] {
            assert!(!is_double_precision(name), "{name}");
        }
    }
}
