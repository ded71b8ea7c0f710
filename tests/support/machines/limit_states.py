"""Problems of structural reliability with published probabilities, as models."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple

import numpy as np

from uq.contract import Model, Output, Parameter


@dataclass(frozen=True)
class Settings:
    """None."""


def _any(symbol):
    return Parameter(symbol, "1", "a number", (-100.0, 100.0), "definition of the problem")


class Plane(NamedTuple):
    x1: Annotated[float, _any("x_1")] = 0.0
    x2: Annotated[float, _any("x_2")] = 0.0


class Parts(NamedTuple):
    mass: Annotated[float, _any("m")] = 1.0
    stiffness_1: Annotated[float, _any("c_1")] = 1.0
    stiffness_2: Annotated[float, _any("c_2")] = 0.1
    yield_displacement: Annotated[float, _any("r")] = 0.5
    force: Annotated[float, _any("F_1")] = 0.6
    duration: Annotated[float, _any("t_1")] = 1.0


def _branches(x, seed, settings):
    """Four limits about the origin; which is the nearest jumps (Waarts 2000, k = 7)."""
    a, b = np.ascontiguousarray(x.T)
    s, k = math.sqrt(2.0), 7.0
    bend = 3.0 + 0.1 * (a - b) ** 2
    margins = [bend - (a + b) / s, bend + (a + b) / s, a - b + k / s, b - a + k / s]
    outputs = {
        "demand": -np.min(margins, axis=0),
        "sum": (a + b) / s,
        "turn": (a + b) / s,
        "step": np.floor(4.0 * (a + b) / s) / 4.0,
    }
    return outputs, np.zeros(len(x), np.int8)


def _oscillator(x, seed, settings):
    """Largest displacement of an undamped oscillator after a pulse, less what it may be."""
    m, c1, c2, r, force, duration = np.ascontiguousarray(x.T)
    w = np.sqrt((c1 + c2) / m)
    excess = np.abs(2.0 * force / (m * w**2) * np.sin(w * duration / 2.0)) - 3.0 * r
    return {"excess": excess}, np.zeros(len(x), np.int8)


def _cliff(x, seed, settings):
    """Two causes of an event: a slope of x1, and a cliff of x2 without a slope towards it."""
    a, b = np.ascontiguousarray(x.T)
    return {"stress": np.where(b < -4.0, 10.0, a)}, np.zeros(len(x), np.int8)


def _rough(x, seed, settings):
    """A normal value, and noise uniform on (-1/2, 1/2)."""
    return {"rough": x[:, 0] + (seed >> np.uint64(11)) * 2.0**-53 - 0.5}, np.zeros(len(x), np.int8)


def _sphere(x, seed, settings):
    """As far from the centre in every direction: no design point is alone."""
    return {"square": (x**2).sum(axis=1)}, np.zeros(len(x), np.int8)


def _model(name, parameters, batch, outputs):
    return Model(name, "a known probability", "1", parameters, Settings, outputs, batch, block=64)


BRANCHES = _model(
    "branches",
    Plane,
    _branches,
    {
        "demand": Output("1", "demand over capacity of four branches"),
        "sum": Output("1", "standard normal"),
        "turn": Output("rad", "standard normal angle", "angle"),
        "step": Output("1", "standard normal, rounded down to quarters"),
    },
)
OSCILLATOR = _model(
    "oscillator", Parts, _oscillator, {"excess": Output("1", "excess displacement")}
)

ROUGH = replace(
    _model("rough", Plane, _rough, {"rough": Output("1", "a value and noise")}), random=True
)
CLIFF = _model("cliff", Plane, _cliff, {"stress": Output("1", "stress")})
Twenty = NamedTuple(
    "Twenty", [(f"x{i}", Annotated[float, _any(f"x_{{{i}}}")]) for i in range(1, 21)]
)
Twenty._field_defaults = dict.fromkeys(Twenty._fields, 0.0)
Twenty.__new__.__defaults__ = (0.0,) * 20
SPHERE = _model("sphere", Twenty, _sphere, {"square": Output("1", "squared distance")})

STANDARD = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
PLANE = dict.fromkeys(("x1", "x2"), STANDARD)
PARTS = {
    name: {"distribution": "normal", "mean": mean, "sd": sd}
    for name, mean, sd in (
        ("mass", 1.0, 0.05),
        ("stiffness_1", 1.0, 0.1),
        ("stiffness_2", 0.1, 0.01),
        ("yield_displacement", 0.5, 0.05),
        ("force", 0.6, 0.1),
        ("duration", 1.0, 0.2),
    )
}
