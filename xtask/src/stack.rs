//! Upper bound of the firmware's stack use, computed from its machine code.
//!
//! The frame of a function is the sum of all its decrements of the stack pointer. Direct calls give the call graph. A call
//! through a pointer can reach any function whose address is in the image. In this firmware such calls come from formatting,
//! and there are at most [`POINTER_CALLS`] of them on one path.

use std::collections::{BTreeMap, BTreeSet};

use crate::image::{Image, ImageError, words};

/// Largest number of calls through pointers on one path: the text of an answer, its line, a value, a number, its padding,
/// and the writer, plus one as a reserve.
const POINTER_CALLS: usize = 7;

/// Bytes that the processor pushes at an exception, with the floating-point registers and alignment (ARMv7-M manual).
const EXCEPTION_BYTES: u64 = 104 + 4;

/// Largest stack use of the main program and one run of each interrupt, if all interrupts preempt each other, bytes.
pub fn worst<'a>(
    image: &Image,
    interrupts: impl IntoIterator<Item = &'a str>,
) -> Result<u64, ImageError> {
    let graph = Graph::of(image)?;
    let mut depths = Depths::new(&graph);
    let mut sum = depths.of(image.function("Reset")?, POINTER_CALLS)?;
    for name in interrupts {
        sum += EXCEPTION_BYTES + depths.of(image.function(name)?, POINTER_CALLS)?;
    }
    Ok(sum)
}

/// Stack use and calls of a function.
#[derive(Default)]
struct Node {
    name: String,
    frame_bytes: u64,
    calls: BTreeSet<u64>,
    calls_pointer: bool,
}

struct Graph {
    nodes: BTreeMap<u64, Node>,
    /// Functions whose address occurs in the image.
    pointed: BTreeSet<u64>,
}

impl Graph {
    fn of(image: &Image) -> Result<Self, ImageError> {
        let (text_start, text) = image.section(".text")?;
        let literals = image.literals();
        let mut addresses: BTreeSet<u64> = BTreeSet::new();
        for name in [".rodata", ".data", ".text"] {
            addresses.extend(words(image.section(name)?.1));
        }
        let mut nodes = BTreeMap::new();
        for (start, function) in image.functions() {
            let mut node = Node {
                name: function.name.clone(),
                ..Node::default()
            };
            let mut halves = [0_u64; 16];
            let mut at = *start;
            while at < start + function.size {
                if let Some(literal) = literals.iter().find(|span| span.contains(&at)) {
                    at = literal.end;
                    continue;
                }
                let Some(code) = text.get((at - text_start) as usize..) else {
                    break;
                };
                let Some(instruction) = Instruction::decode(code, at) else {
                    break;
                };
                at += instruction.bytes;
                match instruction.effect {
                    Effect::Push(bytes) => node.frame_bytes += bytes,
                    // A branch within the function is a jump. A branch to the start of another function is a call.
                    Effect::Branch(to) if image.functions().contains_key(&to) && to != *start => {
                        node.calls.insert(to);
                    }
                    Effect::Call(to) => {
                        node.calls.insert(to);
                    }
                    Effect::CallPointer => node.calls_pointer = true,
                    Effect::LowHalf(register, half) => halves[register] = half,
                    Effect::HighHalf(register, half) => {
                        addresses.insert(half << 16 | halves[register]);
                    }
                    Effect::Branch(_) | Effect::None => {}
                }
            }
            nodes.insert(*start, node);
        }
        let pointed = nodes
            .keys()
            .copied()
            .filter(|address| addresses.contains(&(address | 1)))
            .collect();
        Ok(Self { nodes, pointed })
    }
}

/// Stack use per function, memoized.
struct Depths<'a> {
    graph: &'a Graph,
    known: BTreeMap<(u64, usize), u64>,
    path: Vec<(u64, usize)>,
}

