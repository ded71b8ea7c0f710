"""The rules of a life: where a step begins, how long it lasts, when it is taken back."""

import numpy as np
import pytest
from laws import Law, lives

from models.beam.response.response import APERIODIC, PERIODIC, SYMMETRIC
from models.beam.wear.lives import PERIODS
from models.beam.wear.regimes import LONGEST_PERIOD, ROUND, watch
from models.numerics.jit import kernel

AT = 0.8  # growth at which a branch is left
BEFORE, AFTER = 1.0, 4.0  # work on either side
THROUGH = AT + (1 - AT) * BEFORE / AFTER  # life to a growth of one


class Turns(Law):
    """Orbits of several periods, of unequal work."""

    def __init__(self, period):
        super().__init__(lambda gaps: 1.0 + 0 * gaps)
        works = np.arange(1.0, period + 1) ** 2
        self.cycle = works / works.mean()

    def take_period(self, record, period, state, gaps):
        record.work[:, period] = record.strobe[:, period] = self.cycle[
            int(state[0, -1]) % len(self.cycle)
        ]


class Lagging(Law):
    """Work that approaches the law's by one fiftieth in each period."""

    def take_period(self, record, period, state, gaps):
        work = self.work(gaps)
        behind = state[:, 1:2]
        behind += (np.log(work[:, :1]) - behind) / 50
        record.work[:, period] = np.exp(behind)
        record.strobe[:, period] = 1.0 + behind


class Irreversible(Law):
    """A branch that is left for good where the gaps have grown to a certain size."""

    def take_period(self, record, period, state, gaps):
        state[:, 1] = np.maximum(state[:, 1], gaps.max(axis=1) >= 1 + AT)
        record.work[:, period] = np.where(state[:, 1:2] > 0, AFTER, BEFORE)
        record.strobe[:, period] = 1.0 + state[:, 1:2]


class Unstable(Law):
    """A branch that nothing leaves but a disturbance, which grows beyond a certain gap."""

    def take_period(self, record, period, state, gaps):
        beyond = gaps.max(axis=1) >= 1 + AT
        state[:, 0] = np.clip(state[:, 0] * np.where(beyond, 1.2, 0.8), -0.1, 0.1)
        record.work[:, period] = np.where(np.abs(state[:, :1]) >= 0.1, AFTER, BEFORE)
        record.strobe[:, period] = 1.0 + state[:, :1]


class Rattling(Law):
    """A response that is aperiodic within a range of the gaps."""

    def take_period(self, record, period, state, gaps):
        inside = np.abs(gaps.max(axis=1, keepdims=True) - 1.4) <= 0.15
        spread = np.where(inside, 0.5 * self.random.standard_normal((len(gaps), 1)), 0.0)
        record.work[:, period] = self.work(gaps) * np.exp(spread - inside * 0.125)
        record.strobe[:, period] = 1.0 + spread


@kernel
def watched(strobe, apart):
    return watch(strobe, apart)


@pytest.mark.parametrize("regime", [SYMMETRIC, APERIODIC])
def test_wear_begins_at_once_from_the_settled_response(regime):
    law = Law(lambda gaps: 2.0 * gaps)
    lives(law, [1.0], regime=regime)
    assert (law.growths[0] > 0).all()


@pytest.mark.parametrize("period", [3, 5, 6, 7])
def test_the_work_of_an_orbit_is_averaged_over_whole_turns(period):
    wear = lives(Turns(period), [1.0], regime=PERIODIC)
    assert wear.time[0, :, 0] == pytest.approx(1.0, rel=1e-9)
    assert (wear.history.regime[0, :LONGEST_PERIOD] == PERIODIC).all()


def test_a_step_ends_when_the_response_has_followed():
    """A rate of x^2 makes the life g/(1 + g)."""
    wear = lives(Lagging(lambda gaps: gaps**2), [1.0], accuracy=0.02)
    assert wear.time[0, :, 0] == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("law", [Irreversible, Unstable])
def test_a_branch_is_left_where_it_ends_and_not_where_a_step_does(law):
    law = law(lambda gaps: BEFORE + 0 * gaps)
    wear = lives(law, [1.0], accuracy=0.01)
    assert (np.abs(wear.time[0, :, 0] - THROUGH) <= wear.error[0, :, 0]).all()
    assert (wear.error[0, :, 0] <= 0.01 * THROUGH).all()
    assert max(law.jumps) < 0.6  # the step before the change is repeated, not the whole life


def test_gaps_grow_in_steps_again_where_an_aperiodic_response_has_become_an_orbit():
    law = Rattling(lambda gaps: 1.0 + 0 * gaps)
    wear = lives(law, [1.0], accuracy=0.02)
    assert (np.abs(wear.time[0, :, 0] - 1) <= wear.error[0, :, 0]).all()
    seen = wear.history.regime[0]
    seen = seen[seen >= 0]
    assert seen[0] == seen[-1] == SYMMETRIC and (seen == APERIODIC).sum() > 2
    assert law.periods < PERIODS / 0.02 / 3


def test_a_spiral_onto_an_orbit_of_one_period_is_none_of_several():
    """Points three periods apart are closer than neighbours, as the spiral turns by a third."""
    t = np.arange(2 * ROUND)
    spiral = 0.05 * 0.97**t * np.exp(2j * np.pi * t * 0.36)
    points = 1 + np.stack([spiral.real, spiral.imag], axis=1)
    apart = np.full(LONGEST_PERIOD, np.inf)
    watched(points[:ROUND].copy(), apart)
    assert watched(points[ROUND:].copy(), apart) == (1, True)
    assert 2e-2 < apart[0] < 4 * apart[2]
