//! The effects of the vocabulary, implemented independently from their description in the contract.

use std::f64::consts::TAU;

use crate::draw::Draw;
use crate::reality::{
    Bristle, Cogging, Contact, Coupling, Curve, Deadband, InputCurve, InputShape, Jump, Play,
    Profile, Push, Reality, Side, Slip, Stop, WarmUp,
};
use crate::truth::Place;

/// Every effect name of the contract.
pub const VOCABULARY: [&str; 31] = [
    "torque_gain",
    "torque_offset",
    "deadband",
    "saturation",
    "input_nonlinearity",
    "rate_limit",
    "lag",
    "delay",
    "cogging",
    "coulomb",
    "asymmetric_coulomb",
    "position_dependent_coulomb",
    "stribeck",
    "viscous",
    "quadratic_drag",
    "presliding",
    "load_dependent_friction",
    "friction_drift",
    "inertia",
    "gravity",
    "spring",
    "end_stop",
    "backlash",
    "compliance",
    "sensor_gain",
    "sensor_nonlinearity",
    "sensor_hysteresis",
    "sensor_lag",
    "lost_counts",
    "contact",
    "push",
];

/// Least and largest input limit that is stated too low, over the largest input.
pub(crate) const OVERSTATED_LIMITS: [f64; 2] = [0.4, 0.8];

/// Magnitudes of the device's motion before anything is hidden in it.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    pub middle: f64,
    /// Half the span of the position.
    pub half_span: f64,
    /// High quantile of the speed.
    pub speed: f64,
    /// High quantile of the input magnitude.
    pub input: f64,
    /// High quantile of the input torque, N m.
    pub torque: f64,
    /// Frequency of the motion, Hz.
    pub hz: f64,
    /// Start and end of each run, in the time of the session.
    pub runs_s: Vec<[f64; 2]>,
    /// Resolution of a quantised sensor, otherwise its noise.
    pub quantum: f64,
}

impl Scale {
    /// End of the session, s.
    pub fn session_s(&self) -> f64 {
        self.runs_s.last().map_or(0.0, |run| run[1])
    }
}

/// One effect: its name, its strength, and random choices of its form.
#[derive(Clone, Debug)]
pub(crate) struct Hidden {
    pub name: &'static str,
    pub strength: f64,
    pub range: [f64; 2],
    sign: f64,
    /// Uniform choices between 0 and 1. Their meaning depends on the effect.
    form: [f64; 6],
    variant: usize,
}

impl Hidden {
    /// Draws a form of the effect `name`, which must be one of [`VOCABULARY`].
    pub fn draw(draw: &mut Draw, name: &'static str) -> Self {
        let range = range(name);
        Self {
            name,
            strength: draw.log_uniform(range[0], range[1]),
            range,
            sign: draw.sign(),
            form: std::array::from_fn(|_| draw.uniform(0.0, 1.0)),
            variant: draw.count(0, 5),
        }
    }

    fn between(&self, k: usize, low: f64, high: f64) -> f64 {
        low + self.form[k] * (high - low)
    }

    fn log_between(&self, k: usize, low: f64, high: f64) -> f64 {
        self.between(k, low.ln(), high.ln()).exp()
    }

    /// A relative change by the strength, with random sign. It never reduces a value by more than 90 %.
    fn factor(&self) -> f64 {
        if self.sign > 0.0 {
            1.0 + self.strength
        } else {
            1.0 - self.strength.min(0.9)
        }
    }

    /// Returns true if the model overstates the effect: its lag or delay is too long, its limit is too low, or its stops are
    /// too narrow.
    pub fn is_overstated(&self) -> bool {
        let can_be = ["lag", "delay", "saturation", "end_stop"].contains(&self.name);
        can_be && self.variant == 5
    }

    /// Share of the limit of a saturation over which it is rounded.
    fn knee(&self) -> f64 {
        if self.variant < 4 {
            0.0
        } else {
            self.between(0, 0.1, 0.9)
        }
    }

    /// Selects one of two forms of the effect.
    fn first_form(&self) -> bool {
        self.variant.is_multiple_of(2)
    }

    /// Returns true if the lag consists of two lags in series.
    fn is_twice(&self) -> bool {
        self.variant == 4
    }

