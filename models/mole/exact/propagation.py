"""Error-controlled propagation of one mole from event to event: its yardstick.

Between two events the equations are smooth, and `models.numerics.dop853` integrates them. Events:
the bar meets or leaves the stop, a slip ends, an interface no longer sticks, the relay switches.
While the bar slips, v keeps its sign: u has its extremes at events, and an integration's ends.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.mole.parameters import PHYSICAL, Params
from models.mole.theory import equations
from models.mole.theory.friction import decide
from models.mole.theory.system import Mole
from models.numerics.dop853 import GUARDED, REACHED_END, integrator
from models.numerics.jit import kernel

STEPS_PER_RADIAN = 10
_SPARE_STEPS = 10_000
_CONTACT, _BAR, _MOLE = range(3)  # guards
_LOOKS = 16  # in a step: with 8, slips of the mole half a millisecond long go unseen


class State(NamedTuple):
    """All that a mole's future depends on.

    Attributes
    ----------
    time : float
        Since the relay first closed [s].
    y : ndarray, shape (12,)
        See `models.mole.theory.equations`.
    contact : bool
        Whether the bar touches the stop.
    bar, mole : int
        How they slip: 1, -1, or 0 if they stick. At zero velocity a slip may just have begun.
    switched : int
        How often the relay has switched: it is closed if that is odd. It switches at multiples of
        half the control period, and a state at that instant is the one before.
    """

    time: float
    y: NDArray[np.float64]
    contact: bool
    bar: int
    mole: int
    switched: int


class Motion(NamedTuple):
    """How one mole moved.

    Attributes
    ----------
    status : int
        `REACHED_END`, `OUT_OF_BUDGET` or `STUCK`, of `models.numerics.dop853`.
    state : State
        The last.
    contacts : int
        Begun on the way.
    events : int
        All of them, switching included.
    lowest, highest : float
        Displacement u [m].
    steps : int
        Tried.
    samples : ndarray, shape (k, 12)
        At the times asked for, NaN from where the motion ended.
    """

    status: int
    state: State
    contacts: int
    events: int
    lowest: float
    highest: float
    steps: int
    samples: NDArray[np.float64]


class _Run(NamedTuple):
    status: int
    time: float
    contact: bool
    bar: int
    mole: int
    switched: int
    contacts: int
    events: int
    lowest: float
    highest: float
    steps: int


@kernel
def _margin(hold, force):
    return hold.limit - abs(hold.gain * force + hold.offset)


@kernel
def _guards(t, y, mode, guard):
    u, v, x, i = y[0], y[1], y[2], y[3]
    gap = mode.q.stop_gap - u
    guard[_CONTACT] = -gap if mode.contact else gap
    guard[_BAR] = mode.bar * v
    guard[_MOLE] = mode.mole * x
    if mode.bar == 0:
        guard[_BAR] = _margin(mode.bar_hold, equations.force(mode.q, mode.contact, u, v, i))
    if mode.mole == 0 and mode.bar == 0:
        guard[_MOLE] = 1.0
    elif mode.mole == 0:
        guard[_MOLE] = _margin(mode.mole_hold, equations.force(mode.q, mode.contact, u, v, i))


@kernel
def _longest(t, y, mode):
    return equations.reach(y[0], y[1], 1 / math.sqrt(2 * mode.q.sharpness))


_integrate = integrator(equations.rates, _guards, 3, _LOOKS, _longest)


@kernel
def _give_way(hold, force):
    """Return the direction of the slip that begins."""
    return 1 if hold.gain * force + hold.offset > 0 else -1


@kernel
def _after(mode, interface, y):
    """Return how bar and mole slip after an event at one interface; put its velocity to rest."""
    bar, mole = mode.bar, mode.mole
    slips = bar != 0 if interface == _BAR else mole != 0
    if slips:
        y[1 if interface == _BAR else 2] = 0.0
    force = equations.force(mode.q, mode.contact, y[0], y[1], y[3])
    if slips:
        return decide(mode.q, y[1], y[2], force)
    # The force is on its limit: to ask again what sticks would be to toss a coin, forever.
    if interface == _BAR:
        bar = _give_way(mode.bar_hold, force)
        if mole == 0:
            mole = decide(mode.q, bar, 0.0, force)[1]
    else:
        mole = _give_way(mode.mole_hold, force)
    return bar, mole


@kernel
def run(q, time, y, contact, bar, mole, switched, end, relative, absolute, budget, times, samples):
    """Advance y in place; see `State` and `models.numerics.dop853` for the arguments."""
    status = REACHED_END
    contacts = events = steps = sampled = 0
    lowest = highest = y[0]
    step = 0.0
    while sampled < len(times) and times[sampled] <= time:
        samples[sampled] = y
        sampled += 1
    while time < end:
        due = 0.5 * q.control_period * switched
        if due <= time:
            if q.formulation == PHYSICAL:
                source = q.voltage * math.sin(q.supply_speed * due + q.supply_phase)
                y[4] += source if switched % 2 == 0 else -source
            switched += 1
            events += 1
            continue
        mode = equations.mode(q, contact, switched % 2 == 1, bar, mole)
        ended = _integrate(
            time,
            min(due, end),
            y,
            step,
            mode,
            relative,
            absolute,
            budget - steps,
            times[sampled:],
            samples[sampled:],
        )
        time, step = ended.time, ended.step
        steps += ended.steps
        sampled += ended.sampled
        lowest, highest = min(lowest, y[0]), max(highest, y[0])
        if ended.status == GUARDED:
            events += 1
            if ended.guard == _CONTACT:
                contact = not contact
                contacts += 1 if contact else 0
            else:
                bar, mole = _after(mode, ended.guard, y)
        elif ended.status != REACHED_END:
            status = ended.status
            break
    return _Run(
        status, time, contact, bar, mole, switched, contacts, events, lowest, highest, steps
    )


def start(params: Params, q: Mole) -> State:
    """Return the state of one mole before its relay first closes.

    Parameters
    ----------
    params : Params
        Each field a float.
    q : Mole
        The same mole, prepared.

    Returns
    -------
    State
    """
    y = np.zeros(equations.SIZE)
    y[0], y[1] = u, v = params.initial_displacement, params.initial_velocity
    contact = u > q.stop_gap
    bar, mole = decide(q, v, 0.0, equations.force(q, contact, u, v, 0.0))
    return State(0.0, y, contact, bar, mole, 0)


def propagate(q: Mole, state: State, end: float, tolerance: float, times: ArrayLike = ()) -> Motion:
    """Follow one mole.

    Parameters
    ----------
    q : Mole
        Each field a number.
    state : State
        It is left as it is.
    end : float
        Time at which to stop [s].
    tolerance : float
        Error allowed in a step, relative to each component of the state, or to its size in
        `scales` if that is greater.
    times : array_like, shape (k,)
        Ascending, when to sample the state [s].

    Returns
    -------
    Motion
        Propagated from its last state, the mole moves on as if it had never stopped, to rounding.
    """
    q = Mole._make([*(float(field) for field in q[:-1]), int(q.formulation)])
    times = np.ascontiguousarray(times, float)
    samples = np.full((len(times), equations.SIZE), np.nan)
    y = np.array(state.y, float)
    ended = run(
        q,
        float(state.time),
        y,
        bool(state.contact),
        int(state.bar),
        int(state.mole),
        int(state.switched),
        float(end),
        float(tolerance),
        tolerance * scales(q),
        int(STEPS_PER_RADIAN * _fastest(q) * max(end - state.time, 0.0)) + _SPARE_STEPS,
        times,
        samples,
    )
    return Motion(
        ended.status,
        State(ended.time, y, ended.contact, ended.bar, ended.mole, ended.switched),
        ended.contacts,
        ended.events,
        ended.lowest,
        ended.highest,
        ended.steps,
        samples,
    )


def _fastest(q: Mole) -> float:
    """Return the sum of the rates at which something happens [s-1]."""
    return (
        math.sqrt((q.contact_stiffness + q.spring_stiffness) / q.mass)
        + q.damping / q.mass
        + q.resistance / q.coil_inductance
        + math.sqrt(q.elastance / q.coil_inductance)
        + q.supply_speed
        + 2 * math.pi / q.control_period
    )


def scales(q: Mole) -> NDArray[np.float64]:
    """Return the size of each component of the state.

    Of voltage and displacement by the data; of the current by the resistance; of energy by what
    such a current has in the coil on behalf of the bar; of velocity and impulse by a bar with that
    energy.
    """
    current = q.voltage / q.resistance
    energy = 0.5 * q.bar_inductance * current**2
    velocity = math.sqrt(2 * energy / q.mass)
    length = 1 / math.sqrt(q.sharpness)
    motion = [length, velocity, velocity * q.mass / q.mole_mass, current, q.voltage, length]
    return np.array([*motion, *[energy] * 5, velocity * q.mass])
