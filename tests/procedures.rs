//! Tests of the procedures on simulated paddles. The results are compared with the true parameters. All commands pass the
//! console, and the wiring check runs first.

use haptic_paddle::console::{Device, Session};
use haptic_paddle::controller::{Controller, Mode, TickRate};
use haptic_paddle::sensing::hall;
use haptic_paddle::sensing::hall::HallCurve;
use haptic_paddle::settings::Settings;
use haptic_paddle::telemetry::{ShortSample, Telemetry};
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::presets;
use host_sim::sensing::Sensing;
use host_sim::sensors::Hall;

const TICK_HZ: f32 = 20_000.0;
const RATE: TickRate = TickRate::new(TICK_HZ, 2);
const TICKS_PER_LOOK: u32 = 20;
const RATIO: f64 = 15.0;
const PADDLES: u64 = 20;

/// Pseudo-random numbers with a fixed seed.
struct Draw(u64);

impl Draw {
    /// A number between `low` and `high`.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        // Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014).
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        low + (high - low) * (bits >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A paddle with random parameters of mechanics, motor and Hall sensor.
fn paddle(seed: u64) -> LoopSetup {
    let draw = &mut Draw(seed);
    let mut device = presets::refit();
    let mechanics = &mut device.mechanics;
    mechanics.inertia = draw.between(4.0e-4, 7.0e-4);
    mechanics.viscous = draw.between(1e-4, 6e-3);
    mechanics.gravity = draw.between(0.008, 0.02);
    let level_nm = RATIO * draw.between(0.3e-3, 1.7e-3);
    let skew = draw.between(-0.3, 0.3);
    mechanics.friction.level_nm = [level_nm * (1.0 + skew), level_nm * (1.0 - skew)];
    mechanics.friction.stribeck.ratio = draw.between(1.0, 1.3);
    mechanics.friction.stribeck.velocity = draw.between(0.05, 0.2);
    let mut motor = presets::motor();
    motor.resistance_ohm = draw.between(8.0, 16.0);
    motor.inductance_h = draw.between(0.8e-3, 2.0e-3);
    let mut setup = LoopSetup::firmware(device, Settings::default(), motor);
    setup.paddle.hall.centre_v = draw.between(2.3, 2.7);
    setup.paddle.hall.volts_per_rad = 1.0 / draw.between(19.0, 53.0).to_radians();
    setup.paddle.hall.sensing = Sensing {
        quadratic: draw.between(-0.1, 0.1),
        cubic: draw.between(-0.3, 0.1),
        ..Sensing::ideal()
    };
    setup.paddle.bridge_top = Some(2100);
    setup.paddle.seed = seed;
    setup
}

/// The same paddle with a calibrated Hall sensor.
fn calibrated(seed: u64) -> LoopSetup {
    let mut setup = paddle(seed);
    setup.paddle.hall = Hall::calibrated(&setup.settings.hall);
    setup
}

/// A paddle with its console.
struct Bench {
    paddle: ClosedLoop,
    telemetry: Telemetry,
    session: Session,
    screen: String,
    ticks: u32,
    /// Largest angle so far, rad.
    widest_rad: f64,
}

/// Access of the console to the controller.
struct Reach<'a>(&'a mut Controller, &'a mut Telemetry);

impl Device for Reach<'_> {
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        work(self.0)
    }

    fn telemetry<R>(&mut self, work: impl FnOnce(&mut Telemetry) -> R) -> Option<R> {
        Some(work(self.1))
    }
}

impl Bench {
    fn new(setup: &LoopSetup) -> Self {
        let memory = vec![ShortSample::NONE; 16].leak();
        Self {
            paddle: ClosedLoop::new(setup).unwrap(),
            telemetry: Telemetry::new(memory, TICK_HZ, 460_800),
            session: Session::new(setup.settings, RATE, Ok(())),
            screen: String::new(),
            ticks: 0,
            widest_rad: 0.0,
        }
    }

    fn tick(&mut self) {
        self.paddle.tick();
        self.ticks += 1;
        self.widest_rad = self
            .widest_rad
            .max(self.paddle.paddle().position_rad().abs());
        let sample = self.paddle.controller().sample();
        self.telemetry.add(self.ticks, &sample);
        if self.ticks.is_multiple_of(TICKS_PER_LOOK) {
            let device = &mut Reach(self.paddle.controller_mut(), &mut self.telemetry);
            let elapsed_s = TICKS_PER_LOOK as f32 / TICK_HZ;
            self.session.look(elapsed_s, device, &mut self.screen);
        }
    }

    /// Types a line and waits for the answer. Returns the time in s.
    fn enter(&mut self, line: &str) -> f32 {
        const PATIENCE_S: f32 = 62.0;
        self.screen.clear();
        let from = self.ticks;
        for byte in line.bytes().chain([b'\r']) {
            let device = &mut Reach(self.paddle.controller_mut(), &mut self.telemetry);
            self.session.type_in(byte, device, &mut self.screen);
        }
        while !self.session.listens() {
            self.tick();
            let took_s = (self.ticks - from) as f32 / TICK_HZ;
            assert!(took_s < PATIENCE_S, "{line} has not ended: {}", self.screen);
        }
        (self.ticks - from) as f32 / TICK_HZ
    }