    /// Returns true if counts are lost above a speed instead of at one instant.
    fn slips(&self) -> bool {
        self.variant.is_multiple_of(3)
    }

    fn side(&self) -> Side {
        if self.form[5] < 0.5 {
            Side::Motor
        } else {
            Side::Load
        }
    }

    /// Adds the effect to `reality`.
    pub fn apply(&self, reality: &mut Reality, scale: &Scale) {
        let s = self.strength;
        let signed = self.sign * s;
        let Scale {
            middle,
            half_span,
            speed,
            torque,
            hz,
            ..
        } = *scale;
        let actuator = &mut reality.actuator;
        let friction = &mut reality.friction;
        let mechanics = &mut reality.mechanics;
        let sensing = &mut reality.sensing;
        match self.name {
            "torque_gain" => actuator.ratio *= self.factor(),
            "torque_offset" => actuator.offset += signed * torque,
            "deadband" => {
                let width = s * scale.input;
                let (below, above) = (width, width);
                actuator.deadband = Some(match self.variant {
                    0 | 2 => Deadband::Subtracted { below, above },
                    4 => Deadband::Subtracted {
                        below: width * self.between(0, 0.2, 0.8),
                        above,
                    },
                    _ => Deadband::Gated(width),
                });
            }
            "saturation" if self.is_overstated() => actuator.limit *= 1.0 + s,
            "saturation" => {
                actuator.limit = scale.input * (1.0 - s);
                actuator.knee = self.knee();
                if self.variant == 3 {
                    actuator.no_load = speed * self.log_between(0, 1.5, 6.0);
                }
            }
            "input_nonlinearity" => {
                actuator.curve = Some(InputCurve {
                    reference: scale.input,
                    shape: match self.variant {
                        0..=3 => InputShape::Power(self.factor()),
                        _ => InputShape::Bent(signed),
                    },
                });
            }
            // A full sine just reaches the rate limit at a strength of 0.35.
            "rate_limit" => actuator.slew = scale.input * TAU * hz * 0.35 / s,
            "lag" if self.is_overstated() => {
                actuator.lag_s = (actuator.lag_s - s / (TAU * hz)).max(0.0);
            }
            "delay" if self.is_overstated() => {
                actuator.delay_s = (actuator.delay_s - s / (TAU * hz)).max(0.0);
            }
            "lag" if self.is_twice() => {
                actuator.lag_s += 0.5 * s / (TAU * hz);
                actuator.further_lag_s = 0.5 * s / (TAU * hz);
            }
            "lag" if self.first_form() => actuator.lag_s += s / (TAU * hz),
            "lag" => actuator.further_lag_s = s / (TAU * hz),
            "delay" => actuator.delay_s += s / (TAU * hz),
            "cogging" => {
                let periods = self.log_between(0, 1.5, 9.0);
                actuator.cogging = Some(Cogging {
                    first: s * torque,
                    second: if self.variant < 4 {
                        0.0
                    } else {
                        s * torque * self.between(1, 0.2, 0.5)
                    },
                    wave_number: TAU * periods / (2.0 * half_span),
                    phase_rad: self.between(2, 0.0, TAU),
                    further: if matches!(self.variant, 2 | 3) {
                        let part = |k, order| (s * torque * self.between(k, 0.3, 0.8), order);
                        [part(3, 1.7), part(4, 3.1)]
                    } else {
                        [(0.0, 0.0); 2]
                    },
                });
            }
            "coulomb" => {
                let level = if friction.forward > 0.0 {
                    friction.forward * self.factor()
                } else {
                    s * torque
                };
                friction.forward = level;
                friction.backward = level;
            }
            "asymmetric_coulomb" => {
                let factor = self.factor();
                if self.first_form() {
                    friction.forward *= factor
                } else {
                    friction.backward *= factor
                }
            }
            "position_dependent_coulomb" => {
                friction.profile = Some(match self.variant {
                    0 | 3 => Profile::Linear {
                        amount: self.sign * s.min(0.95),
                        at: middle,
                        scale: half_span,
                    },
                    1 => Profile::Quadratic {
                        amount: s * 1.5,
                        at: middle,
                        scale: half_span,
                    },
                    2 => Profile::Spot {
                        amount: 1.5 * s,
                        at: middle + self.between(0, -0.6, 0.6) * half_span,
                        scale: self.between(1, 0.2, 0.6) * half_span,
                    },
                    _ => Profile::Wave {
                        amount: s.min(0.95),
                        at: middle + self.between(0, -1.0, 1.0) * half_span,
                        scale: half_span / self.between(1, 1.5, 5.0),
                    },
                });
            }
            "stribeck" => {
                friction.static_ratio = 1.0 + s;
                friction.stribeck_velocity = speed * self.log_between(0, 0.02, 0.2);
                friction.stribeck_power = 1 + (self.variant % 2) as i32;
            }
            "viscous" => friction.viscous += s * torque / speed,
            "quadratic_drag" => friction.quadratic += s * torque / (speed * speed),
            "presliding" => {
                let stiffness = friction.forward / (s * half_span);
                let critical = 2.0 * (stiffness * mechanics.inertia).sqrt();
                friction.bristle = Some(Bristle {
                    stiffness,
                    damping: critical * self.between(0, 0.05, 0.3),
                    elastic_share: if self.first_form() {
                        0.0
                    } else {
                        self.between(1, 0.3, 0.8)
                    },
                });
            }
            "load_dependent_friction" => {
                friction.load_share = s;
                friction.carries_all = !self.first_form();
                if self.variant >= 4 {
                    friction.backdriven = self.log_between(0, 1.5, 5.0);
                }
            }
            "friction_drift" => {
                let amount = if self.sign > 0.0 { s } else { -s.min(0.85) };
                let session_s = scale.session_s();
                let time_constant_s = session_s * self.between(0, 0.2, 0.5);
                friction.warm_up = Some(match self.variant % 4 {
                    0 => WarmUp::Linear {
                        amount,
                        over_s: session_s,
                    },
                    1 => WarmUp::Exponential {
                        amount: amount * 1.1,
                        time_constant_s,
                    },
                    2 => WarmUp::FromCold {
                        amount,
                        time_constant_s,
                    },
                    _ => WarmUp::Step {
                        amount,
                        at_s: session_s * self.between(1, 0.2, 0.8),
                        within_s: self.log_between(2, 0.01, 0.3),
                    },
                });
            }
            "inertia" => mechanics.inertia *= self.factor(),
            "gravity" => {
                if mechanics.gravity == 0.0 {
                    mechanics.gravity = s * torque;
                } else {
                    mechanics.gravity *= self.factor();
                }
            }
            "spring" => {
                mechanics.stiffness += s * torque / half_span;
                mechanics.stiffness_zero = middle + self.between(0, -0.3, 0.3) * half_span;
                let hardens = match self.variant {
                    0 | 2 | 4 => 0.0,
                    1 | 3 => self.between(1, 0.1, 0.4),
                    _ => self.log_between(1, 1.0, 6.0),
                };
                mechanics.hardening = hardens / (half_span * half_span);
            }
            "end_stop" if self.is_overstated() => {
                for stop in &mut mechanics.stops {
                    stop.at += stop.side * s * half_span;
                }
            }
            "end_stop" => {
                let stiffness = torque / (half_span * self.log_between(0, 0.004, 0.04));
                let critical = 2.0 * (stiffness * mechanics.inertia).sqrt();
                mechanics.stops.push(Stop {
                    at: self.stop_at(scale),
                    side: self.sign,
                    stiffness,
                    damping: critical * self.between(1, 0.05, 0.5),
                });
            }
            "backlash" => {
                let flank_hz = hz * self.log_between(0, 80.0, 160.0);
                mechanics.coupling =
                    Some(self.coupling(mechanics.inertia, s * half_span, flank_hz));
            }
            "compliance" => {
                mechanics.coupling = Some(self.coupling(mechanics.inertia, 0.0, hz / s));
            }
            "sensor_gain" => {
                sensing.gain_error = signed.max(-0.6);
                // Half of them read right at zero, as many somewhere on their way.
                if !self.first_form() {
                    sensing.right_at = middle + half_span * self.between(0, -1.0, 1.0);
                }
            }
            "sensor_nonlinearity" => {
                let (amount, at, scale) = (signed, middle, half_span);
                sensing.curve = Some(match self.variant % 3 {
                    0 => Curve::Quadratic {
                        amount: amount.clamp(-0.4, 0.4),
                        at,
                        scale,
                    },
                    1 => Curve::Cubic {
                        amount: amount.clamp(-0.28, 0.5),
                        at,
                        scale,
                    },
                    _ => Curve::Wave {
                        amount: amount.clamp(-0.8, 0.8),
                        at,
                        scale: half_span / self.between(0, 1.5, 4.0),
                    },
                });
            }
            "sensor_hysteresis" => {
                let soft = self.variant.is_multiple_of(3);
                sensing.play = Some(Play {
                    half_width: s * half_span,
                    softness: soft.then(|| self.between(0, 1.0, 3.0)),
                });
            }
            "sensor_lag" if self.is_twice() => {
                sensing.lag_s = 0.5 * s / (TAU * hz);
                sensing.further_lag_s = 0.5 * s / (TAU * hz);
            }
            "sensor_lag" => sensing.lag_s = s / (TAU * hz),
            "lost_counts" if self.slips() => {
                sensing.slip = Some(Slip {
                    above: scale.speed * self.between(0, 0.2, 0.7),
                    share: s.min(0.7),
                });
            }
            "lost_counts" => {
                let quantum = scale.quantum.max(1e-4 * half_span);
                let by = (s * half_span / quantum).round().max(1.0) * quantum;
                sensing.jumps = (0..=self.variant / 2)
                    .map(|k| {
                        let run = (self.form[k] * scale.runs_s.len() as f64) as usize;
                        let run = run.min(scale.runs_s.len() - 1);
                        let [from, to] = scale.runs_s[run];
                        let since_s = from + (to - from) * self.between(k + 3, 0.1, 0.9);
                        Jump {
                            run,
                            since_s,
                            by: if (self.variant + k).is_multiple_of(2) {
                                by
                            } else {
                                -by
                            },
                        }
                    })
                    .collect();
            }
            "contact" => {
                let (run, from_s, to_s) = self.contact_time(scale);
                let stiffness = s * 8.0 * torque / half_span;
                let critical = 2.0 * (stiffness * mechanics.inertia).sqrt();
                let side = self.sign;
                reality.contact = Some(Contact {
                    run,
                    from_s,
                    to_s,
                    body: Stop {
                        at: middle + side * self.between(2, -0.3, 0.5) * half_span,
                        side,
                        stiffness,
                        damping: critical * self.between(3, 0.05, 0.8),
                    },
                    grips: self.variant < 2,
                });
            }
            "push" => {
                let times = self.push_times(scale).into_iter().zip([1.0, -0.8]);
                let pushes = times.map(|((run, from_s, to_s), part)| Push {
                    run,
                    from_s,
                    to_s,
                    torque: part * signed * torque,
                });
                reality.pushes = pushes.collect();
            }
            _ => {}
        }
    }

