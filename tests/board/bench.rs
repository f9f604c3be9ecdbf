//! A lab bench: the board with the paddle on it, and somebody at the terminal.

use std::path::{Path, PathBuf};

use haptic_paddle::settings::Settings;
use host_sim::closed_loop::LoopSetup;
use host_sim::device::Device;
use host_sim::presets;
use virtual_board::board::{Board, Pause};
use virtual_board::image::Image;
use virtual_board::wiring::Wires;

/// Exception numbers of the served interrupts.
pub const CONTROL: u16 = 16 + 44;

/// Longest wait for an answer, s of virtual time.
const PATIENCE_S: f64 = 2.0;
/// How long the board runs between two looks at the terminal, s.
const LOOK_S: f64 = 1e-3;

/// The image of the default board; `None`, with a line that says so, if it was not built.
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

/// The bench.
pub struct Bench {
    pub board: Board,
    pub image: Image,
    screen: String,
}

impl Bench {
    /// The refitted paddle on the board of `image`, with the sensors' noise.
    pub fn new(image: Image) -> Self {
        Self::with(image, &setup(presets::refit()), Wires::default())
    }

    /// `setup` on the board of `image`, wired like this.
    pub fn with(image: Image, setup: &LoopSetup, wires: Wires) -> Self {
        let mut bench = Self::fresh(image, setup, wires);
        bench.board.set_brown_out();
        bench
    }

    /// As [`Self::with`], with a chip as it was delivered.
    pub fn fresh(image: Image, setup: &LoopSetup, wires: Wires) -> Self {
        Self {
            board: Board::new(&image, &setup.paddle, &setup.settings, wires).unwrap(),
            image,
            screen: String::new(),
        }
    }

    /// As [`Self::armed`], pushing the paddle; `None`, with a line that says so, if the image was not built.
    pub fn pushing(test: &str) -> Option<Self> {
        let mut bench = Self::armed(image(test)?);
        bench.command("ref 30");
        bench.run(0.004);
        assert!(bench.drives());
        Some(bench)
    }

    /// As [`Self::new`], booted, zeroed and armed.
    pub fn armed(image: Image) -> Self {
        let mut bench = Self::new(image);
        bench.boot();
        bench.command("zero hall");
        let answer = bench.command("arm");
        assert!(answer.contains("mode position"), "{answer}");
        bench
    }

    /// Lets it run for so long.
    pub fn run(&mut self, seconds: f64) {
        let end_s = self.board.time_s() + seconds;
        while self.board.run_until(end_s).unwrap() != Pause::Time {}
    }

    /// Runs until the console has given its first prompt; what it said.
    pub fn boot(&mut self) -> String {
        self.wait_for("> ")
    }

    /// Types a line and waits for the next prompt; what came back.
    pub fn command(&mut self, line: &str) -> String {
        self.board.type_in(&format!("{line}\r"));
        self.wait_for("\n> ")
    }

    /// Runs until the screen ends with `end`, and clears it.
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

    /// Changes the rate of the serial line on both ends to 1,843,200 baud.
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

    /// Whether the bridge's outputs are on.
    pub fn drives(&self) -> bool {
        self.board.bridge_duty().is_some()
    }

    /// Address of the symbol whose mangled name has all these parts.
    pub fn address_of(&self, parts: &[&str]) -> u32 {
        self.image
            .symbol(|name| parts.iter().all(|part| name.contains(part)))
            .unwrap_or_else(|| panic!("no symbol with {parts:?} in the image"))
            .address
    }
}

/// The firmware's loop around `device`, with the sensors' noise.
pub fn setup(device: Device) -> LoopSetup {
    LoopSetup::firmware(device, Settings::default(), presets::motor())
}

/// As [`setup`], with sensors that quantise but have no noise.
pub fn quiet(device: Device) -> LoopSetup {
    let mut setup = setup(device);
    setup.paddle.hall.noise_v = 0.0;
    setup.paddle.amplifier.noise_a = 0.0;
    setup
}