    /// The first number after `word` on the screen.
    fn number(&self, word: &str) -> f64 {
        let rest = self.screen.split(word).nth(1);
        let rest = rest.unwrap_or_else(|| panic!("no {word:?} in {}", self.screen));
        let number = rest
            .trim_start()
            .split([' ', ';', ',', '\r'])
            .next()
            .unwrap();
        number
            .parse()
            .unwrap_or_else(|_| panic!("{word:?} in {}", self.screen))
    }
}

#[test]
fn friction_is_within_a_tenth_of_the_static_level() {
    for seed in 0..PADDLES {
        let setup = calibrated(seed);
        let mut bench = Bench::new(&setup);
        let took_s = bench.enter("friction");
        let friction = &setup.paddle.device.mechanics.friction;
        let truth = friction
            .level_nm
            .map(|nm| 1e3 * nm * friction.stribeck.ratio / RATIO);
        let found = ["forward", "backward"].map(|way| bench.number(way));
        println!(
            "{seed}: {found:.3?} of {truth:.3?} mN m in {took_s:.0} s, {:.1} deg at most",
            bench.widest_rad.to_degrees()
        );
        for (found, truth) in found.iter().zip(truth) {
            assert!(
                (found / truth - 1.0).abs() < 0.1,
                "{seed}: {}",
                bench.screen
            );
        }
        let gravity = bench.number("springs:");
        let truth = setup.paddle.device.mechanics.gravity;
        assert!(
            (gravity / truth - 1.0).abs() < 0.25,
            "{seed}: {gravity} of {truth}"
        );
        assert!(took_s < 60.0 && bench.widest_rad.to_degrees() < 20.0);
        assert_eq!(bench.paddle.controller().mode(), Mode::Off);
    }
}

#[test]
fn the_hall_sensor_is_within_0_3_degrees_over_the_travel() {
    for seed in 0..PADDLES {
        let setup = paddle(seed);
        let mut bench = Bench::new(&setup);
        let took_s = bench.enter("hall cal");
        assert!(bench.screen.contains("are set"), "{seed}: {}", bench.screen);
        let curve = HallCurve::new(&bench.session.settings().hall);
        let sensor = &setup.paddle.hall;
        let worst_deg = (-330..=330)
            .map(|tenth| f64::from(tenth) * 0.1)
            .map(|truth_deg| {
                let angle = sensor.sensing.curve(truth_deg.to_radians());
                let volts = sensor.centre_v + sensor.volts_per_rad * angle;
                let per_count = f64::from(hall::volts(1) - hall::volts(0));
                let count = (volts - f64::from(hall::volts(0))) / per_count;
                f64::from(curve.position_rad(count.round() as u16)).to_degrees() - truth_deg
            })
            .fold(0.0, |worst: f64, error_deg| worst.max(error_deg.abs()));
        println!("{seed}: off by {worst_deg:.3} deg at most, in {took_s:.0} s");
        assert!(worst_deg < 0.3, "{seed}: {worst_deg}: {}", bench.screen);
        assert!(took_s < 60.0 && bench.widest_rad.to_degrees() < 36.0);
        assert_eq!(bench.paddle.controller().mode(), Mode::Off);
        // The sensors now agree, so the paddle can be armed and moved.
        bench.enter("arm");
        bench.enter("ref 25");
        for _ in 0..20_000 {
            bench.tick();
        }
        assert_eq!(bench.paddle.controller().fault(), None, "{seed}");
    }
}

#[test]
fn resistance_and_inductance_are_within_a_twentieth() {
    for seed in 0..PADDLES {
        let setup = paddle(seed);
        let host_sim::paddle::Actuator::Bridge(motor) = setup.paddle.actuator else {
            unreachable!()
        };
        let mut bench = Bench::new(&setup);
        let took_s = bench.enter("motor id");
        assert!(bench.screen.contains("are set"), "{seed}: {}", bench.screen);
        let found = bench.session.settings().motor;
        let resistance = f64::from(found.resistance_ohm) / motor.resistance_ohm;
        let inductance = f64::from(found.inductance_h) / motor.inductance_h;
        println!("{seed}: R {resistance:.4}, L {inductance:.4} of the truth, in {took_s:.1} s");
        assert!(
            (resistance - 1.0).abs() < 0.05 && (inductance - 1.0).abs() < 0.05,
            "{seed}"
        );
        assert!(
            bench.widest_rad.to_degrees() < 10.0,
            "the wiring check's push, and no more"
        );
        assert_eq!(bench.paddle.controller().mode(), Mode::Off);
    }
}

#[test]
fn the_relay_finds_a_period_and_stays_within_its_limits() {
    for seed in 0..PADDLES {
        let setup = calibrated(seed);
        let mut bench = Bench::new(&setup);
        let took_s = bench.enter("zn");
        println!(
            "{seed}: in {took_s:.1} s, {:.1} deg at most: {}",
            bench.widest_rad.to_degrees(),
            bench.screen
        );
        assert!(bench.widest_rad.to_degrees() < 25.0, "{seed}");
        assert!(took_s < 60.0);
        // Inertia torque for this oscillation. Friction, gravity and the filter account for the difference.
        let period_s = 1e-3 * bench.number("ultimate period");
        let rate_rad_s = std::f64::consts::TAU / period_s;
        let inertia = setup.paddle.device.mechanics.inertia;
        let alone = (inertia * rate_rad_s * rate_rad_s).to_radians();
        let ratio = bench.number("ultimate gain") / alone;
        assert!(
            (0.8..1.4).contains(&ratio),
            "{seed}: {ratio} times the mass alone"
        );
        assert_eq!(bench.paddle.controller().mode(), Mode::Off);
    }
}
