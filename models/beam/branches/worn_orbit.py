"""Wear in the infinitely slow limit, along one stable orbit (eqs 9 to 12).

With the sum s of both gap growths as the independent variable, and r_i the work-rate of a site
times its share of the wear coefficient,

    dx_i/ds = r_i/(r_1 + r_2),    dT/ds = 1/(r_1 + r_2),

which is regular even if one site does not wear; the paper uses x_1 instead. Steps are those of the
pair of orders 3 and 2 by Bogacki and Shampine.
"""

from typing import NamedTuple

import numpy as np

from models.beam.branches.bifurcations import Event, cause_of_loss, kind_of
from models.beam.branches.orbits import TOLERANCE, Orbit, defect, orbit_of
from models.beam.exact.events import RIGHT
from models.beam.exact.passage import Passage, passage
from models.beam.exact.tuning import Beam
from models.beam.structure.modal import Array
from models.numerics.newton import find_root
from models.numerics.tableaux import BOGACKI_SHAMPINE_3, ERROR_2

ATTEMPTS = 5000  # steps, at most
NEARNESS = 1e-6  # in initial gaps: tolerance in locating the end and every grazing
_NEAR = 0.05  # an orbit farther from its prediction, relative to its state, is another one
_LARGEST = 0.1  # step, relative to the gaps
_EXTINCT = 1e-6  # of the first work-rate: wear ends below it, near the free amplitude
_ARRIVED = 1e-9  # in initial gaps
_FIRST = 0.01  # step, in initial gaps
_SAFETY, _GROWTH = 0.9, 3.0
_STAGES = tuple(np.array(row) for row in BOGACKI_SHAMPINE_3.a[1:])
_ERROR = np.array(ERROR_2)


class WornOrbit(NamedTuple):
    """A stable orbit at growing gaps.

    Attributes
    ----------
    gaps : ndarray, shape (p, 2)
        Right and left, in initial gaps.
    time : ndarray, shape (p,)
        Slow time since the first point: forcing periods times the wear per work of a site of share
        1 [X0 per dimensionless work].
    orbits : tuple of Orbit
        One at each.
    events : tuple of Event
        Their `value` is the right gap.
    end : str
        The event at which stability was lost; ``stop`` where a gap reached the value requested;
        ``no-impact`` where contact fades away and wear with it; ``budget`` after `ATTEMPTS` steps.
    """

    gaps: Array
    time: Array
    orbits: tuple[Orbit, ...]
    events: tuple[Event, ...]
    end: str


class _Place(NamedTuple):
    """A place on the path.

    Attributes
    ----------
    at : ndarray, shape (3,)
        Gaps and time.
    state : ndarray, shape (2 m,)
        Of the orbit, at phase 0 of the force.
    motion : Passage
        Over its period.
    rate : float
        ds/dT.
    slope : ndarray, shape (3,)
        d(`at`)/ds.
    """

    at: Array
    state: Array
    motion: Passage
    rate: float
    slope: Array


class _Way:
    """The differential equation, whose right-hand side requires finding an orbit."""

    def __init__(self, beam: Beam, period: int, share: Array):
        self._beam, self._period, self._share = beam, period, share

    def place(self, at: Array, state: Array) -> _Place | None:
        """Return the place at these gaps, with the orbit near a state, None if there is none."""
        gaps, size = at[:2], float(np.linalg.norm(state))
        root = find_root(
            lambda y: defect(passage(self._beam, y, gaps, periods=self._period), y),
            state,
            TOLERANCE * size,
            longest=_NEAR * size,
        )
        if root.outcome != "converged" or np.linalg.norm(root.state - state) > _NEAR * size:
            return None
        rates = root.linear.about.work / self._period * self._share
        rate = float(rates.sum())
        slope = np.append(rates, 1.0) / rate if rate > 0 else np.zeros(3)
        return _Place(at, root.state, root.linear.about, rate, slope)

    def orbit(self, place: _Place) -> Orbit:
        """Return the orbit at a place."""
        return orbit_of(place.motion, place.state, place.at[:2], self._period)

    def step(self, here: _Place, h: float) -> tuple[_Place, Array] | None:
        """Return the place after a step and the error of `at` there, None without an orbit."""
        n = len(here.state)
        linear = here.motion.tangents
        drift = np.linalg.solve(np.eye(n) - linear[:, :n], linear[:, n : n + 2])
        slopes = here.slope[None]
        place = here
        for weights in _STAGES:
            at = here.at + h * (weights @ slopes)
            reached = self.place(at, here.state + drift @ (at - here.at)[:2])
            if reached is None:
                return None
            place = reached
            slopes = np.vstack([slopes, place.slope])
        return place, h * (_ERROR @ slopes)

    def grazing(self, a: _Place, b: _Place) -> Event:
        """Return the grazing between two places."""
        h = float((b.at - a.at)[:2].sum())
        while h > NEARNESS:
            h /= 2
            step = self.step(a, h)
            if step is None:
                break
            a, b = (step[0], b) if _contacts(step[0]) == _contacts(a) else (a, step[0])
        return Event("grazing", float(a.at[RIGHT]), self.orbit(a), self.orbit(b))


