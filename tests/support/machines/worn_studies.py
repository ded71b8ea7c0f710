"""Pads worn at a constant rate: lives in hours until two depths, on two sides."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple

import numpy as np
from computed import computed, study_of
from learnt_studies import lognormal

from uq.contract import Model, Output, Parameter, Setting

RATE = (1.0, 0.5)
"""Median [mm h-1], and standard deviation of the logarithm."""

DEPTHS = (50.0, 100.0, 200.0)
SIDES = ("left", "right")


class Pad(NamedTuple):
    rate: Annotated[float, Parameter("r", "mm h-1", "of wear", (0.0, 1e3), "made up")] = 1.0
    stop: Annotated[float, Parameter("s", "mm", "where it stops", (0.0, 1e9), "made up")] = 1e9


@dataclass(frozen=True)
class Followed:
    """How long a pad is followed."""

    horizon: Annotated[float, Setting("end", "h", bounds=(0.0, math.inf))] = math.inf


def _worn(x, seed, settings):
    """The right side wears half as fast."""
    n, depths = len(x), np.array(DEPTHS)
    speed = x[:, :1, None] * np.array([1.0, 0.5])[:, None]
    life = np.where(depths < x[:, 1:2, None], depths / speed, np.inf)
    late = np.isfinite(life) & (life > settings.horizon)
    outputs = {
        "life": np.where(late, settings.horizon, life),
        "life_censored": late,
        "noise": x[:, 0] ** 0.5,
    }
    return outputs, np.zeros(n, dtype=np.int8)


PAD = Model(
    name="pad",
    title="A pad that wears",
    version="1",
    parameters=Pad,
    settings=Followed,
    outputs={
        "life": Output(
            "h", "time to a depth", "lifetime", ("side", "depth"), scales={"rate": -1.0}
        ),
        "noise": Output("W", "sound power"),
    },
    batch=_worn,
    coordinates=lambda settings: {"side": SIDES, "depth": DEPTHS},
    dimensions={"depth": ("mm", "worn depth")},
)


def _counted(x, seed, settings):
    outputs, status = _worn(x, seed, settings)
    strokes = {"strokes": 60 * 100.0 / x[:, 0], "strokes_censored": np.zeros(len(x), dtype=bool)}
    return outputs | strokes, status


COUNTED = replace(
    PAD,
    name="counted",
    outputs=PAD.outputs
    | {"strokes": Output("1", "strokes to 100 mm", "lifetime", scales={"rate": -1.0})},
    batch=_counted,
)
"""Has lives in two units."""


def pads(samples=2000, units=3, model="PAD", stop=None, analysis=None, settings=None, **rate):
    """Return a result: pads of a batch share the rate."""
    uncertain = {"rate": lognormal(*RATE, "shared") | rate}
    asked = {"outputs": ["life"], "thresholds": {"life": [150.0]}}
    tables = {
        "study": {"name": "pads", "model": {"PAD": "pad", "COUNTED": "counted"}[model]},
        "design": {"method": "monte-carlo", "samples": samples, "units": units, "seed": 5},
        "uncertain": uncertain | ({"stop": stop} if stop else {}),
        "analysis": asked | (analysis or {}),
        "settings": settings or {},
    }
    return computed(study_of(tables, f"worn_studies:{model}"))
