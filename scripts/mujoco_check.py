#!/usr/bin/env python3
"""Whether MuJoCo runs what `paddle gap export ... mjcf` writes: the gap there against ours, effect by effect.

    python3 scripts/mujoco_check.py target/debug/paddle [--table]

For each effect that MJCF can express, a recording of the simulated paddle with the effect is made. The model with the same
effect is exported, run in MuJoCo by the rule of the recording format, and its gap compared with that of `paddle gap
measure`. Ends with status 1 where one differs by more than 10 %, and with status 77 and a line `skipped: ...` where MuJoCo
is not there. --table prints the rows as a table for docs/export.md.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import mujoco_gap

EFFECTS = {
    "coulomb": None,
    "asymmetric_coulomb": None,
    "viscous": None,
    "quadratic_drag": None,
    "inertia": None,
    "gravity": None,
    "spring": None,
    "end_stop": {"lower": -0.12, "upper": 0.12},
    "backlash": {"damping": 0.05},
    "compliance": None,
    "torque_gain": None,
    "torque_offset": None,
    "lag": None,
    "delay": None,
    "saturation": {"limit": 0.003},
    "sensor_gain": None,
}
"""Effects that MJCF has, each with what is set beside its defaults so that the effect shows. With little damping the two sides
of a play bounce, and where they are at the next restart is chance."""

mujoco_gap.SUBSTEP_S = 5e-5
"""A whole number of steps makes the rows and the delay here, so that no rounding of the delay is measured."""

WITHIN = 0.1
"""Largest relative difference of the two gaps."""


def numbers(text):
    """The lines of `[model]` of a manifest."""
    return text.split("[model]\n", 1)[1].split("\n\n", 1)[0]


def parameters(paddle):
    """Each effect's parameters with their defaults."""
    known = json.loads(subprocess.run([paddle, "effects", "--json", "-"], capture_output=True, check=True).stdout)
    return {
        effect["name"]: {parameter["name"]: parameter["default"] for parameter in effect["parameters"]}
        for effect in known["effects"]
    }


def gaps(paddle, folder, effect, values):
    """The gap of the model with the effect on a recording with the effect, ours and MuJoCo's, and that of the model without."""

    def run(*words):
        return subprocess.run([paddle, *map(str, words)], capture_output=True, check=True, text=True).stdout

    recording, saved, exported = folder / "recording", folder / "model.toml", folder / "model.xml"
    told = ",".join(f"{name}={value}" for name, value in values.items())
    run(
        "sim", "multisine", "--amplitude", 12, "--frequency", 0.9, "--seconds", 6, "--log-rate", 1000, "--horizon", 0.25,
        "--with", f"{effect}:{told}", "--out", folder / "out", "--recording", recording,
    )
    entry = "\n".join(f"{name} = {float(value)!r}" for name, value in values.items())
    saved.write_text(
        f"format = 1\n[model]\n{numbers((recording / 'recording.toml').read_text())}\n"
        f"[[effects]]\nname = \"{effect}\"\n[effects.parameters]\n{entry}\n"
    )
    run("gap", "export", saved, "mjcf", "--out", exported)

    def measured(*words):
        return json.loads(run("gap", "measure", recording, *words, "--json", "-"))["gap"]["before"]

    return measured("--model", saved), mujoco_gap.gap(recording, exported), measured()


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("paddle", help="the program `paddle`")
    arguments.add_argument("--table", action="store_true", help="print a table for a page")
    given = arguments.parse_args()
    known = parameters(given.paddle)
    amiss = 0
    if given.table:
        print("| effect | gap without it, mrad | with it, ours | with it, in MuJoCo |\n|---|---|---|---|")
    for effect, own in EFFECTS.items():
        with tempfile.TemporaryDirectory() as folder:
            ours, there, without = gaps(given.paddle, pathlib.Path(folder), effect, {**known[effect], **(own or {})})
        is_amiss = abs(there - ours) > WITHIN * ours
        amiss += is_amiss
        if given.table:
            print(f"| `{effect}` | {1e3 * without:.3f} | {1e3 * ours:.4f} | {1e3 * there:.4f} |")
        else:
            note = "  DIFFERS" if is_amiss else ""
            print(f"{effect:<20} without {1e3 * without:9.4f} mrad, ours {1e3 * ours:.4f}, in MuJoCo {1e3 * there:.4f}{note}")
        sys.stdout.flush()
    sys.exit(1 if amiss else 0)


if __name__ == "__main__":
    main()
