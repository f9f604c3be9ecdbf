//! Checks that the image and the host compute the same. Equal inputs lead to a bit-identical state, and an equal session on
//! the simulator's closed loop leads to the same motion of the paddle.

use std::collections::{VecDeque, vec_deque};
use std::slice;

use crate::bench::{Bench, CONTROL, image, quiet, setup};
use crate::lends::{Lend, Watch};
use haptic_paddle::console::{Device, Session};
use haptic_paddle::controller::{ArmError, Controller, Duty, Measurement, Mode, TickRate};
use haptic_paddle::sensing::current::IdleReading;
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::presets;
use virtual_board::board::{Pause, Step};
use virtual_board::cpu::Width;
use virtual_board::wiring::Wires;

/// Tick rate of the firmware.
const RATE: TickRate = TickRate::new(20_000.0, 2);
const OFFSET_PERIODS: usize = 1024;
const SAMPLES: u32 = 25;
const LOOK_S: f32 = 1e-3;
const BRIDGE_TOP: u16 = 2100;

/// A session with the position loop closed. Its lines are typed at intervals.
const CLOSED_LOOP: &[&str] = &[
    "zero hall",
    "arm",
    "set kp 0.02",
    "set ki 0.1",
    "ref 2",
    "start triangle 3 1",
    "start multisine 6 2",
    "set compensation.dry on",
    "step 5",
];
/// A session with torques only, in which no position loop corrects a difference.
const OPEN_LOOP: &[&str] = &[
    "zero hall",
    "arm torque",
    "start multisine 0.004 2",
    "ref 0.001",
    "start square 0.003 3",
    "start chirp 0.003 1 20 0.2",
    "ref -0.001",
    "start triangle 0.003 2",
    "start sine 0.003 1",
];
/// A session with all sensors, filters and modes. It ends in a fault outside the travel.
const EVERYTHING: &[&str] = &[
    "zero hall",
    "arm",
    "step 10",
    "set compensation.gravity on",
    "disarm",
    "set estimate.sensor hall",
    "set estimate.order second",
    "arm",
    "start square 2 5",
    "start multisine 6 2",
    "disarm",
    "arm torque",
    "start chirp 0.003 1 20 0.2",
    "ref 0.004",
];
const LINE_EVERY_S: f64 = 0.3;

/// Inputs and outputs of the image from the first control interrupt on.
struct Recorded {
    bench: Bench,
    /// Current readings from which the offset was computed, counts.
    idle: Vec<f32>,
    /// One entry per control interrupt, with its inputs.
    steps: Vec<Step>,
    lends: VecDeque<Lend>,
}

/// Runs the session on the board.
fn on_the_board(test: &str, setup: &LoopSetup, lines: &[&str]) -> Option<Recorded> {
    let mut bench = Bench::with(image(test)?, setup, Wires::default());
    let handler = bench.address_of(&["TIM8_UP_TIM13"]);
    let current = bench.address_of(&["Sensors", "current_counts"]);
    bench.board.record_steps(true);
    bench.board.cpu.set_breakpoint(current, true);
    bench.board.cpu.set_breakpoint(handler, true);
    let mut steps = Vec::new();
    let mut idle = Vec::new();
    loop {
        let Pause::Breakpoint(address) = bench.board.run_until(0.5).unwrap() else {
            panic!("no control interrupt");
        };
        steps.append(&mut bench.board.take_steps());
        if address == handler {
            break;
        }
        idle.push(current_counts(steps.last().unwrap()));
    }
    bench.board.cpu.set_breakpoint(current, false);
    bench.board.cpu.set_breakpoint(handler, false);
    let mut steps = steps.split_off(steps.len() - 1);

    let mut watch = Watch::new(&mut bench);
    for line in lines {
        let now_s = bench.board.time_s();
        bench.board.type_in(&format!("{line}\r"));
        watch.run_until(&mut bench, now_s + LINE_EVERY_S);
    }
    steps.append(&mut bench.board.take_steps());
    let served = bench.board.cpu.totals(CONTROL).count as usize;
    assert!(
        steps.len().abs_diff(served) <= 1,
        "{} steps, {served} interrupts",
        steps.len()
    );
    steps.truncate(served);
    Some(Recorded {
        bench,
        idle,
        steps,
        lends: watch.into_lends(),
    })
}