    fn stop_at(&self, scale: &Scale) -> f64 {
        scale.middle + self.sign * scale.half_span * (1.0 - self.strength)
    }

    fn contact_time(&self, scale: &Scale) -> (usize, f64, f64) {
        let run = ((self.form[0] * scale.runs_s.len() as f64) as usize).min(scale.runs_s.len() - 1);
        let [from, to] = scale.runs_s[run];
        let length_s = self
            .between(4, 0.5, 1.6)
            .max(0.6 / scale.hz)
            .min(0.5 * (to - from));
        let from_s = from + self.between(1, 0.05, 0.95) * (to - from - length_s);
        (run, from_s, from_s + length_s)
    }

    /// Run, start and end of each push. There are one or two.
    fn push_times(&self, scale: &Scale) -> Vec<(usize, f64, f64)> {
        let count = if self.variant < 4 { 1 } else { 2 };
        let time = |k: usize| {
            let runs = scale.runs_s.len();
            let run = ((self.form[k] * runs as f64) as usize).min(runs - 1);
            let [from, to] = scale.runs_s[run];
            let length_s = self.between(2 + k, 0.08, 0.4).min(0.2 * (to - from));
            let room_s = to - from - length_s;
            let from_s = from + self.between(4 + k, 0.05, 0.95) * room_s;
            (run, from_s, from_s + length_s)
        };
        (0..count).map(time).collect()
    }

