//! Tests frames and text on one line.

use link::{
    Body, Channels, Frame, Heard, MOST_BYTES, Sample, Sequence, ShortSample, Splitter, Trigger,
    encode,
};
use proptest::prelude::*;

/// A body that owns its bytes.
#[derive(Clone, Debug)]
enum Owned {
    Row(u32, u32, Vec<u8>),
    Capture(u16, u16, u32),
    Samples(u16, Vec<u8>),
}

impl Owned {
    fn body(&self) -> Body<'_> {
        match self {
            Self::Row(period, dropped, values) => Body::Row {
                period: *period,
                dropped: *dropped,
                channels: Channels::ALL,
                values,
            },
            Self::Capture(samples, triggered_at, period) => Body::Capture {
                trigger: Trigger::Level,
                samples: *samples,
                triggered_at: *triggered_at,
                period: *period,
            },
            Self::Samples(first, samples) => Body::Samples {
                first: *first,
                samples,
            },
        }
    }
}

fn body() -> impl Strategy<Value = Owned> {
    let bytes = |most| proptest::collection::vec(any::<u8>(), 0..=most);
    prop_oneof![
        (any::<u32>(), any::<u32>(), bytes(36)).prop_map(|(a, b, c)| Owned::Row(a, b, c)),
        (any::<u16>(), any::<u16>(), any::<u32>()).prop_map(|(a, b, c)| Owned::Capture(a, b, c)),
        (any::<u16>(), bytes(128)).prop_map(|(a, b)| Owned::Samples(a, b)),
    ]
}

/// A part of the sent bytes: text without zero bytes, or a frame.
#[derive(Clone, Debug)]
enum Sent {
    Text(Vec<u8>),
    Frame(u16, Owned),
}

fn sent() -> impl Strategy<Value = Vec<Sent>> {
    let one = prop_oneof![
        proptest::collection::vec(1u8.., 0..40).prop_map(Sent::Text),
        (any::<u16>(), body()).prop_map(|(number, body)| Sent::Frame(number, body)),
    ];
    proptest::collection::vec(one, 0..12)
}

fn wire(sent: &[Sent]) -> Vec<u8> {
    let mut all = Vec::new();
    for one in sent {
        match one {
            Sent::Text(text) => all.extend(text),
            Sent::Frame(number, body) => {
                let mut room = [0; MOST_BYTES];
                let frame = Frame::new(*number, body.body());
                all.extend(encode(&frame, &mut room).unwrap());
            }
        }
    }
    all
}

/// Splits `bytes`. Returns the text, the frames as text for comparison, and the number of invalid frames.
fn heard(bytes: &[u8]) -> (Vec<u8>, Vec<String>, usize) {
    let (mut text, mut frames, mut corrupt) = (Vec::new(), Vec::new(), 0);
    let mut splitter = Splitter::default();
    for byte in bytes {
        match splitter.push(*byte) {
            Heard::Nothing => {}
            Heard::Text(byte) => text.push(byte),
            Heard::Frame(frame) => frames.push(format!("{frame:?}")),
            Heard::Corrupt | Heard::OtherVersion(_) => corrupt += 1,
        }
    }
    (text, frames, corrupt)
}

fn expected(sent: &[Sent]) -> (Vec<u8>, Vec<String>, usize) {
    let (mut text, mut frames) = (Vec::new(), Vec::new());
    for one in sent {
        match one {
            Sent::Text(bytes) => text.extend(bytes),
            Sent::Frame(number, body) => {
                frames.push(format!("{:?}", Frame::new(*number, body.body())));
            }
        }
    }
    (text, frames, 0)
}

