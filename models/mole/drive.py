"""Slow time: how far a mole has driven, and how warm its coil is, from mean rates along the way.

A mole at the place z with a coil warmer by theta has a settled response, with the mean velocity v
and the mean power P = R <i^2> of the heat in the coil:

    dz/dt = v(z, theta),  C_th dtheta/dt = P(z, theta) - theta/R_th,
    mu_2 = mu_20 + mu_2' z,  R = R_20 (1 + 0.0039 theta)

Both rates are computed at ten places or more and as many temperatures, each from the state of the
mole at the one before. Between these, v is linear in z, and dtheta/dt in theta, so that the time
from one to the next is that over the logarithmic mean of the rates at both ends. Where v reaches
zero, the mole is refused, and never arrives. Beyond the last distance friction grows no more.
"""

import math
from collections.abc import Callable, Generator
from functools import partial
from operator import itemgetter
from typing import NamedTuple

from models.numerics.course import NEVER, OPEN, REACHED, SURE, Course, elapsed, mean_rate

NODES = 10
"""Steps over the last distance, and over the rise of the temperature, at least."""

COPPER = 0.0039  # K-1, of the resistance at 20 degrees Celsius

_MOST = 400  # responses of a mole
_WHOLE = 1 - 1e-9  # of a step: the rest is rounding error


class Rates(NamedTuple):
    """Mean velocity [m s-1] and power in the coil [W], and their standard errors; NaN if lost."""

    speed: float
    speed_error: float
    power: float
    power_error: float


class Task(NamedTuple):
    """What one mole is to do.

    Attributes
    ----------
    distances, temperatures : tuple of float
        Ascending [m], [K].
    changing : float
        Distance over which the ground changes [m]; 0 if it does not.
    thermal_resistance, thermal_capacity : float
        R_th [K W-1], C_th [J K-1].
    blow : float
        Time from blow to blow [s]: where the mole is within it is not known.
    """

    distances: tuple[float, ...]
    temperatures: tuple[float, ...]
    changing: float
    thermal_resistance: float
    thermal_capacity: float
    blow: float = 0.0


class Drive(NamedTuple):
    """How one mole drove.

    Attributes
    ----------
    distance, temperature : Course
    warmths, speeds : list of float
        Temperature rise [K] and velocity [m s-1] where each temperature is reached, or in the end.
    warmth_errors, speed_errors : list of float
        By the mean rates, in the sense of 90 % intervals, and by what is linear between them.
    lost : bool
        Whether a response on the way could not be computed.
    cold_speed : float
        Velocity with a cold coil where the mole is held [m s-1]; NaN if it is not held, or lost.
    """

    distance: Course
    temperature: Course
    warmths: list[float]
    speeds: list[float]
    warmth_errors: list[float]
    speed_errors: list[float]
    lost: bool
    cold_speed: float


