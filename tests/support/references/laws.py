"""Beams whose work is a known law of their gaps, and their lives."""

from types import SimpleNamespace

import numpy as np

from models.beam.response.response import SYMMETRIC
from models.beam.structure.propagation import Record
from models.beam.wear.lives import PERIODS
from models.beam.wear.worn_beams import wear_down


class Law:
    """A propagator whose work at each site is a function of the gaps, with or without noise.

    The first two columns of a state are free for laws that remember.
    """

    CLOCK = -1

    def __init__(self, work, noise=0.0):
        self.work, self.noise = work, noise
        self.random, self.periods = np.random.default_rng(5), 0
        self.growths, self.jumps = [], []

    def advance(self, system, state, gaps, growth, periods):
        record = Record.empty(len(gaps), periods)
        self.periods += periods
        self.growths.append(growth.copy())
        before = gaps.copy()
        for period in range(periods):
            self.take_period(record, period, state, gaps)
            gaps += growth * record.work[:, period]
            state[:, -1] += 1
        self.jumps.append(np.max(gaps - before))
        return record

    def take_period(self, record, period, state, gaps):
        spread = self.noise * self.random.standard_normal((len(gaps), 1))
        record.work[:, period] = self.work(gaps) * np.exp(spread)
        record.strobe[:, period] = 1.0 + spread


def system(n):
    beams = SimpleNamespace(turn=np.full(n, 8.0))
    return SimpleNamespace(free_reach=np.full(n, 1.5), beams=beams, take=lambda rows: system(n))


def lives(law, growths, n=1, regime=SYMMETRIC, accuracy=0.1, instants=None, initial=(1.0, 1.0)):
    """Return the lives of n beams that have settled to the law's work at their initial gaps."""
    gaps = np.tile(initial, (n, 1))
    return wear_down(
        law,
        system(n),
        np.zeros((n, 3)),
        gaps,
        law.work(gaps),
        np.full(n, regime, np.int8),
        np.ones((n, 2)),
        np.tile(growths, (n, 1)),
        round(PERIODS / accuracy),
        accuracy,
        instants=instants,
    )
