//! Checks that no input causes a panic or a duty beyond its limits.

use haptic_paddle::console;
use haptic_paddle::control::current::MAX_DUTY;
use haptic_paddle::controller::{Controller, Measurement, Mode, TickRate};
use haptic_paddle::excitation::{Excitation, Shape};
use haptic_paddle::safety::Fault;
use haptic_paddle::settings::{FIELDS, Kind, Settings};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Event {
    Measure {
        encoder_count: u32,
        hall_adc: u16,
        current_adc: f32,
        ticks: u8,
    },
    Arm(bool),
    Disarm,
    Clear,
    Zero(f32),
    Reference(f32),
    Start(Excitation),
    Apply(usize, f32),
    Say(Vec<u8>),
}

/// Numbers of all magnitudes, infinities and NaN.
fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![-1.0_f32..1.0, -100.0_f32..100.0, any::<f32>()]
}

fn excitation() -> impl Strategy<Value = Excitation> {
    (
        0..Shape::NAMED.len(),
        any_number(),
        any_number(),
        any_number(),
        any_number(),
        any_number(),
    )
        .prop_map(
            |(shape, amplitude, offset, frequency_hz, end_frequency_hz, duration_s)| Excitation {
                shape: Shape::NAMED[shape].1,
                amplitude,
                offset,
                frequency_hz,
                end_frequency_hz,
                duration_s,
            },
        )
}

fn line() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        "[a-z]{1,8}",
        "-?[0-9.e]{1,9}",
        prop::sample::select(
            console::COMMANDS
                .iter()
                .map(|usage| usage.name.to_owned())
                .collect::<Vec<_>>()
        ),
        prop::sample::select(
            FIELDS
                .iter()
                .map(|field| field.name.to_owned())
                .collect::<Vec<_>>()
        ),
        prop::sample::select(Shape::NAMED.map(|(name, _)| name.to_owned()).to_vec()),
    ];
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..120),
        prop::collection::vec(word, 0..7).prop_map(|words| words.join(" ").into_bytes()),
    ]
}

fn event() -> impl Strategy<Value = Event> {
    let near = (
        any::<i16>(),
        1_900_u16..2_200,
        1_900.0_f32..2_200.0,
        any::<u8>(),
    )
        .prop_map(|(count, hall_adc, current_adc, ticks)| Event::Measure {
            encoder_count: i32::from(count / 64) as u32,
            hall_adc,
            current_adc,
            ticks,
        });
    let far = (any::<u32>(), any::<u16>(), any::<f32>(), any::<u8>()).prop_map(
        |(encoder_count, hall_adc, current_adc, ticks)| Event::Measure {
            encoder_count,
            hall_adc,
            current_adc,
            ticks,
        },
    );
    prop_oneof![
        8 => near,
        1 => far,
        4 => any::<bool>().prop_map(Event::Arm),
        1 => Just(Event::Disarm),
        2 => Just(Event::Clear),
        2 => any_number().prop_map(Event::Zero),
        2 => any_number().prop_map(Event::Reference),
        2 => excitation().prop_map(Event::Start),
        3 => (0..FIELDS.len(), 0.0_f32..=1.0).prop_map(|(field, share)| Event::Apply(field, share)),
        3 => line().prop_map(Event::Say),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_input_causes_a_panic_or_a_duty_beyond_the_limits(
        divider in 0_u16..4, events in prop::collection::vec(event(), 1..60),
    ) {
        let rate = TickRate::new(20_000.0, divider);
        let mut settings = Settings::default();
        let mut controller = Controller::new(&settings, rate);
        for event in events {
            match event {
                Event::Measure { encoder_count, hall_adc, current_adc, ticks } => {
                    for _ in 0..ticks {
                        let duty = controller.step(&Measurement { encoder_count, hall_adc, current_adc });
                        prop_assert!(duty.0.abs() <= MAX_DUTY);
                        prop_assert!(controller.torque_command_nm().abs() <= settings.motor.torque_limit_nm);
                        if controller.fault().is_some() || controller.mode() == Mode::Off {
                            prop_assert_eq!(duty.0, 0.0);
                        }
                        prop_assert!(controller.fault() != Some(Fault::NonFinite) || !current_adc.is_finite());
                    }
                    if !current_adc.is_finite() {
                        controller.clear_fault();
                    }
                }
                Event::Arm(position) => {
                    let _ = controller.arm(if position { Mode::Position } else { Mode::Torque });
                }
                Event::Disarm => controller.disarm(),
                Event::Clear => controller.clear_fault(),
                Event::Zero(angle_rad) => {
                    let _ = controller.zero_at(angle_rad);
                }
                Event::Reference(reference) => {
                    let _ = controller.set_reference(reference);
                }
                Event::Start(excitation) => {
                    let _ = controller.start(&excitation);
                }
                Event::Apply(index, share) => {
                    let field = &FIELDS[index];
                    let value = match field.kind {
                        Kind::Number { min, max } => (min + (max - min) * share * share * share).min(max),
                        Kind::Choice(names) => (share * (names.len() - 1) as f32).round(),
                    };
                    field.write(&mut settings, value).unwrap();
                    controller.apply(&settings);
                }
                Event::Say(line) => {
                    if let Ok(Some(command)) = console::parse(&line) {
                        let answer = console::execute(&command, &mut settings, rate, &mut controller);
                        let text = answer.map_or_else(|refusal| refusal.to_string(), |answer| answer.to_string());
                        prop_assert!(!text.is_empty());
                    }
                }
            }
        }
    }

    #[test]
    fn no_line_causes_a_panic_of_the_parser(line in line()) {
        if let Err(error) = console::parse(&line) {
            prop_assert_eq!(error.to_string().lines().count(), 1);
        }
    }
}
