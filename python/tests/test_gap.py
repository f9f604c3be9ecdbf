"""From arrays to a verdict: `pip install ./python && python -m unittest discover python/tests`."""

import json
import math
import unittest

import numpy as np

from paddle_gap import Recording, diagnose, measure

INERTIA, DRY = 5.8e-4, 4e-3


def motion(seconds=6.0, period=1e-3):
    """A paddle with dry friction under two sines, by small steps."""
    time = np.arange(0.0, seconds, period)
    told = 0.02 * np.sin(9.0 * time) + 0.015 * np.sin(23.0 * time)
    x = v = 0.0
    positions = []
    for u in told:
        positions.append(x)
        for _ in range(10):
            free = v + (u - 2e-4 * v) / INERTIA * period / 10
            slowed = DRY / INERTIA * period / 10
            v = 0.0 if abs(free) <= slowed else free - math.copysign(slowed, free)
            x += v * period / 10
    noise = np.random.default_rng(1).normal(0.0, 1e-4, len(time))
    return time, told, np.array(positions) + noise


class FromArrays(unittest.TestCase):
    def test_a_friction_that_the_model_lacks_is_named(self):
        time, told, position = motion()
        model = {"inertia": INERTIA, "viscous": 2e-4, "coulomb": 0.0, "gravity": 0.0, "ratio": 1.0}
        recording = Recording.from_arrays(time, told, position, model=model, noise=1e-4, horizon=0.3)
        diagnosis = diagnose(recording)
        self.assertEqual([effect["name"] for effect in diagnosis["effects"]][:1], ["coulomb"], repr(diagnosis))
        self.assertLess(diagnosis["gap"]["after"], 0.3 * diagnosis["gap"]["before"])
        corrected = measure(recording, model=diagnosis.model)
        self.assertLess(corrected["before"], measure(recording)["before"])
        self.assertIn("<table>", diagnosis._repr_html_())
        json.dumps(diagnosis)

    def test_what_cannot_be_used_is_a_value_error(self):
        time, told, position = motion(1.0)
        with self.assertRaisesRegex(ValueError, "inertia"):
            Recording.from_arrays(time, told, position, model={})
        with self.assertRaisesRegex(ValueError, "no number"):
            Recording.from_arrays(time, told, position, model={"inertia": 1.0, "inertai": 1.0})
        with self.assertRaisesRegex(ValueError, "length"):
            Recording.from_arrays(time, told[:-1], position, model={"inertia": 1.0})


if __name__ == "__main__":
    unittest.main()
