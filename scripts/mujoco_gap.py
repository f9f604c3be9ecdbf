#!/usr/bin/env python3
"""The gap of an exported model on a recording, run in MuJoCo.

    paddle gap export corrected.toml mjcf --out paddle.xml
    python3 scripts/mujoco_gap.py my-recording paddle.xml [--nominal nominal.xml] [--write]

The rule is that of the recording format: the model predicts the position from the input, started anew from the measured
state every horizon; the state is value and slope of a cubic that is fitted to the samples within restart_half_width. What
the reading does not show (a lag, play, a twist) is carried on. --write puts the result into the head of the XML file.

Needs MuJoCo and numpy (pip install mujoco); ends with status 77 and a line `skipped: ...` where they are not there.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import sys

try:
    import mujoco
    import numpy as np
    import tomllib
except ImportError as missing:
    print(f"skipped: mujoco_gap: {missing}")
    sys.exit(77)

SUBSTEP_S = 1e-4
"""Longest step of the simulation, s."""


def restart(time, position, at, half_width):
    """Value and slope at the time `at` of a cubic fitted to the samples around it: at least nine."""
    first, last = np.searchsorted(time, [at - half_width, at + half_width], side="left")
    while last < len(time) and time[last] <= at + half_width:
        last += 1
    if last - first < 9:
        nearest = np.argsort(np.abs(time - at), kind="stable")[:9]
        first, last = nearest.min(), nearest.max() + 1
    t = time[first:last] - at
    scale = max(abs(t).max(), 1e-12)
    powers = np.vander(t / scale, 4, increasing=True)
    fit = np.linalg.lstsq(powers, position[first:last], rcond=None)[0]
    return fit[0], fit[1] / scale


class Simulation:
    """The exported model, of which the reading is a linear function of the first joint."""

    def __init__(self, path):
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        self.sensor = self.model.sensor("position").adr[0]
        self.offset = self._reading(0.0)
        self.gain = self._reading(1.0) - self.offset
        mujoco.mj_resetData(self.model, self.data)

    def _reading(self, angle):
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[0] = angle
        mujoco.mj_forward(self.model, self.data)
        return self.data.sensordata[self.sensor]

    def begin(self):
        """At rest, with no input before."""
        mujoco.mj_resetData(self.model, self.data)

    def restart(self, value, slope):
        """Puts the joint where the reading shows it; what it does not show goes on."""
        mujoco.mj_forward(self.model, self.data)
        shown = self.data.sensordata[self.sensor]
        # A twist that the sensor shows is carried on, and the joint stands that much aside.
        aside = shown - (self.offset + self.gain * self.data.qpos[0])
        turning = self.data.qvel[1] if self.model.nv > 1 and aside != 0.0 else 0.0
        self.data.qpos[0] = (value - self.offset - aside) / self.gain
        self.data.qvel[0] = slope / self.gain - turning

    def go(self, u, span_s):
        """Goes on under an input that is held; returns the reading."""
        steps = max(1, math.ceil(span_s / SUBSTEP_S - 1e-9))
        self.model.opt.timestep = span_s / steps
        self.data.ctrl[0] = u
        for _ in range(steps):
            mujoco.mj_step(self.model, self.data)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_tendon(self.model, self.data)
        mujoco.mj_sensorPos(self.model, self.data)
        return self.data.sensordata[self.sensor]


def predicted(simulation, time, input_, position, horizon, half_width):
    """What the model makes of a run."""
    made = np.empty_like(position)
    simulation.begin()
    window = -1
    for row, t in enumerate(time):
        index = math.floor((t - time[0]) / horizon + 1e-9)
        if index != window:
            window = index
            at = time[0] + index * horizon
            value, slope = restart(time, position, at, half_width)
            simulation.restart(value, slope)
            made[row] = value
            if t - at > 1e-9:
                # The window begins between two rows, under the input of the one before.
                made[row] = simulation.go(input_[max(row - 1, 0)], t - at)
        if row + 1 < len(time):
            next_ = time[row + 1]
            following = math.floor((next_ - time[0]) / horizon + 1e-9)
            end = min(next_, time[0] + following * horizon) if following != index else next_
            if end - t > 1e-9:
                reading = simulation.go(input_[row], end - t)
                if following == index:
                    made[row + 1] = reading
    return made


def columns(path):
    """time, input and position of a run."""
    with open(path, newline="") as file:
        rows = csv.DictReader(file)
        rows.fieldnames = [name.strip() for name in rows.fieldnames]
        cells = [[float(row[name]) for name in ("time", "input", "position")] for row in rows]
    return np.array(cells).T


def gap(recording, path):
    """Root mean square of measured minus predicted position over all samples of all runs."""
    manifest = tomllib.loads((recording / "recording.toml").read_text())
    half_width = manifest.get("restart_half_width", 0.008)
    squares, samples = 0.0, 0
    for run in manifest["runs"]:
        time, input_, position = columns(recording / run["file"])
        made = predicted(Simulation(path), time, input_, position, manifest["horizon"], half_width)
        squares += float(np.sum((position - made) ** 2))
        samples += len(position)
    return math.sqrt(squares / samples)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("recording", type=pathlib.Path)
    arguments.add_argument("model", type=pathlib.Path, help="MJCF of `paddle gap export`")
    arguments.add_argument("--nominal", type=pathlib.Path, help="MJCF of the nominal model, to say what share is closed")
    arguments.add_argument("--write", action="store_true", help="put the result into the head of the model's file")
    given = arguments.parse_args()
    after = gap(given.recording, given.model)
    result = {"gap": after, "mujoco": mujoco.__version__}
    said = f"leaves a gap of {after:.4g} in MuJoCo {mujoco.__version__}"
    if given.nominal:
        before = gap(given.recording, given.nominal)
        result["before"] = before
        said = f"closes {100 * (1 - after / before):.0f} % of the gap in MuJoCo {mujoco.__version__}: {before:.4g} to {after:.4g}"
    if given.write:
        text = re.sub(r"<!-- (closes|leaves) .*? -->\n", "", given.model.read_text())
        given.model.write_text(f"<!-- {said} -->\n{text}")
    print(said, file=sys.stderr)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
