//! Test bench: the board with the paddle, and a user at the terminal.

use std::path::{Path, PathBuf};

use haptic_paddle::settings::Settings;
use host_sim::closed_loop::LoopSetup;
use host_sim::device::Device;
use host_sim::presets;
use virtual_board::board::{Board, Pause};
use virtual_board::image::Image;
use virtual_board::wiring::Wires;

/// Exception numbers of the interrupts that the firmware serves.
pub const CONTROL: u16 = 16 + 44;

/// Longest wait for an answer, s of simulated time.
const PATIENCE_S: f64 = 2.0;
/// Simulated time between two polls of the terminal, s.
const LOOK_S: f64 = 1e-3;

/// The image of the default board. Returns `None` and prints a skip line if it was not built.
pub fn image(test: &str) -> Option<Image> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let path = root
        .join(target)
        .join("thumbv7em-none-eabihf/firmware/firmware");
    if !path.exists() {
        println!(
            "skipped: {test}: no image at {}; `cargo fw` builds it",
            path.display()
        );
        return None;
    }
    let image = Image::read(&path).unwrap();
    println!("image {} is {}", path.display(), image.hash());
    Some(image)
}

/// A board with its paddle and its terminal.
pub struct Bench {
    pub board: Board,
    pub image: Image,
    screen: String,
}

impl Bench {
    /// The refitted paddle on the board with `image`, with sensor noise.
    pub fn new(image: Image) -> Self {
        Self::with(image, &setup(presets::refit()), Wires::default())
    }

    /// The loop `setup` on the board with `image` and the given wiring.
    pub fn with(image: Image, setup: &LoopSetup, wires: Wires) -> Self {
        let mut bench = Self::fresh(image, setup, wires);
        bench.board.set_brown_out();
        bench
    }

    /// As [`Self::with`], with a chip in the state of delivery.
    pub fn fresh(image: Image, setup: &LoopSetup, wires: Wires) -> Self {
        Self {
            board: Board::new(&image, &setup.paddle, &setup.settings, wires).unwrap(),
            image,
            screen: String::new(),
        }
    }

    /// As [`Self::armed`], with torque on the paddle. Returns `None` and prints a skip line if the image was not built.
    pub fn pushing(test: &str) -> Option<Self> {
        let mut bench = Self::armed(image(test)?);
        bench.command("ref 30");
        bench.run(0.004);
        assert!(bench.drives());
        Some(bench)
    }

    /// As [`Self::new`], after boot, zeroing and arming.
    pub fn armed(image: Image) -> Self {
        let mut bench = Self::new(image);
        bench.boot();
        bench.command("zero hall");
        let answer = bench.command("arm");
        assert!(answer.contains("mode position"), "{answer}");
        bench
    }

    /// Runs the board for this simulated time.
    pub fn run(&mut self, seconds: f64) {
        let end_s = self.board.time_s() + seconds;
        while self.board.run_until(end_s).unwrap() != Pause::Time {}
    }

    /// Runs until the first prompt of the console and returns the text.
    pub fn boot(&mut self) -> String {
        self.wait_for("> ")
    }

    /// Types a line, waits for the next prompt, and returns the answer.
    pub fn command(&mut self, line: &str) -> String {
        self.board.type_in(&format!("{line}\r"));
        self.wait_for("\n> ")
    }

    /// Runs until the screen ends with `end`. Returns and clears the screen.
    pub fn wait_for(&mut self, end: &str) -> String {
        let deadline_s = self.board.time_s() + PATIENCE_S;
        loop {
            self.look();
            if self.screen.ends_with(end) {
                return std::mem::take(&mut self.screen);
            }
            assert!(
                self.board.time_s() < deadline_s,
                "no {end:?} within {PATIENCE_S} s, only {:?}",
                self.screen
            );
            self.run(LOOK_S);
        }
    }

    /// Changes the baud rate of the serial line on both ends to 1,843,200.
    pub fn speed_up(&mut self) {
        const FAST_BAUD: f64 = 1_843_200.0;
        let answer = self.command("baud 1843200");
        assert!(answer.contains("1843200"), "{answer}");
        self.run(0.001);
        self.board.terminal.baud = FAST_BAUD;
        let deviation = self.board.baud() / FAST_BAUD - 1.0;
        assert!(deviation.abs() < 0.01, "{deviation}");
        self.command("");
    }

    fn look(&mut self) {
        let answer = self.board.terminal.take_answer();
        self.screen.push_str(&String::from_utf8_lossy(&answer));
    }

    /// Whether the outputs of the bridge are enabled.
    pub fn drives(&self) -> bool {
        self.board.bridge_duty().is_some()
    }

    /// Address of the symbol whose mangled name contains all these parts.
    pub fn address_of(&self, parts: &[&str]) -> u32 {
        self.image
            .symbol(|name| parts.iter().all(|part| name.contains(part)))
            .unwrap_or_else(|| panic!("no symbol with {parts:?} in the image"))
            .address
    }
}

/// The firmware's loop with `device` and with sensor noise.
pub fn setup(device: Device) -> LoopSetup {
    LoopSetup::firmware(device, Settings::default(), presets::motor())
}

/// As [`setup`], with sensors that have quantization but no noise.
pub fn quiet(device: Device) -> LoopSetup {
    let mut setup = setup(device);
    setup.paddle.hall.noise_v = 0.0;
    setup.paddle.amplifier.noise_a = 0.0;
    setup
}
