"""Measures the gap between a simulation and a device, and names the effect that causes it.

    from paddle_gap import Recording, diagnose
    recording = Recording.from_arrays(time, input, position, model={"inertia": 5.8e-4, "coulomb": 0.015, "ratio": 15.0})
    diagnosis = diagnose(recording)
    print(diagnosis["verdict"], [effect["name"] for effect in diagnosis["effects"]])
"""

from __future__ import annotations

import html
import json
from typing import Any, Iterable, Mapping, Optional, Sequence

import numpy as np

from . import _native

__all__ = ["Recording", "Diagnosis", "diagnose", "measure", "look"]


class Recording:
    """Input and position of a device, with the nominal model of the device. SI units."""

    def __init__(self, native: "_native.Recording") -> None:
        self._native = native

    @classmethod
    def read(cls, folder: str) -> "Recording":
        """Reads a folder with a `recording.toml`."""
        return cls(_native.Recording.read(str(folder)))

    @classmethod
    def from_arrays(
        cls,
        time: Sequence[float],
        input: Sequence[float],
        position: Sequence[float],
        *,
        model: Mapping[str, float],
        horizon: float = 0.3,
        title: str = "recording",
        units: tuple[str, str] = ("rad", "N m"),
        closed_loop: bool = False,
        resolution: float = 0.0,
        noise: float = 0.0,
        cutoff_hz: Optional[float] = None,
        tolerance: Optional[Mapping[str, float]] = None,
    ) -> "Recording":
        """Creates a recording of one run. `model` has the names of a recording's `[model]`. `ratio`, `viscous`, `coulomb`
        and `gravity` are estimated if they are left out. `resolution` and `noise` describe the position sensor."""
        if "inertia" not in model:
            raise ValueError("the model needs an inertia; state what you know, even roughly, with a tolerance")
        native = _native.Recording(title, float(horizon), {k: float(v) for k, v in model.items()}, units)
        native.set_sensor(float(resolution), float(noise), cutoff_hz)
        for name, relative in (tolerance or {}).items():
            native.set_tolerance(name, float(relative))
        recording = cls(native)
        recording.add_run(time, input, position, closed_loop=closed_loop)
        native.validate()
        return recording

    def add_run(
        self,
        time: Sequence[float],
        input: Sequence[float],
        position: Sequence[float],
        *,
        name: Optional[str] = None,
        closed_loop: bool = False,
    ) -> None:
        """Adds a run of the same device."""
        columns = [np.ascontiguousarray(column, dtype=np.float64) for column in (time, input, position)]
        if any(column.ndim != 1 for column in columns):
            raise ValueError("time, input and position must be vectors")
        self._native.add_run(name or f"run-{len(self.runs) + 1}.csv", closed_loop, *columns)

    @property
    def runs(self) -> list[tuple[str, int]]:
        """Names of the runs with their numbers of rows."""
        return self._native.runs

    @property
    def warnings(self) -> list[str]:
        """Warnings about the recording."""
        return self._native.warnings

    def write(self, folder: str) -> None:
        """Writes the recording to a folder for the command line."""
        self._native.write(str(folder))

    def __repr__(self) -> str:
        rows = sum(rows for _, rows in self.runs)
        return f"<Recording {self._native.title!r}: {len(self.runs)} runs, {rows} rows>"


class Diagnosis(dict):
    """A diagnosis: the dictionary that the command line writes as JSON, shown as a table in a notebook."""

    def __init__(self, values: Mapping[str, Any], model: str, recording: Recording) -> None:
        super().__init__(values)
        self.model = model
        """The corrected model, as `paddle gap diagnose --save-model` writes it."""
        self._recording = recording

    def __repr__(self) -> str:
        gap = self["gap"]
        effects = ", ".join(effect["name"] for effect in self["effects"]) or "none"
        return (
            f"<Diagnosis {self['verdict']}: gap {gap['before']:.3g} to {gap['after']:.3g} {gap['unit']} "
            f"(floor {gap['floor']:.2g}), effects: {effects}>"
        )

    def _repr_html_(self) -> str:
        gap = self["gap"]
        rows = "".join(
            f"<tr><td>{html.escape(effect['name'])}</td><td>{effect['confidence']:.2f}</td><td>{effect['shrink']:.2f}</td>"
            f"<td>{html.escape(_numbers(effect['parameters']))}</td></tr>"
            for effect in self["effects"]
        )
        return (
            f"<p><b>{self['verdict']}</b>: the gap falls from {gap['before']:.3g} to {gap['after']:.3g} {gap['unit']} "
            f"(floor {gap['floor']:.2g})</p>{self._picture()}"
            f"<table><tr><th>effect</th><th>confidence</th><th>shrink</th><th>numbers</th></tr>{rows}</table>"
        )

    def _picture(self) -> str:
        """Measured, nominal and corrected position of the first run's first windows."""
        _, nominal = measure(self._recording, predictions=True)
        _, corrected = measure(self._recording, model=self.model, predictions=True)
        name, time, measured, predicted = nominal[0]
        shown = slice(0, min(len(time), 2000))
        lines = [("#000", measured[shown]), ("#c33", predicted[shown]), ("#36c", corrected[0][3][shown])]
        low, high = min(line.min() for _, line in lines), max(line.max() for _, line in lines)
        t = time[shown]
        x = 700 * (t - t[0]) / max(t[-1] - t[0], 1e-12)
        paths = "".join(
            f'<polyline fill="none" stroke="{ink}" points="'
            + " ".join(f"{a:.1f},{190 - 180 * (b - low) / max(high - low, 1e-12):.1f}" for a, b in zip(x, line))
            + '"/>'
            for ink, line in lines
        )
        legend = f"{html.escape(name)}: measured black, nominal red, corrected blue"
        return f'<svg width="700" height="200" role="img">{paths}</svg><p>{legend}</p>'


def _numbers(parameters: Mapping[str, Mapping[str, Any]]) -> str:
    return ", ".join(f"{name} {p['value']:.3g} {p['unit']}" for name, p in parameters.items())


def diagnose(recording: Recording, without: Iterable[str] = ()) -> Diagnosis:
    """Diagnoses the recording, as `paddle gap diagnose` does."""
    text, model = recording._native.diagnose(list(without))
    return Diagnosis(json.loads(text), model, recording)


def measure(recording: Recording, model: Optional[str] = None, predictions: bool = False) -> Any:
    """Measures the gap of the nominal model, or of a saved model given as text. With `predictions` it also returns the name,
    time, measured and predicted position of each run."""
    text, runs = recording._native.measure(model)
    return (json.loads(text), runs) if predictions else json.loads(text)


def look(recording: Recording) -> dict[str, Any]:
    """Estimates the torque that the nominal model lacks, without naming an effect, as `paddle gap look` does."""
    return json.loads(recording._native.look())
