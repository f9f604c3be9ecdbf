//! A firmware image: the ELF file that is also flashed to a real board.

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
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a 32-bit ELF file.
    #[error("the image is no 32-bit ELF file ({0}); give the one that `cargo fw` leaves")]
    Elf(#[from] object::Error),
    /// The image is for another processor.
    #[error("the image is for another processor; give one for thumbv7em-none-eabihf")]
    Processor,
    /// Part of the image lies outside the flash.
    #[error(
        "{bytes} bytes of the image go to {address:#010x}, where the board has no flash; link it by memory.x"
    )]
    OutsideFlash {
        /// First address of that part.
        address: u64,
        /// Its length in bytes.
        bytes: u64,
    },
}

/// A firmware image.
#[derive(Debug, Clone)]
pub struct Image {
    bytes: Vec<u8>,
    segments: Vec<(u32, Range<usize>)>,
    symbols: Vec<Symbol>,
}

/// A symbol of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// The mangled name.
    pub name: String,
    /// The address. For code, the Thumb bit is cleared.
    pub address: u32,
    /// Length in bytes.
    pub size: u32,
}

impl Image {
    /// Reads an image from a file.
    ///
    /// # Errors
    ///
    /// [`ImageError`].
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path).map_err(|source| ImageError::File {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(bytes)
    }

    /// Reads an image from the bytes of a file.
    ///
    /// # Errors
    ///
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

    /// SHA-256 of the file in hexadecimal.
    #[must_use]
    pub fn hash(&self) -> String {
        Sha256::digest(&self.bytes)
            .iter()
            .fold(String::new(), |mut text, byte| {
                // Writing to a `String` cannot fail.
                let _ = write!(text, "{byte:02x}");
                text
            })
    }

    /// Writes the image into `flash`, whose first byte has address `origin`.
    ///
    /// # Errors
    ///
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

    /// The first symbol whose name satisfies `is`.
    #[must_use]
    pub fn symbol(&self, is: impl Fn(&str) -> bool) -> Option<&Symbol> {
        self.symbols.iter().find(|symbol| is(&symbol.name))
    }
}