/// Mean of the ring buffer as the firmware computes it.
fn current_counts(step: &Step) -> f32 {
    assert_eq!(step.current.conversions, SAMPLES);
    step.current.sum as f32 * (1.0 / SAMPLES as f32)
}

fn measurement(step: &Step) -> Measurement {
    Measurement {
        encoder_count: step.encoder_count,
        hall_adc: step.hall_counts,
        current_adc: current_counts(step),
    }
}

/// Executes the console session as the image did. At each access, `lender` advances the controller to the tick of that
/// access.
fn follow<L: Device>(
    lines: &[&str],
    lends: &VecDeque<Lend>,
    mut lender: L,
    left: impl Fn(&L) -> usize,
    ready: Result<(), ArmError>,
) -> L {
    let mut session = Session::new(Settings::default(), RATE, ready);
    let mut typed = lines.iter().flat_map(|line| line.bytes().chain([b'\r']));
    let mut screen = String::new();
    while left(&lender) > 0 {
        let next = lends[lends.len() - left(&lender)];
        if !next.by_command {
            session.look(LOOK_S, &mut lender, &mut screen);
            continue;
        }
        let before = left(&lender);
        while left(&lender) == before {
            let byte = typed
                .next()
                .unwrap_or_else(|| panic!("no command is left for {next:?}: {screen}"));
            session.type_in(byte, &mut lender, &mut screen);
        }
    }
    println!("{screen}");
    lender
}

/// A controller on the host with the recorded inputs of the image.
struct Replay<'a> {
    controller: Controller,
    steps: slice::Iter<'a, Step>,
    lends: vec_deque::Iter<'a, Lend>,
    ticks: u32,
}

impl Replay<'_> {
    /// Advances to `tick` and compares each duty with that of the image.
    fn step_to(&mut self, tick: u32) {
        while self.ticks < tick {
            let Some(step) = self.steps.next() else {
                return;
            };
            let duty = self.controller.step(&measurement(step));
            let duty = if self.controller.mode() == Mode::Off {
                Duty::ZERO
            } else {
                duty
            };
            // The image wrote the duty during the period that began with this step, so the next step contains it.
            if let Some(next) = self.steps.as_slice().first() {
                assert_eq!(
                    u32::from(duty.compare(BRIDGE_TOP)),
                    next.compare,
                    "tick {}",
                    self.ticks
                );
            }
            self.ticks += 1;
        }
    }
}

impl Device for Replay<'_> {
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        if let Some(lend) = self.lends.next() {
            self.step_to(lend.tick);
        }
        work(&mut self.controller)
    }
}

#[test]
fn every_duty_and_the_final_state_are_bit_identical_on_the_host() {
    let Some(mut session) = on_the_board("replay", &setup(presets::refit()), EVERYTHING) else {
        return;
    };
    let mut controller = Controller::new(&Settings::default(), RATE);
    assert_eq!(session.idle.len(), OFFSET_PERIODS);
    let mut idle = IdleReading::default();
    session.idle.iter().for_each(|counts| idle.add(*counts));
    let ready = controller
        .calibrate_current_offset(&idle)
        .map_err(ArmError::Offset);
    let replay = Replay {
        controller,
        steps: session.steps.iter(),
        lends: session.lends.iter(),
        ticks: 0,
    };
    let mut replay = follow(
        EVERYTHING,
        &session.lends,
        replay,
        |replay| replay.lends.len(),
        ready,
    );
    replay.step_to(session.steps.len() as u32);
    assert!(replay.ticks > 50_000, "{}", replay.ticks);

    // Every number of the host's controller must be in the image's controller. The order of the fields may differ.
    let symbol = session
        .bench
        .image
        .symbol(|name| name.contains("shared_resource_controller"))
        .unwrap()
        .clone();
    let memories = session.bench.board.memories();
    let held: Vec<_> = (symbol.address..symbol.address + symbol.size)
        .step_by(4)
        .filter_map(|address| memories.read(address, Width::Word))
        .collect();
    let shown = format!("{:?}", replay.controller);
    let numbers: Vec<f32> = shown
        .split([' ', ',', '(', ')', '{', '}', ':', '[', ']'])
        .filter(|word| word.contains('.') || word.contains('e'))
        .filter_map(|word| word.parse().ok())
        .collect();
    assert!(numbers.len() > 40, "{shown}");
    for number in numbers {
        assert!(
            held.contains(&number.to_bits()),
            "{number:e} is not in the image's controller: {shown}"
        );
    }
}