impl<'a> Depths<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self {
            graph,
            known: BTreeMap::new(),
            path: Vec::new(),
        }
    }

    /// Largest stack use of a function and its callees with this number of remaining calls through pointers, bytes.
    fn of(&mut self, function: u64, pointer_calls: usize) -> Result<u64, ImageError> {
        let key = (function, pointer_calls);
        if let Some(depth) = self.known.get(&key) {
            return Ok(*depth);
        }
        let Some(node) = self.graph.nodes.get(&function) else {
            return Err(ImageError::Missing(format!("function at {function:#x}")));
        };
        if self.path.contains(&key) {
            return Err(ImageError::Recursion(node.name.clone()));
        }
        self.path.push(key);
        let mut below = 0;
        for call in &node.calls {
            below = below.max(self.of(*call, pointer_calls)?);
        }
        if node.calls_pointer
            && let Some(left) = pointer_calls.checked_sub(1)
        {
            for call in &self.graph.pointed {
                below = below.max(self.of(*call, left)?);
            }
        }
        self.path.pop();
        let depth = node.frame_bytes + below;
        self.known.insert(key, depth);
        Ok(depth)
    }
}

/// Effect of an instruction on the stack and the call graph.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Effect {
    None,
    Push(u64),
    Call(u64),
    Branch(u64),
    CallPointer,
    LowHalf(usize, u64),
    HighHalf(usize, u64),
}

struct Instruction {
    bytes: u64,
    effect: Effect,
}

impl Instruction {
    /// Decodes the instruction at `address` as far as needed (ARMv7-M manual, chapter A7.7).
    fn decode(code: &[u8], address: u64) -> Option<Self> {
        let half = |index: usize| {
            let bytes = code.get(2 * index..2 * index + 2)?;
            Some(u64::from(bytes[0]) | u64::from(bytes[1]) << 8)
        };
        let first = half(0)?;
        if first >> 11 < 0b11101 {
            return Some(Self {
                bytes: 2,
                effect: narrow(first, address),
            });
        }
        Some(Self {
            bytes: 4,
            effect: wide(first, half(1)?, address),
        })
    }
}

fn narrow(code: u64, address: u64) -> Effect {
    const LINK_REGISTER: u64 = 14;
    if code & 0xFE00 == 0xB400 {
        Effect::Push(4 * u64::from((code & 0x1FF).count_ones()))
    } else if code & 0xFF80 == 0xB080 {
        Effect::Push(4 * (code & 0x7F))
    } else if code & 0xFF87 == 0x4780 || code & 0xFF87 == 0x4700 && code >> 3 & 0xF != LINK_REGISTER
    {
        Effect::CallPointer
    } else if code & 0xF800 == 0xE000 {
        Effect::Branch(offset(address, (code & 0x7FF) << 1, 12))
    } else {
        Effect::None
    }
}

fn wide(first: u64, second: u64, address: u64) -> Effect {
    // sub.w sp, sp, #expanded and subw sp, sp, #plain
    if first & 0xFBEF == 0xF1AD && second >> 8 & 0xF == 13 {
        Effect::Push(expanded(immediate(first, second)))
    } else if first & 0xFBFF == 0xF2AD && second >> 8 & 0xF == 13 {
        Effect::Push(immediate(first, second))
    } else if first == 0xE92D {
        Effect::Push(4 * u64::from(second.count_ones()))
    } else if first == 0xF84D && second & 0xFFF == 0xD04 {
        Effect::Push(4)
    } else if first & 0xFFBF == 0xED2D && second & 0xE00 == 0xA00 {
        Effect::Push(4 * (second & 0xFF))
    } else if first & 0xFBF0 == 0xF240 && second & 0x8000 == 0 {
        Effect::LowHalf((second >> 8 & 0xF) as usize, half_word(first, second))
    } else if first & 0xFBF0 == 0xF2C0 && second & 0x8000 == 0 {
        Effect::HighHalf((second >> 8 & 0xF) as usize, half_word(first, second))
    } else if first & 0xF800 == 0xF000 && second & 0xC000 == 0xC000 && second & 0x1000 != 0 {
        Effect::Call(far(first, second, address))
    } else if first & 0xF800 == 0xF000 && second & 0xD000 == 0x9000 {
        Effect::Branch(far(first, second, address))
    } else {
        Effect::None
    }
}

