"""Functions that sensitivity methods were published with, as models."""

from collections import namedtuple
from itertools import combinations
from typing import Annotated, NamedTuple

import numpy as np
from limit_states import Settings

from uq.contract import Model, Output, Parameter


def _number(symbol):
    return Parameter(symbol, "1", "a number", (-1e3, 1e3), "definition of the function")


class Shares(NamedTuple):
    """Two investments: how many of each, and what each is worth."""

    z1: Annotated[float, _number("Z_1")] = 0.0
    z2: Annotated[float, _number("Z_2")] = 0.0
    w1: Annotated[float, _number("Omega_1")] = 0.0
    w2: Annotated[float, _number("Omega_2")] = 0.0


def _portfolio(x, seed, settings):
    z1, z2, w1, w2 = np.ascontiguousarray(x.T)
    return {"y": z1 * w1 + z2 * w2}, np.zeros(len(x), np.int8)


PORTFOLIO = Model(
    "portfolio", "a portfolio", "1", Shares, Settings, {"y": Output("1", "its worth")}, _portfolio
)
PORTFOLIO_LAWS = {
    "z1": {"distribution": "normal", "mean": 0.0, "sd": 1.0},
    "z2": {"distribution": "normal", "mean": 0.0, "sd": 2.0},
    "w1": {"distribution": "normal", "mean": 1.0, "sd": 1.0},
    "w2": {"distribution": "normal", "mean": 0.5, "sd": 1.0},
}


def portfolio_indices():
    """Return S1, ST and the Shapley effects: z_i w_i has the mean part m_i z_i and an interaction.

    Saltelli et al., "Global sensitivity analysis. The primer", Wiley (2008), section 1.2.
    """
    alone = np.array([1.0 * 1.0, 0.5 * 2.0]) ** 2
    both = np.array([1.0 * 1.0, 1.0 * 2.0]) ** 2
    whole = (alone + both).sum()
    first = np.append(alone, [0.0, 0.0]) / whole
    shared = np.tile(both, 2) / whole
    return {"S1": first, "ST": first + shared, "shapley": first + shared / 2}


Twenty = namedtuple("Twenty", [f"x{i}" for i in range(1, 21)], defaults=[0.5] * 20)
Twenty.__annotations__ = {
    name: Annotated[float, _number(name.replace("x", "x_"))] for name in Twenty._fields
}


def morris_function(x):
    """Evaluate the function of twenty inputs of Morris (1991), section 4.

    M. D. Morris, "Factorial sampling plans for preliminary computational experiments",
    Technometrics 33, 161-174 (1991).
    """
    rng = np.random.default_rng(1991)
    w = 2 * (x - 0.5)
    bent = [2, 4, 6]
    w[:, bent] = 2 * (1.1 * x[:, bent] / (x[:, bent] + 0.1) - 0.5)
    first = np.append(np.full(10, 20.0), rng.standard_normal(10))
    y = w @ first
    for i, j in combinations(range(20), 2):
        y += (-15.0 if j < 6 else rng.standard_normal()) * w[:, i] * w[:, j]
    for three in combinations(range(5), 3):
        y += -10.0 * w[:, three].prod(axis=1)
    return y + 5.0 * w[:, :4].prod(axis=1)


def _morris(x, seed, settings):
    return {"y": morris_function(x.copy())}, np.zeros(len(x), np.int8)


MORRIS = Model(
    "morris", "Morris' function", "1", Twenty, Settings, {"y": Output("1", "value")}, _morris
)