class _Follower:
    """The slow time of one mole: both coordinates, and the time reached."""

    def __init__(self, task: Task) -> None:
        self.task, self.now = task, 0.0
        self.way, self.warmth = Course(task.distances), Course(task.temperatures)
        self.warmths = [math.nan] * len(task.temperatures)
        self.speeds = self.warmths.copy()
        self.nodes: list[tuple[float, Rates]] = []  # temperatures, and rates there
        self.settled = 0.0, 0.0  # errors of temperature and velocity in the end

    def heating(self, rates: Rates, theta: float) -> float:
        """Return dtheta/dt [K s-1]."""
        lost = theta / self.task.thermal_resistance
        return (rates.power - lost) / self.task.thermal_capacity

    def warm(
        self, span: float, end: float, a: Rates, b: Rates, when: Callable[[float], float]
    ) -> None:
        """Let the coil warm."""
        begin = self.warmth.here
        self.note(begin, a)
        self.note(end, b)
        ends = self.heating(a, begin), self.heating(b, end)
        errors = tuple(r.power_error / self.task.thermal_capacity for r in (a, b))
        for i in self.warmth.step(end, self.now, span, ends, (errors[0], errors[1]), when):
            share = (self.task.temperatures[i] - begin) / (end - begin)
            self.warmths[i] = self.task.temperatures[i]
            self.speeds[i] = a.speed + share * (b.speed - a.speed)

    def note(self, theta: float, rates: Rates) -> None:
        """Keep rates at a temperature, unless they are the last ones kept."""
        if not self.nodes or self.nodes[-1][0] != theta:
            self.nodes.append((theta, rates))

    def bent(self, theta: float) -> tuple[float, float]:
        """Return the errors of velocity and power linear between nodes, at a temperature.

        They follow from the largest second divided difference beside it; without any, they are a
        quarter of the change.
        """
        places = [place for place, _ in self.nodes]
        last = len(places) - 2
        here = next((i for i in range(last + 1) if places[i] <= theta <= places[i + 1]), last)
        if here < 0:
            return 0.0, 0.0
        left, right = places[here], places[here + 1]
        room = max((theta - left) * (right - theta), 0.0)
        errors = []
        for field in (0, 2):
            values = [rates[field] for _, rates in self.nodes]
            slopes = [
                (values[i + 1] - values[i]) / (places[i + 1] - places[i]) for i in range(last + 1)
            ]
            bends = [
                abs((slopes[i + 1] - slopes[i]) / (places[i + 2] - places[i]))
                for i in (here - 1, here)
                if 0 <= i < last and places[i + 2] != places[i]
            ]
            flat = abs(slopes[here] / (right - left))  # of a quarter of the change in the middle
            errors.append(room * max(bends, default=flat))
        return errors[0], errors[1]

    def errors(self) -> tuple[list[float], list[float]]:
        """Return the errors of the temperatures, and of the velocities there."""
        warmths, speeds = [], []
        for theta, fate in zip(self.warmths, self.warmth.fates, strict=True):
            if fate != REACHED:
                is_settled = fate == NEVER
                warmths.append(self.settled[0] if is_settled else math.nan)
                speeds.append(self.settled[1] if is_settled else math.nan)
                continue
            below = max((n for n in self.nodes if n[0] <= theta), key=itemgetter(0))
            above = min((n for n in self.nodes if n[0] >= theta), key=itemgetter(0))
            length = above[0] - below[0]
            share = (theta - below[0]) / length if length else 0.0
            spread = math.hypot((1 - share) * below[1].speed_error, share * above[1].speed_error)
            warmths.append(0.0)
            speeds.append(self.bent(theta)[0] + SURE * spread)
        return warmths, speeds

    def go(self, span: float, end: float, a: Rates, b: Rates) -> None:
        """Let the mole drive, its velocity linear in the place."""
        length = end - self.way.here
        if self.task.changing > 0:
            # The ground changes by half an advance while the mole is driven by a whole one.
            self.way.blur(0.5 * self.task.blow * abs(math.log(b.speed / a.speed)))
        self.way.step(
            end,
            self.now,
            span,
            (a.speed, b.speed),
            (a.speed_error, b.speed_error),
            lambda part: elapsed(part, length, a.speed, b.speed),
        )

    def refuse(self, stride: float, a: Rates, b: Rates) -> None:
        """Let the mole drive to where its velocity, linear in the place, falls to zero."""
        if abs(b.speed) < SURE * b.speed_error:
            self.way.decide(OPEN, self.now)  # whether it is zero is not known
            return
        start = self.way.here
        root = start + stride * a.speed / (a.speed - b.speed)
        reach = max((d for d in self.task.distances if start < d < root), default=start)
        if reach > start:
            share = (reach - start) / stride
            end = b._replace(speed=a.speed + share * (b.speed - a.speed))
            self.go(elapsed(reach - start, stride, a.speed, b.speed), reach, a, end)
        self.way.decide(NEVER, self.now)
        self.way.here = root

    def settle(self, rates: Rates) -> None:
        """Let the mole drive on at constant rates, with a coil that warms no more."""
        self.warmth.decide(NEVER, self.now)
        self.settled = 0.0, SURE * rates.speed_error
        if self.way.pending:
            self._drive_on(rates, rates, lambda time: rates.speed * time)

    def balance(self, a: Rates, b: Rates, end: float) -> Rates:
        """Let the coil settle where rates, linear from here to `end`, keep it; return those there.

        The mole drives to all distances that it reaches.
        """
        theta = self.warmth.here
        first, last = self.heating(a, theta), self.heating(b, end)
        share = first / (first - last) if first * (first - last) > 0 else 0.0
        rise = share * (end - theta)
        rate = first / rise if rise else 1.0
        settled = Rates(
            a.speed + share * (b.speed - a.speed),
            max(a.speed_error, b.speed_error),
            a.power + share * (b.power - a.power),
            max(a.power_error, b.power_error),
        )

        def when(part: float) -> float:
            return -math.log1p(-part / rise) / rate

        def place(time: float) -> float:
            slower = (a.speed - settled.speed) / rate if rise else 0.0
            return settled.speed * time - slower * math.expm1(-rate * time)

        limit = theta + rise * _WHOLE
        reach = max((t for t in self.task.temperatures if theta < t < limit), default=theta)
        if reach > theta:
            self.warm(when(reach - theta), reach, a, settled, when)
        self.warmth.decide(NEVER, self.now)
        self.warmth.here = theta + rise
        self.note(theta, a)
        self.note(end, b)
        slower, weaker = self.bent(theta + rise)
        turn = abs(first - last) / abs(end - theta) if end != theta else 0.0  # [s-1]
        unsure = (weaker + SURE * settled.power_error) / self.task.thermal_capacity
        off = unsure / turn if turn else 0.0
        slope = abs((b.speed - a.speed) / (end - theta)) if end != theta else 0.0
        self.settled = off, slower + SURE * settled.speed_error + slope * off
        if self.way.pending:
            self._drive_on(a, settled, place)
        return settled

    def _drive_on(self, a: Rates, settled: Rates, place: Callable[[float], float]) -> None:
        start = self.way.here
        times = {
            self.task.distances[i] - start: _first(place, self.task.distances[i] - start, settled)
            for i in self.way.pending
        }
        reached = [part for part, time in times.items() if time < math.inf]
        if reached:
            way = max(reached)
            ends = (a.speed, settled.speed)
            # The rate hardly changes: its error is the same at both ends.
            errors = (2 * max(a.speed_error, settled.speed_error), 0.0)
            self.way.step(start + way, self.now, times[way], ends, errors, times.__getitem__)
        self.way.decide(NEVER, self.now)


