//! Evaluates gains on all paddles of a parameter range, against a specification.

use super::core_response::CoreResponse;
use super::gains::Gains;
use super::margins::Margins;
use super::plant_response;
use super::specification::{Specification, rest_error_deg};
use super::spread::Variant;
use super::trial::{self, Trial};
use crate::failure::Failure;
use host_sim::closed_loop::LoopSetup;
use host_sim::device::Device;
use num_complex::Complex64;

/// The paddles and the specification for the evaluation of gains.
#[derive(Clone, Debug)]
pub struct Bench {
    specification: Specification,
    step_deg: f64,
    core: CoreResponse,
    cases: Vec<BenchCase>,
}

#[derive(Clone, Debug)]
struct BenchCase {
    variant: Variant,
    setup: LoopSetup,
    /// Frequency response of the plant at the frequencies of the core's response.
    plant: Vec<Complex64>,
    /// Largest torque that can hold the paddle away from the target at rest, N m.
    held_nm: f64,
}

/// Result of one paddle with given gains.
#[derive(Clone, Debug)]
pub struct Case {
    /// Parameters of the paddle.
    pub variant: Variant,
    /// Its step response.
    pub trial: Trial,
    /// Stability margins. `None` if the loop gain is never 1.
    pub margins: Option<Margins>,
    /// Largest position error at which dry friction and weight can hold the paddle at the end of the settling time, degrees.
    pub rest_error_deg: f64,
    /// Utilization of the tightest bound; above 1 the bound is exceeded.
    pub load: f64,
}

/// Duration of a simulated step, in settling times.
const WATCHED: f64 = 3.0;
/// Utilization above which the remaining paddles are not simulated.
const HOPELESS: f64 = 1.5;
/// Utilization that gains may reach on every bound.
const RESERVE: f64 = 0.9;
/// Cost offset of gains that exceed this utilization. It is larger than every noise gain.
const TOO_MUCH: f64 = 1e6;

impl Bench {
    /// Creates steps of `step_deg` on `variants` of `setup`. The first variant is the known paddle.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses.
    pub fn new(
        setup: &LoopSetup,
        specification: Specification,
        step_deg: f64,
        variants: &[Variant],
    ) -> Result<Self, Failure> {
        let core = CoreResponse::measure(setup)?;
        let cases = variants.iter().map(|&variant| {
            let mut setup = setup.clone();
            variant.apply(&mut setup.paddle.device);
            let omega = core.omega_rad_s.iter();
            let at_rad = step_deg.to_radians();
            BenchCase {
                variant,
                plant: omega
                    .map(|&omega| plant_response::response(&setup, at_rad, omega))
                    .collect(),
                held_nm: held_nm(&setup.paddle.device, at_rad),
                setup,
            }
        });
        Ok(Self {
            specification,
            step_deg,
            cases: cases.collect(),
            core,
        })
    }

    fn margins(&self, case: &BenchCase, gains: &Gains) -> Option<Margins> {
        // The core answers a positive position with a negative torque, so the open loop has a minus sign.
        let open = self.core.of(gains).zip(&case.plant).map(|(c, p)| -c * p);
        Margins::of(&self.core.omega_rad_s, open)
    }

    fn case(&self, case: &BenchCase, gains: &Gains) -> Result<Case, Failure> {
        let specification = &self.specification;
        let watched_s = WATCHED * specification.settling_s;
        let trial = trial::step(&case.setup, gains, self.step_deg, watched_s)?;
        let stopped = trial.trace.fault.map_or(0.0, |_| HOPELESS);
        let step = specification.load_of_step(&trial.metrics, self.step_deg.to_radians());
        Ok(Case {
            variant: case.variant,
            margins: self.margins(case, gains),
            rest_error_deg: rest_error_deg(case.held_nm, gains, specification.settling_s),
            load: step.max(stopped).max(self.load_at_sight(case, gains)),
            trial,
        })
    }

    /// Utilization of the bounds that can be computed without a simulation.
    fn load_at_sight(&self, case: &BenchCase, gains: &Gains) -> f64 {
        let margins = self.margins(case, gains);
        let specification = &self.specification;
        let rest = specification.load_of_rest(case.held_nm, gains);
        rest.max(specification.load_of_margins(margins.as_ref()))
    }

