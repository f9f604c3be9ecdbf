//! Tests of a console session on a paddle whose wires may be swapped. The position loop must close only with correct wiring.

use std::f32::consts::TAU;

use haptic_paddle::console::Session;
use haptic_paddle::controller::{ArmError, Controller, Measurement, Mode, TickRate};
use haptic_paddle::sensing::current::IdleReading;
use haptic_paddle::settings::Settings;

const TICK_HZ: f32 = 20_000.0;
const RATE: TickRate = TickRate::new(TICK_HZ, 2);
const TICKS_PER_LOOK: usize = 20;
const RATIO: f32 = 15.0;

/// Wiring of each part: 1 is correct, -1 is reversed, 0 is cut.
#[derive(Clone, Copy)]
struct Wires {
    motor: f32,
    encoder: f32,
    hall: f32,
}

const SOUND: Wires = Wires {
    motor: 1.0,
    encoder: 1.0,
    hall: 1.0,
};

/// A test bench: a paddle with inertia and friction, its motor, and a terminal.
struct Bench {
    wires: Wires,
    angle_rad: f32,
    velocity_rad_s: f32,
    current_a: f32,
    controller: Controller,
    session: Session,
    screen: String,
}

impl Bench {
    fn new(wires: Wires) -> Self {
        let settings = Settings::default();
        let mut bench = Self {
            wires,
            angle_rad: 0.0,
            velocity_rad_s: 0.0,
            current_a: 0.0,
            controller: Controller::new(&settings, RATE),
            session: Session::new(settings, RATE, Ok(())),
            screen: String::new(),
        };
        bench.run(0.01);
        bench
    }

    fn measure(&self) -> Measurement {
        let counts = self.wires.encoder * self.angle_rad * RATIO / TAU * 2000.0;
        // Inverse of the default calibration (33 V - 81.9 degrees) and of the board's voltage divider.
        let hall_v = (self.wires.hall * self.angle_rad.to_degrees() + 81.9) / 33.0;
        let pin_v = ((hall_v - 2.5) * 1.1 + 2.5) / 2.0;
        Measurement {
            encoder_count: counts.round() as i32 as u32,
            hall_adc: (pin_v / 2.5 * 4096.0).round() as u16,
            current_adc: 2048.0 - self.current_a * 1228.8,
        }
    }

    fn run(&mut self, seconds: f32) {
        const INERTIA_KG_M2: f32 = 5.5e-4;
        const VISCOUS_NM_S: f32 = 4e-3;
        const TORQUE_CONSTANT: f32 = 0.0538;
        const RESISTANCE_OHM: f32 = 10.6;
        /// Share of the distance to the steady-state current that the winding covers in a tick.
        const SETTLED_SHARE: f32 = 0.346;
        for tick in 0..(seconds * TICK_HZ) as usize {
            let measurement = self.measure();
            let duty = self.controller.step(&measurement);
            let constant = self.wires.motor * TORQUE_CONSTANT;
            if self.controller.mode() == Mode::Off || constant == 0.0 {
                self.current_a = 0.0;
            } else {
                let driving_v = 24.0 * duty.0 - constant * RATIO * self.velocity_rad_s;
                self.current_a += (driving_v / RESISTANCE_OHM - self.current_a) * SETTLED_SHARE;
            }
            let torque_nm = RATIO * constant * self.current_a;
            let acceleration = (torque_nm - VISCOUS_NM_S * self.velocity_rad_s) / INERTIA_KG_M2;
            self.velocity_rad_s += acceleration / TICK_HZ;
            self.angle_rad += self.velocity_rad_s / TICK_HZ;
            if tick % TICKS_PER_LOOK == 0 {
                let elapsed_s = TICKS_PER_LOOK as f32 / TICK_HZ;
                self.session
                    .look(elapsed_s, &mut self.controller, &mut self.screen);
            }
        }
    }

