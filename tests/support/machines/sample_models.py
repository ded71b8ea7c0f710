"""Models for the tests of the platform: one output of every kind, cheap twins, noise, sums."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple

import numpy as np

from uq.contract import Model, Output, Parameter, Setting, Status, Trajectory


class Parameters(NamedTuple):
    x1: Annotated[float, Parameter("x_1", "m", "first input", (0.0, 1.0), "made up")] = 0.25
    x2: Annotated[float, Parameter("x_2", "s", "second input", (0.0, 1.0), "made up")] = 0.5


@dataclass(frozen=True)
class Settings:
    """Numerical choices."""

    seconds: Annotated[float, Setting("time a row takes", "s", bounds=(0.0, 100.0))] = 0.0


SIDES = ("left", "right")
DEPTHS = (0.5, 1.5)


def kinds(x, seed, settings):
    """Rows with small x1 never end, with large x1 are censored; with small x2 have no angle."""
    n = len(x)
    x1, x2 = np.ascontiguousarray(x.T)
    life = np.stack([np.stack([x1 + d for d in DEPTHS], axis=-1)] * 2, axis=1)
    censored = np.repeat(x1 > 0.8, 4).reshape(n, 2, 2)
    life[x1 < 0.2] = np.inf
    outputs = {
        "work": np.stack([x1, x1 + 1e-3 * (seed % 7)], axis=-1),
        "life": life,
        "life_censored": censored,
        "angle": np.where(x2 < 0.2, np.nan, x2),
        "regime": (x1 > 0.5).astype(np.int8),
    }
    status = np.where(x1 > 0.95, Status.OUT_OF_BUDGET, Status.OK).astype(np.int8)
    return outputs, status


def history(params, settings, seed=0):
    t = np.linspace(0.0, 1.0, 11)
    return Trajectory(t, {"x": ("m", "place", params.x1 * t), "v": ("m s-1", "speed", t * 0.0)})


KINDS = Model(
    name="kinds",
    title="One output of every kind",
    version="1",
    parameters=Parameters,
    settings=Settings,
    outputs={
        "work": Output("W", "work rate", dims=("side",)),
        "life": Output("s", "time to a depth", kind="lifetime", dims=("side", "depth")),
        "angle": Output("rad", "an angle", kind="angle", may_be_undefined=True),
        "regime": Output("1", "which regime", kind="category", categories=("slow", "fast")),
    },
    batch=kinds,
    simulate=history,
    coordinates=lambda settings: {"side": SIDES, "depth": DEPTHS},
    references=("Nobody, Nowhere (1900)",),
)


def simple(name, batch, **more):
    """Return a model of two inputs, with one output ``y`` unless other outputs are given."""
    declared = {
        "title": "For a test",
        "version": "1",
        "parameters": Parameters,
        "settings": Settings,
        "outputs": {"y": Output("1", "some number")},
    }
    return Model(name=name, batch=batch, **(declared | more))


def ok(n):
    return np.zeros(n, dtype=np.int8)


def _plain(x, seed, settings):
    return {"y": x[:, 0].copy()}, ok(len(x))


PLAIN = simple("plain", _plain)
"""y = x1."""


class Mounting(NamedTuple):
    mount_stiffness: Annotated[
        float, Parameter("k", "N m-1", "stiffness of the mount", (1e4, math.inf), "rigid")
    ] = math.inf
    mass: Annotated[float, Parameter("m", "kg", "mass on the mount", (0.0, 1e3), "made up")] = 2.0


def _sag(x, seed, settings):
    return {"sag": 9.81 * x[:, 1] / x[:, 0]}, ok(len(x))


MOUNTED = simple(
    "mounted", _sag, parameters=Mounting, outputs={"sag": Output("m", "deflection of the mount")}
)
"""Has a parameter that is infinite unless given."""


def _near(x, seed, settings):
    return {"near": np.where(x[:, 1] < 0.1, np.nan, x[:, 0])}, ok(len(x))


def _far(x, seed, settings):
    return {"far": (seed % 997) / 997.0}, ok(len(x))


def _same(x, seed, settings):
    return {"same": _paired_y(x)}, ok(len(x))


def _paired_y(x):
    return np.exp(x[:, 0]) + 0.3 * x[:, 1]


def _paired(x, seed, settings):
    y = _paired_y(x)
    outputs = {
        "y": np.where(x[:, 1] > 0.9, np.inf, y),
        "patchy": np.where(x[:, 0] < 0.2, np.nan, y),
        "life": np.where(x[:, 0] < 0.5, np.inf, 1 / x[:, 0]),
    }
    for cheap in (_near, _far, _same):
        outputs |= cheap(x, seed, settings)[0]
    return outputs, ok(len(x))


PAIRED = simple(
    "paired",
    _paired,
    outputs={
        "y": Output("1", "exp(x1) + 0.3 x2, failing at large x2"),
        "patchy": Output("1", "y, without meaning at small x1", may_be_undefined=True),
        "life": Output("s", "1/x1, never at small x1", "lifetime", may_be_censored=False),
        "near": Output("1", "x1, without meaning at small x2", may_be_undefined=True),
        "far": Output("1", "has nothing to do with y"),
        "same": Output("1", "y again"),
    },
    cheap={"near": _near, "far": _far, "same": _same},
)
"""Outputs that a cheap one of the same model tells much of, nothing of, or all of."""


@dataclass(frozen=True)
class Terms:
    """How much of a series is summed."""

    terms: Annotated[int, Setting("terms of the series", bounds=(1, 30))] = 20


def _series(x, seed, settings):
    total = sum(x[:, 0] ** k / math.factorial(k) for k in range(settings.terms))
    return {"y": total + 0.3 * x[:, 1]}, ok(len(x))


SERIES = simple("series", _series, settings=Terms)
"""y = exp(x1) + 0.3 x2, or less than that with few terms."""


class Summands(NamedTuple):
    a: Annotated[float, Parameter("a", "1", "first term", (-1e3, 1e3), "made up")] = 10.0
    b: Annotated[float, Parameter("b", "1", "second term", (-1e3, 1e3), "made up")] = 10.0
    c: Annotated[float, Parameter("c", "1", "third term", (-1e3, 1e3), "made up")] = 0.0


def _added(x, seed, settings):
    return {"y": x.sum(axis=1)}, ok(len(x))


ADDED = simple("added", _added, parameters=Summands)
"""y = a + b + c."""


def _noise(seed):
    """Return numbers uniform on (-1/2, 1/2), independent from seed to seed."""
    return (seed >> np.uint64(11)) * 2.0**-53 - 0.5


def _noisy(x, seed, settings):
    x1, x2 = np.ascontiguousarray(x.T)
    noise = _noise(seed)
    # In `crossed` the noise acts through x2 alone.
    return {"y": x1 + noise, "crossed": x1 + 2 * x2 * noise}, ok(len(x))


NOISY = simple(
    "noisy",
    _noisy,
    outputs={
        "y": Output("1", "x1 and noise of the same variance"),
        "crossed": Output("1", "x1 and noise times 2 x2"),
    },
    random=True,
)
"""Depends on its seed; x2 does nothing to y."""


def _sometimes(x, seed, settings):
    return {"y": x[:, 0] + x[:, 1] * _noise(seed)}, ok(len(x))


SOMETIMES = simple("sometimes", _sometimes, random=True, random_unless={"x2": 0.0})
"""Depends on its seed unless x2 is 0."""


class ScaledParameters(NamedTuple):
    a: Annotated[float, Parameter("a", "1", "scales the life", (1e-6, 1e6), "made up")] = 1.0
    b: Annotated[float, Parameter("b", "1", "scales it, too", (1e-2, 50.0), "made up")] = 1.0
    c: Annotated[float, Parameter("c", "1", "scales it, too", (1e-6, 1e6), "made up")] = 1.0
    z: Annotated[float, Parameter("z", "1", "something else", (-1e6, 1e6), "made up")] = 0.0


@dataclass(frozen=True)
class ScaledSettings:
    """What may happen to a life."""

    horizon: Annotated[float, Setting("lives are cut there", "s")] = float("inf")
    never_above: Annotated[float, Setting("z above which no life ends")] = float("inf")
    fail_above: Annotated[float, Setting("z above which rows fail")] = float("inf")


def scaled_life(x, seed, settings):
    """Return life = a b^-2 c^(1/2) exp(z/2)."""
    a, b, c, z = x.T.copy()
    life = a / (b * b) * np.sqrt(c) * np.exp(z / 2)
    life[z > settings.never_above] = np.inf
    cut = np.isfinite(life) & (life > settings.horizon)
    life[cut] = settings.horizon
    failed = z > settings.fail_above
    life[failed] = np.nan
    status = np.where(failed, Status.NON_FINITE, Status.OK).astype(np.int8)
    return {"life": life, "life_censored": cut & ~failed, "y": z}, status


SCALED = Model(
    name="scaled",
    title="life that three inputs scale",
    version="1",
    parameters=ScaledParameters,
    settings=ScaledSettings,
    outputs={
        "life": Output("s", "life", "lifetime", scales={"a": 1.0, "b": -2.0, "c": 0.5}),
        "y": Output("1", "another output"),
    },
    batch=scaled_life,
)


def _delayed_life(x, seed, settings):
    return {"life": x[:, 0] + x[:, 3] ** 2, "life_censored": np.zeros(len(x), bool)}, ok(len(x))


DELAYED = replace(
    SCALED,
    name="delayed",
    title="life that an input scales unless another one delays it",
    outputs={
        "life": Output(
            "s",
            "life",
            "lifetime",
            scales=lambda settings, constants: {"a": 1.0} if constants.get("z") == 0 else {},
        )
    },
    batch=_delayed_life,
)
"""Life a + z^2."""
