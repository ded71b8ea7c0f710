"""The velocity of the tip along a known trace.

The modes of the scheme are carried again under the contact force of the trace, from the state at
its beginning, and their velocities summed with the exact ones of the steady response. Modes that
follow the contact statically move with its force. A random load adds a smooth motion, the
difference between the trace and this sum: its velocity is that of a cubic spline.
"""

import numpy as np
import scipy  # which imports scipy.interpolate when it is first used

from models.beam.lanes.layout import X1, X2, P, modes_of
from models.beam.lanes.recurrence import is_static, mode_step
from models.beam.lanes.steps import within
from models.beam.lanes.systems import System, gains
from models.beam.structure.modal import Array
from models.numerics.elementary import cos, sin
from models.numerics.jit import kernel


@kernel
def _penetration(x, x1, x2, right, left):
    """Return the penetration that acts on the modes from x on, as in `models.beam.lanes.steps`."""
    d, d1 = x - within(x, -left, right), x1 - within(x1, -left, right)
    before, after = x1 - x2, x - x1
    p = d
    if d != 0.0:
        p -= (after - before) / 12
    if (d != 0.0) != (d1 != 0.0):
        p -= 0.5 * (d + d1) * (1 - abs((d + d1) / after))
    return p


@kernel
def _carry(modes, frequency, decay, gain, moving, steps, state, gaps, trace, x, v):
    """Set x, from the start on, and v to the part of the tip's motion caused by contact."""
    m = len(state) // 2 - 2
    y, r = state[:m].copy(), state[m : 2 * m].copy()
    p, x1, x2 = state[2 * m + P], state[2 * m + X1], state[2 * m + X2]
    yielding = 0.0
    slope, rest, push_x, push_v = np.zeros(m), np.zeros(m), 0.0, 0.0
    for i in range(len(frequency)):
        w, d, g = frequency[i], decay[i], gain[i]
        if i >= moving or is_static(w, d, 2 * np.pi / steps):
            yielding += g / (w * w)
            continue
        _, p12, _, p22, _, _, b1, b2 = mode_step(w, d, 2 * np.pi / steps)
        slope[i], rest[i] = w / p12, w * p22 / p12
        push_x += g * b1
        push_v += w * g * b2
    force = np.empty(len(trace) + 1)
    force[0] = x1 - within(x1, -gaps[1], gaps[0])
    x[0] = y.sum() + push_x * p + yielding * force[0]
    for k in range(len(trace)):
        total = 0.0
        v[k] = 0.0
        for i in range(m):
            before = y[i]
            y[i] = modes[0, i] * before + r[i] + modes[2, i] * p
            r[i] = modes[3, i] * p - modes[1, i] * before
        x0 = trace[k]
        p = _penetration(x0, x1, x2, gaps[0], gaps[1])
        for i in range(m):
            total += y[i]
            v[k] += slope[i] * r[i] + rest[i] * y[i]
        x2, x1 = x1, x0
        force[k + 1] = x0 - within(x0, -gaps[1], gaps[0])
        x[k + 1] = total + push_x * p + yielding * force[k + 1]
        v[k] += push_v * p
    for k in range(len(trace)):
        last = min(k + 2, len(trace))
        v[k] += yielding * (force[last] - force[k]) / (last - k) * steps / (2 * np.pi)


def speeds(system: System, state: Array, gaps: Array, trace: Array) -> Array:
    """Return the tip's dx/d(Omega t) at each sample of traces, shape (n, samples).

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 4)
        At the start of the traces, at phase 0 of the force.
    gaps : ndarray, shape (n, 2)
        Constant.
    trace : ndarray, shape (n, samples)
        As recorded by `models.beam.lanes.advance`.
    """
    b = system.beams
    samples = trace.shape[1]
    out = np.empty_like(trace)
    if not samples:
        return out
    phase = 2 * np.pi * np.arange(samples + 1) / system.steps
    c, s = cos(phase), sin(phase)
    for n in range(len(trace)):
        w, d, _ = b.in_phase_time(n, b.forcing[n])
        gain = gains(b)[n] / b.forcing[n] ** 2
        x = np.empty(samples + 1)
        _carry(
            *(system.modes[n], w, d, gain, b.moving[n], system.steps),
            *(state[n], gaps[n], trace[n], x, out[n]),
        )
        steady = system.response[n]
        out[n] -= steady.real * s[1:] + steady.imag * c[1:]
        if b.is_random[n]:
            tip = np.append(state[n, 2 * modes_of(state) + X1], trace[n])
            rest = tip - x - (steady.real * c - steady.imag * s)
            out[n] += scipy.interpolate.CubicSpline(phase, rest)(phase[1:], 1)
    return out