def _first(place: Callable[[float], float], way: float, settled: Rates) -> float:
    """Return the time at which a mole that approaches a constant velocity has driven a way."""
    if not settled.speed > 0:
        return math.inf
    low, high = 0.0, way / settled.speed
    if place(high) == way:
        return high
    while place(high) < way:
        high *= 2
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if place(middle) < way else (low, middle)
    return high


def _relaxing(gap: float, constant: float) -> Callable[[float], float]:
    return lambda part: -constant * math.log1p(-part / gap)


def drive(task: Task) -> Generator[tuple[float, float], Rates, Drive]:
    """Follow one mole in slow time.

    Yields
    ------
    tuple of float
        Place z [m], at most `Task.changing`, and temperature rise [K] at which `Rates` are needed:
        send them.

    Returns
    -------
    Drive
    """
    f = _Follower(task)
    way, warmth = f.way, f.warmth
    is_heated = task.thermal_resistance > 0
    constant = task.thermal_resistance * task.thermal_capacity  # [s]
    cold = here = yield 0.0, 0.0
    most, asked = here.power * task.thermal_resistance, 1
    if task.temperatures:
        most = min(most, task.temperatures[-1])
    while way.pending or warmth.pending:
        if math.isnan(here.speed + here.power) or asked > _MOST:
            way.decide(OPEN, f.now)
            warmth.decide(OPEN, f.now)
            break
        if way.pending and not here.speed > SURE * here.speed_error:
            is_unsure = abs(here.speed) < SURE * here.speed_error
            way.decide(OPEN if is_unsure else NEVER, f.now)
        moves = bool(way.pending)
        changes = moves and way.here < task.changing
        theta = warmth.here
        if not is_heated and not changes:
            f.settle(here)
            break
        target = task.thermal_resistance * here.power
        rise = target - theta
        stride = way.stride(task.changing / NODES, here.speed) if changes else 0.0
        stride = min(stride, task.changing - way.here)
        by_way = stride / here.speed if changes else math.inf
        by_heat = math.inf
        if is_heated and abs(rise) > most / NODES:
            by_heat = -constant * math.log1p(-most / NODES / abs(rise))
        asked += 1
        place = min(way.here, task.changing)
        if changes and by_way <= by_heat:
            end = way.here + stride
            end = task.changing if end >= task.changing * _WHOLE else end
            stride = end - way.here
            guess = target - rise * math.exp(-by_way / constant) if is_heated else 0.0
            last = yield end, guess
            if math.isnan(last.speed + last.power):
                here = last
                continue
            if not last.speed > 0:
                f.refuse(stride, here, last)
                here = last._replace(speed=0.0, speed_error=0.0)
                continue
            span = elapsed(stride, stride, here.speed, last.speed)
            if is_heated:
                level = task.thermal_resistance * 0.5 * (here.power + last.power)
                gap = level - theta
                ended = level - gap * math.exp(-span / constant)
                if guess != theta:
                    turn = (last.speed / here.speed - 1) * (ended - guess) / (guess - theta)
                    way.blur(0.5 * span * abs(turn))
                if ended != theta:
                    f.warm(span, ended, here, last, _relaxing(gap, constant))
            f.go(span, end, here, last)
        elif by_heat < math.inf:
            ended = theta + math.copysign(most / NODES, rise)
            moved = way.here + here.speed * by_heat if moves else way.here
            last = yield min(moved, task.changing), ended
            if math.isnan(last.speed + last.power):
                here = last
                continue
            first, second = f.heating(here, theta), f.heating(last, ended)
            if first * second <= 0 and not changes:  # the balance is between
                here = f.balance(here, last, ended)
                break
            span, length = by_heat, abs(ended - theta)
            if first * second > 0:
                span = elapsed(length, length, abs(first), abs(second))
            ends = abs(first), abs(second)
            f.warm(
                span,
                ended,
                here,
                last,
                partial(elapsed, length=length, first=ends[0], last=ends[1]),
            )
            if moves and last.speed > 0:
                f.go(span, way.here + span * mean_rate(here.speed, last.speed), here, last)
        else:
            last = yield place, target
            if math.isnan(last.speed + last.power):
                here = last
                continue
            here = f.balance(here, last, target)
            break
        f.now += span
        here = last
    for i in range(len(f.warmths)):
        if warmth.fates[i] == NEVER:
            f.warmths[i], f.speeds[i] = warmth.here, here.speed
    is_lost = math.isnan(here.speed + here.power) or asked > _MOST
    warmth_errors, speed_errors = f.errors()
    cold_speed = math.nan
    if NEVER in way.fates:
        if is_heated and task.changing > 0:
            cold = yield min(way.here, task.changing), 0.0
        cold_speed = cold.speed if is_heated else 0.0
    return Drive(way, warmth, f.warmths, f.speeds, warmth_errors, speed_errors, is_lost, cold_speed)
