//! The instructions to compare.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

/// An instruction, and the number of states in which to compare it.
#[derive(Debug, Clone)]
pub struct Trial {
    /// An IT instruction before it, if it should be in an IT block.
    pub if_then: Option<u16>,
    /// Its first halfword.
    pub first: u16,
    /// Its second halfword, if it has one.
    pub second: Option<u16>,
    pub states: usize,
}

impl Trial {
    /// Its bytes in memory, followed by endless loops, which end the translation.
    pub fn code(&self) -> Vec<u8> {
        const LOOP: u16 = 0xE7FE;
        self.if_then
            .into_iter()
            .chain([self.first])
            .chain(self.second)
            .chain([LOOP; 2])
            .flat_map(u16::to_le_bytes)
            .collect()
    }

    /// Number of instructions that the trial consists of.
    pub fn instructions(&self) -> usize {
        1 + usize::from(self.if_then.is_some())
    }

    /// Returns true for loads and stores that need an aligned address. Unicorn does not check the alignment, so these trials
    /// use aligned addresses only.
    pub fn wants_alignment(&self) -> bool {
        match self.second {
            None => self.first & 0xF000 == 0xC000,
            Some(_) => matches!(self.first & 0xFE00, 0xE800 | 0xEC00),
        }
    }

    /// The instruction as one number. The first halfword of two is the upper half.
    pub fn word(&self) -> u32 {
        match self.second {
            Some(second) => u32::from(self.first) << 16 | u32::from(second),
            None => self.first.into(),
        }
    }
}

impl fmt::Display for Trial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(if_then) = self.if_then {
            write!(f, "after {if_then:04x}: ")?;
        }
        match self.second {
            Some(_) => write!(f, "{:08x}", self.word()),
            None => write!(f, "{:04x}", self.word()),
        }
    }
}

fn is_wide(first: u16) -> bool {
    first >= 0xE800
}

/// Every distinct instruction of an image.
pub fn of_image(path: &Path) -> Result<Vec<Trial>, Box<dyn std::error::Error>> {
    let bytes = std::fs::read(path)
        .map_err(|error| format!("{}: {error}; build it with: cargo fw", path.display()))?;
    let file = object::File::parse(&*bytes)?;
    let mut marks: Vec<(u64, bool)> = file
        .symbols()
        .filter_map(|symbol| {
            let name = symbol.name().ok()?;
            let code = name == "$t" || name.starts_with("$t.");
            let data = name == "$d" || name.starts_with("$d.");
            (code || data).then_some((symbol.address(), code))
        })
        .collect();
    marks.sort_unstable();
    let mut found = BTreeSet::new();
    for section in file.sections().filter(|s| s.kind() == SectionKind::Text) {
        let data = section.data()?;
        let (begin, end) = (section.address(), section.address() + data.len() as u64);
        for (i, &(from, code)) in marks.iter().enumerate() {
            if !code || !(begin..end).contains(&from) {
                continue;
            }
            let to = marks.get(i + 1).map_or(end, |&(next, _)| next.min(end));
            let bytes = &data[(from - begin) as usize..(to - begin) as usize];
            let mut halves = bytes
                .chunks_exact(2)
                .map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
            while let Some(first) = halves.next() {
                let second = if is_wide(first) { halves.next() } else { None };
                found.insert((first, second));
            }
        }
    }
    Ok(found
        .into_iter()
        .map(|(first, second)| Trial {
            if_then: None,
            first,
            second,
            states: 100,
        })
        .collect())
}

/// Every 16-bit instruction, outside and, where allowed, inside an IT block.
pub fn narrow(random: &mut Xoshiro256PlusPlus) -> Vec<Trial> {
    (0..0xE800)
        .flat_map(|first| {
            let alone = Trial {
                if_then: None,
                first,
                second: None,
                states: 10,
            };
            // An IT block with one instruction, under any condition but AL.
            let condition = (random.next_u32() % 14) as u16;
            let in_block = Trial {
                if_then: Some(0xBF08 | condition << 4),
                ..alone.clone()
            };
            [Some(alone), may_be_in_block(first).then_some(in_block)]
        })
        .flatten()
        .collect()
}

/// Returns false for instructions that are unpredictable in an IT block: conditional B, CBZ, CBNZ, CPS and IT itself.
fn may_be_in_block(first: u16) -> bool {
    let branches = matches!(first & 0xF000, 0xD000) || first & 0xF500 == 0xB100;
    let changes_state = first & 0xFFE0 == 0xB660;
    let if_then = first & 0xFF00 == 0xBF00 && first & 15 != 0;
    !(branches || changes_state || if_then)
}

/// 32-bit instructions with every first halfword and random second halfwords.
pub fn wide(random: &mut Xoshiro256PlusPlus) -> Vec<Trial> {
    const SECONDS: usize = 600;
    (0xE800..=0xFFFF)
        .flat_map(|first| (0..SECONDS).map(move |_| first))
        .map(|first| {
            let bits = random.next_u32();
            let second = bits as u16;
            // Many instructions require ones or zeros in a field that is a register elsewhere.
            let second = match bits >> 16 & 7 {
                0 => second | 0xF000,
                1 => second & !0xF000,
                2 => second | 0x0F00,
                3 => second | 0xF000 & !0x0040,
                4 => second & !0x80F0,
                5 => second & !0x0FC0,
                _ => second,
            };
            Trial {
                if_then: None,
                first,
                second: Some(second),
                states: 2,
            }
        })
        .collect()
}

/// FPU instructions. Random second halfwords seldom encode one.
pub fn float(random: &mut Xoshiro256PlusPlus) -> Vec<Trial> {
    const SECONDS: usize = 600;
    (0xEC00..=0xEEFF)
        .flat_map(|first| (0..SECONDS).map(move |_| first))
        .map(|first| {
            let bits = random.next_u32();
            let double = if bits >> 16 & 7 == 0 { 0x0100 } else { 0 };
            let second = bits as u16 & !0x0F00 | 0x0A00 | double;
            // Register lists are kept short.
            let second = if first >> 8 == 0xEE {
                second
            } else {
                second & !0x00E0
            };
            Trial {
                if_then: None,
                first,
                second: Some(second),
                states: 4,
            }
        })
        .collect()
}
