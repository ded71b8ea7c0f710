"""The mole followed by scipy from event to event, straight from the paper's formulas."""

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81


class Slip(NamedTuple):
    """Signs of the slips, 0 for stick, and whether the bar touches the stop."""

    bar: int
    mole: int
    contact: bool


class Machine:
    """Forces and modes of one mole."""

    def __init__(self, p, formulation):
        self.p, self.printed = p, formulation == "as-printed"
        self.jumps = formulation == "physical"
        m_1, m_2 = p.bar_mass, p.mole_mass
        self.m = m_1 * m_2 / (m_1 + m_2)
        self.f_1 = p.bar_friction * m_1 * G
        self.f_2 = p.mole_friction * (m_1 + m_2) * G
        self.omega = 2 * np.pi * p.supply_frequency

    def inductance(self, u):
        p = self.p
        bump = p.inductance_coefficient / (p.inductance_width * math.sqrt(np.pi / 2))
        bump *= math.exp(-2 * u**2 / p.inductance_width**2)
        return p.coil_inductance + bump, -4 * u / p.inductance_width**2 * bump

    def force(self, y, contact):
        p, (u, v, _, i, _, _) = self.p, y
        pull = i**2 * self.inductance(u)[1] / 2 - p.viscous_damping * v
        pull -= p.spring_stiffness * (u - p.spring_rest)
        return pull - (p.contact_stiffness * (u - p.stop_gap) if contact else 0.0)

    def frictions(self, y, slip):
        f = self.force(y, slip.contact)
        t_1, t_2 = self.f_1 * slip.bar, self.f_2 * slip.mole
        if not slip.bar:
            t_1 = f if self.printed or not slip.mole else f + t_2 * self.m / self.p.mole_mass
        if not slip.mole:
            t_2 = t_1 - f
        return f, t_1, t_2

    def rates(self, t, y, slip, on):
        p, (u, v, x, i, p_, _) = self.p, y
        f, t_1, t_2 = self.frictions(y, slip)
        dv = (f - t_1) / self.m + (0.0 if self.printed else t_2 / p.mole_mass)
        dx = (t_1 - f - t_2) / p.mole_mass
        inductance, slope = self.inductance(u)
        di = (p_ - (p.resistance + slope * v) * i) / inductance
        dp = -i / p.capacitance
        if on:
            phase = self.omega * t + p.supply_phase
            dp += self.omega * p.supply_voltage * math.cos(phase)
        return [v, dv if slip.bar else 0.0, dx if slip.mole else 0.0, di, dp, x]

    def judged(self, y, contact):
        """Modes by the Filippov conditions."""
        v, x = y[1:3]
        f, s_1, s_2 = self.force(y, contact), int(np.sign(v)), int(np.sign(x))
        if v == 0:
            reach = f
            if x != 0 and not self.printed:
                reach = f + self.f_2 * s_2 * self.m / self.p.mole_mass
            s_1 = int(np.sign(reach)) if abs(reach) > self.f_1 else 0
        if x == 0 and s_1:
            push = self.f_1 * s_1 - f
            s_2 = int(np.sign(push)) if abs(push) > self.f_2 else 0
        return Slip(s_1, s_2, contact)


def follow(p, formulation, end, times, longest=5e-4):
    """Return states (k, 6) at ascending times, and the number of contacts begun.

    No step is longer than `longest` [s].
    """
    m = Machine(p, formulation)
    y = np.zeros(6)
    y[:2] = p.initial_displacement, p.initial_velocity
    slip = m.judged(y, y[0] > p.stop_gap)
    half, switched, t, begun = 0.5 / p.control_frequency, 0, 0.0, 0
    out = np.full((len(times), 6), np.nan)

    def touch(t, y, slip, on):
        return (y[0] - p.stop_gap) * (1 if slip.contact else -1)

    def bar(t, y, slip, on):
        return slip.bar * y[1] if slip.bar else m.f_1 - abs(m.frictions(y, slip)[1])

    def mole(t, y, slip, on):
        if slip.mole:
            return slip.mole * y[2]
        return m.f_2 - abs(m.frictions(y, slip)[2]) if slip.bar else 1.0

    for event in (touch, bar, mole):
        event.terminal, event.direction = True, -1
    while t < end:
        if t == switched * half:
            jump = p.supply_voltage * math.sin(m.omega * t + p.supply_phase)
            y[4] += (-jump if switched % 2 else jump) if m.jumps else 0.0
            switched += 1
        done = solve_ivp(
            m.rates,
            (t, min(end, switched * half)),
            y,
            "DOP853",
            events=(touch, bar, mole),
            args=(slip, switched % 2),
            rtol=1e-12,
            atol=1e-13,
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
        _, t_1, t_2 = m.frictions(y, slip)
        if which == 0:
            slip = slip._replace(contact=not slip.contact)
            begun += slip.contact
        elif which == 1 and slip.bar == 0:
            slip = slip._replace(bar=int(np.sign(t_1)))
        elif which == 2 and slip.mole == 0:
            slip = slip._replace(mole=int(np.sign(t_2)))
        else:
            y[which] = 0.0
            slip = m.judged(y, slip.contact)
    return out, begun
