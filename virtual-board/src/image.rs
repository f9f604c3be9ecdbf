//! A firmware image: the ELF file that is flashed, as it is.

use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol};
use sha2::{Digest, Sha256};

/// Why an image cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file cannot be read.
    #[error("cannot read the image {}: {source}; build it with `cargo fw`", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no ELF file of 32 bits.
    #[error("the image is no 32-bit ELF file ({0}); give the one that `cargo fw` leaves")]
    Elf(#[from] object::Error),
    /// It is for something else.
    #[error("the image is for another processor; give one for thumbv7em-none-eabihf")]
    Processor,
    /// Part of it goes where this board has no flash.
    #[error(
        "{bytes} bytes of the image go to {address:#010x}, where the board has no flash; link it by memory.x"
    )]
    OutsideFlash {
        /// Where to.
        address: u64,
        /// How many.
        bytes: u64,
    },
}

/// An image.
#[derive(Debug, Clone)]
pub struct Image {
    bytes: Vec<u8>,
    segments: Vec<(u32, Range<usize>)>,
    symbols: Vec<Symbol>,
}

/// A name in an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// As the linker has it, mangled.
    pub name: String,
    /// Where it is; of code without the bit for Thumb.
    pub address: u32,
    /// Length in bytes.
    pub size: u32,
}

impl Image {
    /// The image in a file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path).map_err(|source| ImageError::File {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(bytes)
    }

    /// The image in the bytes of a file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn parse(bytes: Vec<u8>) -> Result<Self, ImageError> {
        let elf = ElfFile32::<Endianness>::parse(&*bytes)?;
        let endian = elf.endian();
        if elf.elf_header().e_machine(endian) != object::elf::EM_ARM {
            return Err(ImageError::Processor);
        }
        let segments = elf
            .elf_program_headers()
            .iter()
            .filter(|header| header.p_type(endian) == object::elf::PT_LOAD)
            .map(|header| {
                let (start, length) = header.file_range(endian);
                let file = start as usize..(start + length) as usize;
                (header.p_paddr(endian), file)
            })
            .filter(|(_, file)| !file.is_empty() && file.end <= bytes.len())
            .collect();
        let symbols = elf
            .symbols()
            .filter_map(|symbol| {
                Some(Symbol {
                    name: symbol.name().ok()?.to_owned(),
                    address: symbol.address() as u32
                        & !u32::from(symbol.kind() == object::SymbolKind::Text),
                    size: symbol.size() as u32,
                })
            })
            .collect();
        Ok(Self {
            segments,
            symbols,
            bytes,
        })
    }

    /// The bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// SHA-256 of the file, by which it is known.
    #[must_use]
    pub fn hash(&self) -> String {
        Sha256::digest(&self.bytes)
            .iter()
            .fold(String::new(), |mut text, byte| {
                // Writing to a String cannot fail.
                let _ = write!(text, "{byte:02x}");
                text
            })
    }

    /// Writes it into `flash`, which stands at address `origin`.
    ///
    /// # Errors
    /// [`ImageError::OutsideFlash`].
    pub fn flash(&self, flash: &mut [u8], origin: u32) -> Result<(), ImageError> {
        for (address, file) in &self.segments {
            let bytes = &self.bytes[file.clone()];
            let cells = address
                .checked_sub(origin)
                .and_then(|at| flash.get_mut(at as usize..)?.get_mut(..bytes.len()))
                .ok_or(ImageError::OutsideFlash {
                    address: u64::from(*address),
                    bytes: bytes.len() as u64,
                })?;
            cells.copy_from_slice(bytes);
        }
        Ok(())
    }

    /// The first symbol whose name `is` accepts.
    #[must_use]
    pub fn symbol(&self, is: impl Fn(&str) -> bool) -> Option<&Symbol> {
        self.symbols.iter().find(|symbol| is(&symbol.name))
    }
}