def wear_along(beam: Beam, orbit: Orbit, share: Array, stop: float, accuracy: float) -> WornOrbit:
    """Let the gaps grow with the work of a stable orbit, for as long as it exists and is stable.

    Parameters
    ----------
    beam : Beam
    orbit : Orbit
        Stable, at the first gaps.
    share : ndarray, shape (2,)
        Wear coefficient of each site over that of the right site.
    stop : float
        Gap at which the wider site ends the path, in initial gaps.
    accuracy : float
        Error of each step: of the gaps in initial gaps, of the time relative to it.

    Returns
    -------
    WornOrbit

    Raises
    ------
    ValueError
        If there is no such orbit.
    """
    way = _Way(beam, orbit.period, share)
    here = way.place(np.append(orbit.gaps, 0.0), orbit.state)
    if here is None or not orbit.is_stable:
        raise ValueError(f"no stable orbit to follow: the one given is {orbit.outcome}")
    places, orbits, events = [here], [orbit], list[Event]()
    last_rate = _EXTINCT * here.rate
    step, wall, end = _FIRST, np.inf, ""
    for _ in range(ATTEMPTS):
        end = _end(here, stop, last_rate)
        if end:
            break
        room = (stop - here.at[:2]) / np.maximum(here.slope[:2], _ARRIVED)
        step = min(step, _LARGEST * here.at[:2].min(), room.min(), max(wall / 2, NEARNESS))
        stepped = way.step(here, step)
        beyond = None if stepped is None else way.orbit(stepped[0])
        if stepped is None or beyond is None or not beyond.is_stable:
            if step <= NEARNESS:
                events.append(_loss(orbits[-1], beyond))
                end = cause_of_loss(events) or ""
                break
            wall = step
            continue
        following, difference = stepped
        too_far = following.at[:2].max() - stop
        if too_far > _ARRIVED:
            step *= 1 - too_far / (following.at - here.at)[:2].max()
            continue
        error = np.abs(difference / [1.0, 1.0, following.at[2]]).max() / accuracy
        factor = min(_SAFETY * max(error, 1e-3) ** (-1 / 3), _GROWTH)
        if error <= 1:
            if _contacts(here) != _contacts(following):
                events.append(way.grazing(here, following))
            places.append(following)
            orbits.append(beyond)
            here = following
            wall = wall - step if wall > step else np.inf
        step *= factor
    at = np.array([place.at for place in places])
    return WornOrbit(at[:, :2], at[:, 2], tuple(orbits), tuple(events), end or "budget")


def _contacts(place: _Place) -> list[int]:
    """Return the number of contacts at each site."""
    return place.motion.contacts.tolist()


def _end(here: _Place, stop: float, last_rate: float) -> str:
    """Return why wear ends here, empty if it does not."""
    if here.rate <= last_rate:
        return "no-impact"
    return "stop" if stop - here.at[:2].max() < _ARRIVED else ""


def _loss(before: Orbit, beyond: Orbit | None) -> Event:
    """Return the event at which stability is lost: without an orbit beyond, a fold."""
    kind = kind_of(before, before, True) if beyond is None else kind_of(before, beyond, False)
    return Event(kind, float(before.gaps[RIGHT]), before, beyond)
