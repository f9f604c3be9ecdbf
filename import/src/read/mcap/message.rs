//! Decodes a message in CDR (OMG Common Data Representation, formal/2004-03-12, 15.3) into named numbers.

use super::definition::{Count, Definitions, Field};

/// The numbers of a message.
pub(super) struct Message {
    /// Time stamp in its header, ns.
    pub stamp_ns: Option<i64>,
    /// Numbers by path. Arrays beside a list of names are named by these, as in `sensor_msgs/JointState`.
    pub fields: Vec<(String, f64)>,
}

/// Longest array that is read. Longer ones are images and point clouds.
const LONGEST: usize = 256;
/// Largest nesting depth of types.
const DEEPEST: usize = 16;

/// Decodes a message.
pub(super) fn decoded(bytes: &[u8], definitions: &Definitions) -> Result<Message, String> {
    let [_, order, _, _, payload @ ..] = bytes else {
        return Err("a message is too short".into());
    };
    let mut reader = Reader {
        bytes: payload,
        at: 0,
        is_little: order & 1 == 1,
    };
    let mut found = Found::default();
    found
        .read(&mut reader, definitions.main(), "", definitions, 0)
        .ok_or("a message does not fit its schema")?;
    Ok(found.message())
}

#[derive(Default)]
struct Found {
    numbers: Vec<(String, f64)>,
    /// Arrays by their path.
    arrays: Vec<(String, Vec<f64>)>,
    names: Vec<(String, Vec<String>)>,
}

impl Found {
    fn read(
        &mut self,
        reader: &mut Reader,
        fields: &[Field],
        path: &str,
        definitions: &Definitions,
        depth: usize,
    ) -> Option<()> {
        for field in fields {
            let path = if path.is_empty() {
                field.name.clone()
            } else {
                format!("{path}.{}", field.name)
            };
            let count = match field.count {
                Count::One => 1,
                Count::Fixed(count) => count,
                Count::Any => usize::try_from(reader.unsigned(4)?).ok()?,
            };
            let is_one = field.count == Count::One;
            match field.kind.as_str() {
                "string" | "wstring" => {
                    let mut texts = Vec::new();
                    for _ in 0..count {
                        texts.push(reader.text(field.kind == "wstring")?);
                    }
                    if !is_one {
                        self.names.push((path, texts));
                    }
                }
                kind if Reader::size(kind).is_some() => {
                    if count > LONGEST {
                        reader.skip(kind, count)?;
                        continue;
                    }
                    let mut values = Vec::with_capacity(count);
                    for _ in 0..count {
                        values.push(reader.number(kind)?);
                    }
                    match values[..] {
                        [value] if is_one => self.numbers.push((path, value)),
                        _ => self.arrays.push((path, values)),
                    }
                }
                kind => {
                    let inner = definitions.fields(kind).filter(|_| depth < DEEPEST)?;
                    for at in 0..count {
                        let path = if is_one {
                            path.clone()
                        } else {
                            format!("{path}[{at}]")
                        };
                        self.read(reader, inner, &path, definitions, depth + 1)?;
                    }
                }
            }
        }
        Some(())
    }

    fn message(self) -> Message {
        let number = |path: &str| {
            self.numbers
                .iter()
                .find(|(name, _)| name == path)
                .map(|(_, value)| *value)
        };
        let stamp = number("header.stamp.sec").zip(number("header.stamp.nanosec"));
        #[expect(clippy::cast_possible_truncation, reason = "both are 32-bit words")]
        let stamp_ns = stamp.map(|(sec, nanosec)| sec as i64 * 1_000_000_000 + nanosec as i64);
        let is_stamp = |name: &str| name.ends_with("stamp.sec") || name.ends_with("stamp.nanosec");
        let mut fields: Vec<(String, f64)> = self
            .numbers
            .into_iter()
            .filter(|(name, _)| !is_stamp(name))
            .collect();
        for (path, values) in self.arrays {
            let parent = path.rsplit_once('.').map_or("", |(parent, _)| parent);
            let names = self.names.iter().find(|(name, names)| {
                let beside = name.rsplit_once('.').map_or("", |(parent, _)| parent);
                beside == parent && names.len() == values.len()
            });
            fields.extend(
                values
                    .into_iter()
                    .enumerate()
                    .map(|(at, value)| match names {
                        Some((_, names)) => {
                            let (before, last) = path
                                .rsplit_once('.')
                                .map_or(("", path.as_str()), |parts| parts);
                            let dot = if before.is_empty() { "" } else { "." };
                            (format!("{before}{dot}{}.{last}", names[at]), value)
                        }
                        None => (format!("{path}[{at}]"), value),
                    }),
            );
        }
        Message { stamp_ns, fields }
    }
}

/// Reads aligned values. The alignment counts from the end of the encapsulation header.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    is_little: bool,
}

impl Reader<'_> {
    /// Bytes of a value of type `kind`. `None` if it is not a number.
    fn size(kind: &str) -> Option<usize> {
        Some(match kind {
            "bool" | "byte" | "char" | "int8" | "uint8" => 1,
            "int16" | "uint16" => 2,
            "int32" | "uint32" | "float32" => 4,
            "int64" | "uint64" | "float64" => 8,
            _ => return None,
        })
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size);
    }

    fn unsigned(&mut self, size: usize) -> Option<u64> {
        self.align(size);
        let bytes = self.bytes.get(self.at..self.at + size)?;
        self.at += size;
        let join = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        Some(if self.is_little {
            bytes.iter().rev().fold(0, join)
        } else {
            bytes.iter().fold(0, join)
        })
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "counters beyond 2^53 are no positions"
    )]
    fn number(&mut self, kind: &str) -> Option<f64> {
        let size = Self::size(kind)?;
        let bits = self.unsigned(size)?;
        let unused = 64 - 8 * u32::try_from(size).ok()?;
        Some(match kind {
            "float32" => f64::from(f32::from_bits(u32::try_from(bits).ok()?)),
            "float64" => f64::from_bits(bits),
            kind if kind.starts_with("int") => ((bits << unused).cast_signed() >> unused) as f64,
            _ => bits as f64,
        })
    }

    fn skip(&mut self, kind: &str, count: usize) -> Option<()> {
        let size = Self::size(kind)?;
        if count > 0 {
            self.align(size);
        }
        self.at = self.at.checked_add(size.checked_mul(count)?)?;
        (self.at <= self.bytes.len()).then_some(())
    }

    fn text(&mut self, is_wide: bool) -> Option<String> {
        let count = usize::try_from(self.unsigned(4)?).ok()?;
        let bytes = if is_wide {
            count.checked_mul(2)?
        } else {
            count
        };
        let text = self.bytes.get(self.at..self.at.checked_add(bytes)?)?;
        self.at += bytes;
        Some(
            String::from_utf8_lossy(text)
                .trim_end_matches('\0')
                .to_owned(),
        )
    }
}
