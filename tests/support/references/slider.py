"""A mole that pushes soil, followed by scipy from event to event, straight from the equations.

Of both bodies the accelerations X1'' and X2'' are written down, and of the frictions at rest every
combination is tried.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from filippov import Machine
from scipy.integrate import solve_ivp

APART, ELASTIC, SLIDING = "apart", "elastic", "sliding"
U, V, X, _, P, W, Z, B = range(8)


class Mode(NamedTuple):
    """Signs of the slips, whether the bar touches the stop, and how the soil is touched."""

    bar: int
    mole: int
    contact: bool
    soil: str


class Pushing(Machine):
    """A mole with soil ahead."""

    def __init__(self, p):
        super().__init__(p, "physical")
        self.k, self.c = p.soil_stiffness, p.soil_damping

    def limit(self, y):
        return self.p.soil_limit + self.p.soil_limit_gradient * y[B]

    def reaction(self, y, soil):
        if soil == APART:
            return 0.0
        return self.limit(y) if soil == SLIDING else self.k * (y[W] - y[B]) + self.c * y[X]

    def balance(self, y, mode):
        """Accelerations X1'', X2'' and frictions T1, T2."""
        m_1, m_2 = self.p.bar_mass, self.p.mole_mass
        f, soil = self.force(y[:6], mode.contact), self.reaction(y, mode.soil)
        t_1, t_2 = self.f_1 * mode.bar, self.f_2 * mode.mole
        if mode.bar and mode.mole:
            return (f - t_1) / m_1, (t_1 - f - t_2 - soil) / m_2, t_1, t_2
        if mode.bar:
            return (f - t_1) / m_1, 0.0, t_1, t_1 - f - soil
        together = -(t_2 + soil) / (m_1 + m_2) if mode.mole else 0.0
        return together, together, f - m_1 * together, t_2 if mode.mole else -soil

    def rates(self, t, y, mode, on):
        first, second, _, _ = self.balance(y, mode)
        electric = super().rates(t, y[:6], mode, on)[3:5]
        z = b = 0.0
        if mode.soil == APART:
            z = -self.k / self.c * (y[Z] - y[B]) if self.c else 0.0
        else:
            z = y[X]
        if mode.soil == SLIDING and self.c:
            b = y[X] - (self.limit(y) - self.k * (y[W] - y[B])) / self.c
        elif mode.soil == SLIDING:
            b = self.k * y[X] / (self.k + self.p.soil_limit_gradient)
        return [y[V], first - second, second, *electric, y[X], z, b]

    def judged(self, y, contact, soil):
        """The only combination of frictions that contradicts nothing."""
        fits = []
        for bar, mole in itertools.product((-1, 0, 1), repeat=2):
            if (y[V] and bar != np.sign(y[V])) or (y[X] and mole != np.sign(y[X])):
                continue
            first, second, t_1, t_2 = self.balance(y, Mode(bar, mole, contact, soil))
            fit = abs(t_1) <= self.f_1 * (1 + 1e-13) and abs(t_2) <= self.f_2 * (1 + 1e-13)
            fit &= bool(y[V]) or not bar or bar * (first - second) > 0
            fit &= bool(y[X]) or not mole or mole * second > 0
            if fit:
                fits.append(Mode(bar, mole, contact, soil))
        assert len(fits) == 1, (y, contact, soil, fits)
        return fits[0]

    def settled(self, y, mode):
        """The mode of the soil of a mole that starts from rest, or stays."""
        force = self.k * (y[W] - y[B])
        if mode.mole > 0 and y[W] >= y[Z]:
            full = force >= self.limit(y) * (1 - 1e-11)
            return mode._replace(soil=SLIDING if full else ELASTIC)
        if mode.mole < 0 and mode.soil != APART and force <= 0:
            return mode._replace(soil=APART)
        return mode


def follow(p, end, times, longest=5e-4):
    """Return states (k, 8) at ascending times, and the number of events at the soil."""
    m = Pushing(p)
    y = np.zeros(8)
    y[:2] = p.initial_displacement, p.initial_velocity
    mode = m.settled(y, m.judged(y, y[U] > p.stop_gap, APART))
    half, switched, t, count = 0.5 / p.control_frequency, 0, 0.0, 0
    out = np.full((len(times), 8), np.nan)

    def touch(t, y, mode, on):
        return (y[U] - p.stop_gap) * (1 if mode.contact else -1)

    def bar(t, y, mode, on):
        return mode.bar * y[V] if mode.bar else m.f_1 - abs(m.balance(y, mode)[2])

    def mole(t, y, mode, on):
        if mode.mole:
            return mode.mole * y[X]
        return m.f_2 - abs(m.balance(y, mode)[3]) if mode.bar else 1.0

    def trial(y):
        return m.k * (y[W] - y[B]) + m.c * y[X]

    def soil(t, y, mode, on):
        if mode.soil == APART:
            return y[Z] - y[W]
        return trial(y) if mode.soil == ELASTIC and mode.mole else 1.0

    def yields(t, y, mode, on):
        if mode.soil == ELASTIC and mode.mole:
            return m.limit(y) - trial(y)
        return trial(y) - m.limit(y) if mode.soil == SLIDING and m.c else 1.0

    events = touch, bar, mole, soil, yields
    for event in events:
        event.terminal, event.direction = True, -1
    while t < end:
        if t == switched * half:
            jump = p.supply_voltage * math.sin(m.omega * t + p.supply_phase)
            y[P] += -jump if switched % 2 else jump
            switched += 1
        until = min(end, switched * half)
        done = solve_ivp(
            m.rates,
            (t, until),
            y,
            "DOP853",
            events=events,
            args=(mode, switched % 2),
            rtol=1e-12,
            atol=1e-13,
            first_step=min(1e-6, until - t),  # a slip that has just begun must not seem to end
            max_step=longest,
            dense_output=True,
        )
        here = (times >= t) & (times <= done.t[-1])
        if here.any():
            out[here] = done.sol(times[here]).T
        t, y = done.t[-1], done.y[:, -1]
        if done.status != 1:
            continue
        which = [len(event_times) > 0 for event_times in done.t_events].index(True)
        count += which > 2
        _, _, t_1, t_2 = m.balance(y, mode)
        if which == 0:
            mode = mode._replace(contact=not mode.contact)
        elif which == 4:
            mode = mode._replace(soil=SLIDING if mode.soil == ELASTIC else ELASTIC)
        elif which == 3 and mode.soil == APART:
            y[Z] = y[W]
            at_once = SLIDING if trial(y) >= m.limit(y) else ELASTIC
            mode = mode._replace(soil=at_once)
            if m.c:
                mode = (
                    m.settled(y, m.judged(y, mode.contact, at_once))
                    if y[X] == 0
                    else (m.judged(y, mode.contact, at_once))
                )
        elif which == 3:
            y[Z] = y[W] if m.c else y[B]
            mode = mode._replace(soil=APART)
        elif which == 1 and mode.bar == 0:
            mode = mode._replace(bar=int(np.sign(t_1)))
        elif which == 2 and mode.mole == 0:
            mode = m.settled(y, mode._replace(mole=int(np.sign(t_2))))
        else:
            y[which] = 0.0
            soil_now = ELASTIC if which == 2 and mode.soil == SLIDING else mode.soil
            mode = m.judged(y, mode.contact, soil_now)
            if y[X] == 0:
                mode = m.settled(y, mode)
    return out, count