    fn coupling(&self, inertia: f64, half_gap: f64, resonance_hz: f64) -> Coupling {
        let motor_share = self.between(1, 0.25, 0.75);
        let reduced = inertia * motor_share * (1.0 - motor_share);
        let stiffness = reduced * (TAU * resonance_hz).powi(2);
        let damping_ratio = if half_gap > 0.0 {
            self.between(2, 0.1, 0.4)
        } else {
            self.log_between(2, 0.01, 0.08)
        };
        Coupling {
            half_gap,
            stiffness,
            damping: 2.0 * damping_ratio * (stiffness * reduced).sqrt(),
            motor_share,
            motor_friction: self.between(3, 0.2, 0.8),
            sensor: self.side(),
        }
    }

    /// Numbers of the nominal model that the effect changes.
    pub fn touches(&self) -> &'static [&'static str] {
        match self.name {
            "torque_gain" => &["ratio", "inertia"],
            "inertia" => &["inertia"],
            "saturation" => &["input_limit"],
            "lag" => &["lag"],
            "delay" => &["delay"],
            "coulomb"
            | "asymmetric_coulomb"
            | "friction_drift"
            | "stribeck"
            | "position_dependent_coulomb" => &["coulomb"],
            "viscous" | "quadratic_drag" => &["viscous"],
            "gravity" => &["gravity"],
            "spring" => &["stiffness"],
            _ => &[],
        }
    }

    /// Where the effect acts. A diagnosis that names one of these places is right.
    pub fn places(&self, scale: &Scale) -> Vec<Place> {
        let Scale {
            middle,
            half_span: h,
            speed: v,
            input: u,
            ..
        } = *scale;
        let s = self.strength;
        let near_rest = Place::on("velocity", -0.25 * v, 0.25 * v);
        let accelerating = {
            let a = v * TAU * scale.hz;
            [
                Place::on("acceleration", 0.3 * a, 100.0 * a),
                Place::on("acceleration", -100.0 * a, -0.3 * a),
            ]
        };
        let everywhere = Place::on("position", middle - 2.0 * h, middle + 2.0 * h);
        let driven = [
            Place::on("input", 0.3 * u, 100.0 * u),
            Place::on("input", -100.0 * u, -0.3 * u),
        ];
        let fast = [
            Place::on("velocity", 0.3 * v, 100.0 * v),
            Place::on("velocity", -100.0 * v, -0.3 * v),
        ];
        // The phase error of a lag grows with the frequency.
        let phase = Place::on("frequency", 0.5 * scale.hz, 1e3 * scale.hz);
        let axis = |name: &str| Place::channel(name);
        match self.name {
            "torque_gain" => [&driven[..], &accelerating, &[axis("actuation")]].concat(),
            "torque_offset" => vec![
                Place::on("input", -100.0 * u, 100.0 * u),
                everywhere,
                axis("actuation"),
            ],
            "deadband" => {
                // A subtracted dead band reduces every larger input, too.
                let reach = if self.first_form() { 100.0 } else { 1.5 * s };
                vec![Place::on("input", -reach * u, reach * u), axis("actuation")]
            }
            "saturation" => {
                let linear = match self.is_overstated() {
                    true => OVERSTATED_LIMITS[0] * u,
                    false => (1.0 - s) * (1.0 - self.knee()) * u,
                };
                vec![
                    Place::on("input", linear, 100.0 * u),
                    Place::on("input", -100.0 * u, -linear),
                    axis("actuation"),
                ]
            }
            "input_nonlinearity" => {
                vec![Place::on("input", -100.0 * u, 100.0 * u), axis("actuation")]
            }
            "rate_limit" | "lag" | "delay" => {
                [&driven[..], &accelerating, &[phase, axis("actuation")]].concat()
            }
            "cogging" => vec![everywhere, axis("actuation")],
            "coulomb" => [&fast[..], &[near_rest, axis("friction")]].concat(),
            "asymmetric_coulomb" => {
                let positive = self.first_form();
                let place = if positive {
                    Place::on("velocity", 0.0, 100.0 * v)
                } else {
                    Place::on("velocity", -100.0 * v, 0.0)
                };
                vec![place, axis("friction")]
            }
            "position_dependent_coulomb" => vec![everywhere, axis("friction")],
            "stribeck" | "presliding" => vec![near_rest, axis("friction")],
            "viscous" | "quadratic_drag" => [&fast[..], &[axis("friction")]].concat(),
            "load_dependent_friction" => [&driven[..], &fast, &[axis("friction")]].concat(),
            "friction_drift" => {
                let whole = scale.session_s();
                let mut places = vec![Place::on("time", 0.0, whole), axis("friction")];
                places.extend((0..scale.runs_s.len()).map(Place::whole_run));
                places
            }
            "inertia" => [&accelerating[..], &driven, &[axis("mechanics")]].concat(),
            "gravity" | "spring" => vec![
                Place::on("position", middle + 0.3 * h, middle + 100.0 * h),
                Place::on("position", middle - 100.0 * h, middle - 0.3 * h),
                axis("mechanics"),
            ],
            "end_stop" if self.is_overstated() => vec![
                Place::on("position", middle + 0.4 * h, middle + 100.0 * h),
                Place::on("position", middle - 100.0 * h, middle - 0.4 * h),
            ],
            "end_stop" => {
                let at = self.stop_at(scale);
                let beyond = if self.sign > 0.0 {
                    Place::on("position", at, at + 2.0 * h)
                } else {
                    Place::on("position", at - 2.0 * h, at)
                };
                vec![beyond]
            }
            "backlash" => vec![
                near_rest,
                Place::on("input", -0.4 * u, 0.4 * u),
                axis("mechanics"),
            ],
            "compliance" => vec![
                Place::on("frequency", 0.3 * scale.hz / s, 3.0 * scale.hz / s),
                axis("mechanics"),
            ]
            .into_iter()
            .chain(accelerating)
            .collect(),
            "sensor_gain" | "sensor_nonlinearity" => {
                [&[everywhere, axis("sensing")], &fast[..]].concat()
            }
            "sensor_hysteresis" => vec![near_rest, axis("sensing")],
            "sensor_lag" => [&fast[..], &accelerating, &[phase, axis("sensing")]].concat(),
            "lost_counts" if self.slips() => [&fast[..], &[axis("sensing")]].concat(),
            "lost_counts" => {
                let mut probe = Reality::plain(&recording::Model::new(1.0));
                self.apply(&mut probe, scale);
                let jumps = probe.sensing.jumps.iter();
                let moments = jumps
                    .map(|jump| Place::in_run(jump.run, jump.since_s - 0.1, jump.since_s + 1.0));
                moments.chain([axis("sensing")]).collect()
            }
            "contact" => {
                let (run, from_s, to_s) = self.contact_time(scale);
                vec![Place::in_run(run, from_s, to_s)]
            }
            "push" => {
                let times = self.push_times(scale).into_iter();
                times
                    .map(|(run, from_s, to_s)| Place::in_run(run, from_s, to_s + 0.3))
                    .collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Least and largest strength of the effect, in its own measure.
fn range(name: &str) -> [f64; 2] {
    match name {
        "torque_gain" | "inertia" | "sensor_gain" => [0.06, 0.7],
        "torque_offset" => [0.02, 0.5],
        "deadband" => [0.03, 0.5],
        "saturation" => [0.1, 0.7],
        "input_nonlinearity" => [0.1, 0.7],
        "rate_limit" => [0.05, 1.0],
        "push" => [0.1, 2.0],
        "lag" | "delay" | "sensor_lag" => [0.02, 0.6],
        "cogging" => [0.03, 0.6],
        "coulomb" | "asymmetric_coulomb" => [0.15, 2.0],
        "position_dependent_coulomb" | "friction_drift" => [0.25, 2.5],
        "stribeck" => [0.15, 2.0],
        "viscous" | "quadratic_drag" => [0.04, 1.0],
        "presliding" => [0.004, 0.2],
        "load_dependent_friction" => [0.04, 0.5],
        "gravity" | "spring" => [0.08, 1.0],
        "end_stop" => [0.05, 0.6],
        "backlash" | "sensor_hysteresis" => [0.004, 0.15],
        "compliance" => [0.03, 0.6],
        "sensor_nonlinearity" => [0.03, 0.5],
        "lost_counts" => [0.03, 0.8],
        _ => [0.05, 3.0],
    }
}