proptest! {
    #[test]
    fn text_and_frames_are_received_as_sent(sent in sent()) {
        prop_assert_eq!(heard(&wire(&sent)), expected(&sent));
    }

    #[test]
    fn a_changed_byte_loses_at_most_two_frames_and_creates_none(
        body in body(), at in any::<prop::sample::Index>(), change in 1u8..
    ) {
        let sent: Vec<_> = (0..8).map(|number| Sent::Frame(number, body.clone())).collect();
        let mut bytes = wire(&sent);
        let at = at.index(bytes.len());
        bytes[at] ^= change;
        let (_, frames, _) = heard(&bytes);
        let (_, expected, _) = expected(&sent);
        prop_assert!(frames.iter().all(|frame| expected.contains(frame)), "{frames:?}");
        prop_assert!(frames.len() >= 6, "only {} of 8", frames.len());
    }

    #[test]
    fn noise_gives_no_frame_and_the_next_frames_are_received(noise in proptest::collection::vec(any::<u8>(), 0..600), body in body()) {
        let mut bytes = noise;
        let sent = [Sent::Frame(1, body.clone()), Sent::Frame(2, body.clone()), Sent::Frame(3, body)];
        bytes.extend(wire(&sent));
        let (_, frames, _) = heard(&bytes);
        let (_, expected, _) = expected(&sent);
        prop_assert_eq!(frames.last(), expected.last());
    }
}

#[test]
fn frames_of_another_version_are_reported() {
    let body = Body::Samples {
        first: 0,
        samples: &[1, 2, 3],
    };
    let mut frame = Frame::new(1, body);
    frame.version = 9;
    let mut room = [0; MOST_BYTES];
    let mut splitter = Splitter::default();
    let bytes = encode(&frame, &mut room).unwrap();
    let told = bytes
        .iter()
        .filter(|byte| splitter.push(**byte) == Heard::OtherVersion(9));
    assert_eq!(told.count(), 1);
}

#[test]
fn a_row_has_at_most_the_computed_size() {
    for count in 0..=9 {
        let values = vec![0xFF; 4 * count];
        let frame = Frame::new(
            u16::MAX,
            Body::Row {
                period: u32::MAX,
                dropped: u32::MAX,
                channels: Channels::ALL,
                values: &values,
            },
        );
        let mut room = [0; MOST_BYTES];
        let length = encode(&frame, &mut room).unwrap().len();
        assert!(length <= link::row_bytes(count), "{length} of {count}");
    }
}

#[test]
fn lost_frames_are_counted() {
    let mut sequence = Sequence::default();
    for number in [65_534, 65_535, 0, 1, 4] {
        sequence.follow(number);
    }
    assert_eq!(sequence.lost(), 2);
}

#[test]
fn channels_are_named_and_read_back() {
    for names in ["encoder", "setpoint,encoder,hall,velocity,torque,current"] {
        assert_eq!(Channels::parse(names).unwrap().to_string(), names);
    }
    assert_eq!(Channels::parse("all").unwrap().len(), 9);
    assert!(Channels::parse("encoder,fish").is_err());
}

proptest! {
    #[test]
    fn a_short_sample_is_accurate_to_its_resolution(
        angle in -1.9f32..1.9, velocity in -60.0f32..60.0, torque in -0.1f32..0.1, duty in -0.95f32..0.95,
        mode in 0u8..4, fault in 0u8..20
    ) {
        let sample = Sample {
            setpoint: if mode == 2 { torque } else { angle },
            encoder_rad: angle,
            hall_rad: -angle,
            velocity_rad_s: velocity,
            torque_nm: torque,
            current_a: angle,
            duty,
            mode,
            fault,
        };
        let short = ShortSample::from(&sample);
        prop_assert_eq!(ShortSample::from_bytes(short.to_bytes()), short);
        let back = Sample::from(short);
        prop_assert!((back.encoder_rad - angle).abs() <= 6.2e-5, "{back:?}");
        prop_assert!((back.velocity_rad_s - velocity).abs() <= 2e-3, "{back:?}");
        prop_assert!((back.torque_nm - torque).abs() <= 4e-6, "{back:?}");
        prop_assert!((back.setpoint - sample.setpoint).abs() <= 6.2e-5, "{back:?}");
        prop_assert_eq!((back.mode, back.fault), (mode, fault));
        prop_assert_eq!(ShortSample::from(&back), short);
    }
}