    /// Types a line, waits half a second, and returns the new text on the screen.
    fn enter(&mut self, line: &str) -> String {
        self.screen.clear();
        self.keys(line);
        self.keys("\r");
        self.run(0.5);
        self.screen.clone()
    }

    fn keys(&mut self, keys: &str) {
        for byte in keys.bytes() {
            self.session
                .type_in(byte, &mut self.controller, &mut self.screen);
        }
    }
}

#[test]
fn a_sound_paddle_is_checked_armed_and_follows_a_step() {
    let mut bench = Bench::new(SOUND);
    bench.enter("zero");
    let screen = bench.enter("arm");
    assert!(screen.contains("checking the wiring"), "{screen}");
    assert!(screen.contains("mode position"), "{screen}");
    assert!(
        bench.angle_rad.to_degrees().abs() < 10.0,
        "the check is a small push, not {} deg",
        bench.angle_rad.to_degrees()
    );
    bench.enter("ref 0");
    bench.enter("step 10");
    let error_deg = (bench.controller.position_rad().to_degrees() - 10.0).abs();
    assert!(error_deg < 0.5, "{error_deg}");
}

#[test]
fn the_check_is_done_once() {
    let mut bench = Bench::new(SOUND);
    bench.enter("zero");
    bench.enter("arm");
    bench.enter("disarm");
    let screen = bench.enter("arm");
    assert!(!screen.contains("checking"), "{screen}");
    assert_eq!(bench.controller.mode(), Mode::Position);
}

#[test]
fn a_swapped_or_cut_wire_is_named_and_prevents_arming() {
    let cases = [
        (
            "motor wires",
            Wires {
                motor: 0.0,
                ..SOUND
            },
        ),
        (
            "swap the two motor wires",
            Wires {
                motor: -1.0,
                ..SOUND
            },
        ),
        (
            "swap its wires A and B",
            Wires {
                encoder: -1.0,
                ..SOUND
            },
        ),
        (
            "encoder does not count",
            Wires {
                encoder: 0.0,
                ..SOUND
            },
        ),
        (
            "hall.slope",
            Wires {
                hall: -1.0,
                ..SOUND
            },
        ),
        ("Hall sensor does not see", Wires { hall: 0.0, ..SOUND }),
    ];
    for (hint, wires) in cases {
        let mut bench = Bench::new(wires);
        bench.enter("zero");
        let screen = bench.enter("arm");
        assert!(screen.contains(hint), "{hint}: {screen}");
        assert_eq!(bench.controller.mode(), Mode::Off, "{hint}");
        assert!(
            bench.angle_rad.to_degrees().abs() < 10.0,
            "{hint}: moved {} deg",
            bench.angle_rad.to_degrees()
        );
        bench.enter("clear");
        let again = bench.enter("arm");
        assert!(again.contains("checking"), "{hint}: not checked again");
    }
}

#[test]
fn arming_needs_a_zero_first() {
    let mut bench = Bench::new(SOUND);
    let screen = bench.enter("arm");
    assert!(screen.contains("zero"), "{screen}");
    assert!(!screen.contains("checking"), "{screen}");
    assert_eq!(bench.angle_rad, 0.0);
}

#[test]
fn an_amplifier_that_cannot_be_calibrated_prevents_arming() {
    let mut bench = Bench::new(SOUND);
    let offset = bench
        .controller
        .calibrate_current_offset(&IdleReading::default());
    assert!(offset.is_err());
    bench.session = Session::new(Settings::default(), RATE, offset.map_err(ArmError::Offset));
    bench.enter("zero");
    for line in ["arm", "arm torque"] {
        let screen = bench.enter(line);
        assert!(screen.contains("current amplifier"), "{screen}");
        assert_eq!(bench.controller.mode(), Mode::Off);
    }
}

