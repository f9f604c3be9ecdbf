//! A nonlinear characteristic of the position sensor.

use super::WAVE_NUMBER;
use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};
use crate::ripple::Ripple;

/// `y = x + a (x − m)² + b (x − m)³ + r sin(n x) + s (cos(n x) − 1) + o`.
pub const KIND: Kind = Kind {
    name: "sensor_nonlinearity",
    channel: Channel::Sensing,
    about: "The characteristic of the sensor is nonlinear",
    equation: "y = x + a (x − m)² + b (x − m)³ + r sin(n x) + s (cos(n x) − 1) + o",
    sizes_from: "The sizes are assumptions: at the end of the paddle's travel, 0.61 rad, the square shifts the reading by up to 0.19 rad and the cube by up to 0.45 rad.",
    parameters: &[
        Parameter {
            name: "quadratic",
            quantity: Quantity::PerPosition,
            range: ANY,
            default: 0.2,
            typical: [-0.5, 0.5],
            about: "quadratic part of the curve",
        },
        Parameter {
            name: "cubic",
            quantity: Quantity::PerPositionSquared,
            range: ANY,
            default: 0.0,
            typical: [-2.0, 2.0],
            about: "cubic part of the curve",
        },
        Parameter {
            name: "ripple_sine",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "sine part of a ripple of the curve",
        },
        Parameter {
            name: "ripple_cosine",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "cosine part of the ripple",
        },
        WAVE_NUMBER,
        Parameter {
            name: "offset",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "offset of the reading at zero",
        },
        Parameter {
            name: "middle",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.3, 0.3],
            about: "m, position around which the curve deviates from a straight line",
        },
    ],
    install: |device, p| {
        let [a, b, m] = [p[0], p[1], p[6]];
        device.sensing.gain += m * (3.0 * b * m - 2.0 * a);
        device.sensing.quadratic = a - 3.0 * b * m;
        device.sensing.cubic = b;
        device.sensing.ripple = Ripple {
            sine: p[2],
            cosine: p[3],
            wave_number: p[4],
        };
        device.sensing.offset += p[5] + m * m * (a - b * m);
    },
    ..PLAIN
};

#[cfg(test)]
mod tests {
    use super::KIND;
    use crate::device::Device;
    use recording::Model;

    #[test]
    fn is_bent_around_its_middle() {
        let [a, b, m, o] = [0.3, -0.8, 0.2, 0.01];
        let mut device = Device::nominal(&Model::new(1.0));
        KIND.install(&mut device, &[a, b, 0.0, 0.0, 6.0, o, m]);
        for x in [-0.4, 0.0, 0.2, 0.5] {
            let bent = x + a * (x - m).powi(2) + b * (x - m).powi(3) + o;
            assert!((device.sensing.curve(x) - bent) < 1e-12, "{x}");
        }
    }
}