/// The 12 bits i:imm3:imm8 of an immediate.
fn immediate(first: u64, second: u64) -> u64 {
    (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
}

/// The 16 bits imm4:i:imm3:imm8 of an immediate.
fn half_word(first: u64, second: u64) -> u64 {
    (first & 0xF) << 12 | immediate(first, second)
}

/// A modified immediate constant (ARMv7-M manual, A5.3.2).
fn expanded(immediate: u64) -> u64 {
    let byte = immediate & 0xFF;
    match immediate >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => {
            let value = (byte | 0x80) as u32;
            u64::from(value.rotate_right((immediate >> 7) as u32))
        }
    }
}

/// Target of a 32-bit branch: S:I1:I2:imm10:imm11:0, where I is not (J xor S).
fn far(first: u64, second: u64, address: u64) -> u64 {
    let sign = first >> 10 & 1;
    let i1 = !(second >> 13 ^ sign) & 1;
    let i2 = !(second >> 11 ^ sign) & 1;
    let bits = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    offset(address, bits, 25)
}

/// Target of a branch with a signed offset of `width` bits. The program counter is four bytes ahead of the instruction.
fn offset(address: u64, bits: u64, width: u32) -> u64 {
    let unused = u64::BITS - width;
    let signed = (bits << unused) as i64 >> unused;
    (address + 4).wrapping_add_signed(signed)
}

#[cfg(test)]
mod tests {
    use super::{Effect, Instruction};

    fn effect(code: &[u8]) -> Effect {
        Instruction::decode(code, 0x0800_0286).unwrap().effect
    }

    /// The bytes are the output of an assembler.
    #[test]
    fn stack_decrements_and_calls_are_decoded() {
        assert_eq!(
            effect(&[0xf0, 0xb5]),
            Effect::Push(20),
            "push {{r4-r7, lr}}"
        );
        assert_eq!(
            effect(&[0x2d, 0xe9, 0x00, 0x0f]),
            Effect::Push(16),
            "push.w {{r8-fp}}"
        );
        assert_eq!(effect(&[0x88, 0xb0]), Effect::Push(32), "sub sp, #0x20");
        assert_eq!(
            effect(&[0xad, 0xf5, 0x82, 0x6d]),
            Effect::Push(0x410),
            "sub.w sp, sp, #0x410"
        );
        assert_eq!(
            effect(&[0x2d, 0xed, 0x0e, 0x8b]),
            Effect::Push(56),
            "vpush {{d8-d14}}"
        );
        assert_eq!(
            effect(&[0x4d, 0xf8, 0x04, 0xbd]),
            Effect::Push(4),
            "str fp, [sp, #-4]!"
        );
        assert_eq!(effect(&[0x98, 0x47]), Effect::CallPointer, "blx r3");
        assert_eq!(effect(&[0x70, 0x47]), Effect::None, "bx lr");
        assert_eq!(
            effect(&[0x02, 0xf0, 0xd1, 0xf9]),
            Effect::Call(0x0800_262c),
            "bl"
        );
        assert_eq!(effect(&[0xfe, 0xe7]), Effect::Branch(0x0800_0286), "b .");
        assert_eq!(
            effect(&[0x40, 0xf6, 0x18, 0x01]),
            Effect::LowHalf(1, 0x818),
            "movw r1"
        );
        assert_eq!(
            effect(&[0xc4, 0xf2, 0x02, 0x01]),
            Effect::HighHalf(1, 0x4002),
            "movt r1"
        );
    }
}