/// The simulator's closed loop, which is advanced to the tick of each access.
struct Simulation<'a> {
    closed_loop: ClosedLoop,
    lends: vec_deque::Iter<'a, Lend>,
    positions_rad: Vec<f64>,
}

impl Simulation<'_> {
    fn run_to(&mut self, tick: usize) {
        while self.positions_rad.len() < tick {
            self.positions_rad
                .push(self.closed_loop.tick().position_rad);
        }
    }
}

impl Device for Simulation<'_> {
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        if let Some(lend) = self.lends.next() {
            self.run_to(lend.tick as usize);
        }
        work(self.closed_loop.controller_mut())
    }
}

/// Runs a session on the board and in the simulator. Returns the rms position difference, rad, and the time for which the
/// paddle stuck, s.
fn distance(test: &str, lines: &[&str]) -> Option<(f64, f64)> {
    // The paddle sticks at every turning point.
    let mut device = presets::refit();
    device.mechanics.friction.stribeck.ratio = 1.5;
    let mut setup = quiet(device);
    setup.paddle.bridge_top = Some(BRIDGE_TOP);
    let session = on_the_board(test, &setup, lines)?;
    let simulation = Simulation {
        closed_loop: ClosedLoop::new(&setup).unwrap(),
        lends: session.lends.iter(),
        positions_rad: Vec::new(),
    };
    let mut simulation = follow(
        lines,
        &session.lends,
        simulation,
        |simulation| simulation.lends.len(),
        Ok(()),
    );
    simulation.run_to(session.steps.len());
    let squares: f64 = session
        .steps
        .iter()
        .zip(&simulation.positions_rad)
        .map(|(step, position_rad)| (step.position_rad - position_rad).powi(2))
        .sum();
    let rms_rad = (squares / session.steps.len() as f64).sqrt();
    let seconds = session.steps.len() as f64 / 20_000.0;
    let stuck = session
        .steps
        .iter()
        .filter(|step| step.duty.is_some() && step.velocity_rad_s == 0.0)
        .count();
    let stuck_s = stuck as f64 / 20_000.0;
    println!("{rms_rad:.2e} rad rms over {seconds:.2} s, of which {stuck_s:.2} s stuck");
    assert!(seconds > 2.0);
    Some((rms_rad, stuck_s))
}

/// Limit of the rms difference over a session.
const CLOSE_RAD: f64 = 1e-4;

#[test]
fn the_simulators_closed_loop_follows_the_board() {
    let Some((rms_rad, stuck_s)) = distance("the_simulators_closed_loop", CLOSED_LOOP) else {
        return;
    };
    assert!(stuck_s > 0.05, "{stuck_s}");
    assert!(rms_rad < CLOSE_RAD, "{rms_rad:e}");
}

#[test]
fn the_simulator_follows_the_board_in_open_loop() {
    let Some((rms_rad, _)) = distance("so_it_does", OPEN_LOOP) else {
        return;
    };
    assert!(rms_rad < 0.1 * CLOSE_RAD, "{rms_rad:e}");
}