#[test]
fn a_fault_is_announced_once_and_requires_a_new_check() {
    let mut bench = Bench::new(SOUND);
    bench.enter("zero");
    bench.enter("arm");
    bench.screen.clear();
    bench
        .controller
        .report_fault(haptic_paddle::safety::Fault::Bridge);
    bench.run(0.1);
    assert_eq!(
        bench.screen.matches("fault:").count(),
        1,
        "{}",
        bench.screen
    );
    bench.enter("clear");
    let screen = bench.enter("arm");
    assert!(screen.contains("checking"), "{screen}");
}

#[test]
fn a_line_interrupted_by_an_announcement_is_printed_again() {
    let mut bench = Bench::new(SOUND);
    bench.enter("zero");
    bench.screen.clear();
    bench.keys("set pid.kp 0.0");
    bench
        .controller
        .report_fault(haptic_paddle::safety::Fault::Bridge);
    bench.run(0.01);
    assert!(
        bench.screen.ends_with("\r\n> set pid.kp 0.0"),
        "{:?}",
        bench.screen
    );
    bench.keys("4\r");
    assert_eq!(bench.session.settings().pid.kp_nm_per_deg, 0.04);
    assert!(bench.screen.ends_with("\r\n> "), "{:?}", bench.screen);
}

#[test]
fn typed_characters_are_echoed_and_can_be_deleted() {
    let mut bench = Bench::new(SOUND);
    let screen = bench.enter("set kq\x7fp 0.04");
    assert!(
        screen.starts_with("set kq\x08 \x08p 0.04\r\n"),
        "{screen:?}"
    );
    assert!(screen.ends_with("> "), "{screen:?}");
    assert_eq!(bench.session.settings().pid.kp_nm_per_deg, 0.04);
}

#[test]
fn tab_completes_commands_settings_and_choices() {
    let mut bench = Bench::new(SOUND);
    for (typed, line) in [
        ("sta\ttu\t", "> status "),
        ("get pid.der\t", "> get pid.derivative"),
        ("set estimate.sen\th\t", "> set estimate.sensor hall "),
        ("arm t\t", "> arm torque "),
        ("start mu\t", "> start multisine "),
    ] {
        bench.screen.clear();
        bench.keys(typed);
        let shown = bench.screen.replace("\x1b[K", "");
        assert!(shown.ends_with(line), "{typed:?}: {shown:?}");
        bench.keys("\x15");
    }
    bench.screen.clear();
    bench.keys("get pid.k\t");
    assert!(
        bench.screen.contains("pid.kp  pid.ki  pid.kd"),
        "{}",
        bench.screen
    );
    assert!(
        bench.screen.ends_with("\r\x1b[K> get pid.k"),
        "{:?}",
        bench.screen
    );
}

#[test]
fn an_invalid_signal_is_refused() {
    let mut bench = Bench::new(SOUND);
    bench.enter("zero");
    bench.enter("arm torque");
    for (line, hint) in [
        ("start sine 0.001 1000", "500 Hz"),
        ("start sine 0.001 1000 2", "500 Hz"),
        ("start multisine 0.001 100 2", "500 Hz"),
        ("start chirp 0.001 1 2000 5", "500 Hz"),
        ("start square 0.001 200", "how many seconds"),
        ("start square 0.001 200 3600", "how many seconds"),
    ] {
        let screen = bench.enter(line);
        assert!(screen.contains(hint), "{line}: {screen}");
        assert!(!bench.controller.excited(), "{line}");
    }
    bench.enter("start sine 0.001 200 5");
    assert!(bench.controller.excited());
}

#[test]
fn the_greeting_and_the_version_are_printed_on_request() {
    let mut bench = Bench::new(SOUND);
    for (line, hint) in [("hello", "disarmed; help lists"), ("version", "commit")] {
        let screen = bench.enter(line);
        assert!(screen.contains(hint) && screen.ends_with("> "), "{screen}");
    }
    bench.enter("arm torque");
    assert!(bench.enter("reboot").contains("disarm first"));
    assert_eq!(bench.controller.mode(), Mode::Torque);
}