    /// Simulates all paddles with `gains`, the known paddle first.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses.
    pub fn cases(&self, gains: &Gains) -> Result<Vec<Case>, Failure> {
        let cases = self.cases.iter().map(|case| self.case(case, gains));
        cases.collect()
    }

    /// The cost of gains. If all paddles use at most 90 % of every bound, the cost is the noise gain. Otherwise it is larger
    /// and increases with the utilization of the worst paddle.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses.
    pub fn cost(&self, gains: &Gains) -> Result<f64, Failure> {
        if gains
            .put(&mut self.cases[0].setup.settings.clone())
            .is_err()
        {
            return Ok(f64::INFINITY);
        }
        let at_sight = self
            .cases
            .iter()
            .map(|case| self.load_at_sight(case, gains));
        let mut load = at_sight.fold(0.0, f64::max);
        for case in &self.cases {
            if load > HOPELESS {
                break;
            }
            load = load.max(self.case(case, gains)?.load);
        }
        Ok(match load <= RESERVE {
            true => self.core.noise_gain(gains),
            false => TOO_MUCH * (1.0 + load),
        })
    }
}

/// Whether all paddles are within all bounds.
pub fn met(cases: &[Case]) -> bool {
    cases.iter().all(|case| case.load <= 1.0)
}

/// Largest torque with which dry friction, weight, spring and a constant torque can hold the paddle at an angle, N m.
fn held_nm(device: &Device, at_rad: f64) -> f64 {
    let m = &device.mechanics;
    let friction = [1.0, -1.0].map(|direction| m.friction.holding(direction, at_rad, 0.0, 0.0));
    let pull_nm = m.offset_nm
        - m.gravity * (at_rad - m.gravity_zero).sin()
        - m.stiffness * (at_rad - m.stiffness_zero);
    friction[0].max(friction[1]) + pull_nm.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_paddle::settings::Settings;
    use host_sim::effects::Effect;
    use host_sim::presets;

    const GAINS: Gains = Gains {
        kp: 0.05,
        ki: 0.28,
        kd: 0.0008,
    };

    /// A linear loop without dry friction. The encoder is so fine that its quantization does not excite the loop.
    fn linear() -> LoopSetup {
        let mut settings = Settings::default();
        settings.mechanism.counts_per_turn = 2e5;
        let mut setup = LoopSetup::ideal(presets::refit(), settings);
        let frictionless: Effect = "coulomb:level=0".parse().unwrap();
        frictionless.install(&mut setup.paddle.device);
        setup
    }

    fn margins(setup: &LoopSetup) -> Margins {
        let specification = Specification {
            overshoot_share: 1.0,
            rise_s: 1.0,
            settling_s: 1.0,
            band_deg: 0.2,
            gain_margin_db: 1.0,
            phase_margin_deg: 1.0,
        };
        let bench = Bench::new(setup, specification, 1.0, &Variant::of(0.0, 0.0)).unwrap();
        bench.cases(&GAINS).unwrap()[0].margins.unwrap()
    }

    /// Whether a small step still oscillates after 3 s, judged by the torque.
    fn oscillates(setup: &LoopSetup) -> bool {
        let trial = trial::step(setup, &GAINS, 0.1, 3.0).unwrap();
        let torque_nm = trial.trace.input_nm;
        let end = &torque_nm[torque_nm.len() - 300..];
        let range = |of: &[f64]| {
            let highest = of.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            highest - of.iter().copied().fold(f64::INFINITY, f64::min)
        };
        range(end) > 0.5 * range(&torque_nm)
    }

    #[test]
    fn the_loop_oscillates_when_its_gain_margin_is_used_up() {
        let margins = margins(&linear());
        let with = |db: f64| {
            let mut setup = linear();
            setup.paddle.device.drive.ratio *= 10f64.powf((margins.gain_db + db) / 20.0);
            oscillates(&setup)
        };
        assert!(with(0.5) && !with(-0.5));
    }

    #[test]
    fn the_loop_oscillates_when_a_delay_uses_up_its_phase_margin() {
        let margins = margins(&linear());
        let with = |share: f64| {
            let mut setup = linear();
            let delay_s = margins.phase_deg / 360.0 / margins.crossover_hz;
            setup.paddle.device.drive.delay_s = share * delay_s;
            oscillates(&setup)
        };
        assert!(with(1.05) && !with(0.95));
    }
}
