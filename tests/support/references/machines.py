"""Vibrators for the tests, and a slow twin of the averaged theory built from point masses."""

from typing import NamedTuple, get_type_hints

import numpy as np

from models.vibrator.parameters import Params

SYMMETRIC = Params(stiffness_x=2.07e6, support_offset=0.0)
NEUTRAL = (
    "gravity", "voltage_factor", "support_imbalance", "ramp_time", "torque_lag",
    "ageing_time_1", "ageing_time_2",
    "ageing_exponent", "support_hardening", "spring_life", "spring_shape",
)  # fmt: skip
UNDAMPED = SYMMETRIC._replace(damping_ratio=0.0, bearing_constant_1=0.0, bearing_constant_2=0.0)


def at(p, i):
    """Return one of several machines, its fields floats."""
    return Params._make(float(field[i]) for field in p)


def plausible(rows, seed, **fixed):
    """Return machines off nominal in every parameter not `NEUTRAL`, on mounts and with feed."""
    rng = np.random.default_rng(seed)
    nominal = Params()._asdict()
    neutral = {name: np.full(rows, nominal.pop(name)) for name in NEUTRAL}
    p = Params(
        **{name: value * rng.uniform(0.8, 1.25, rows) for name, value in nominal.items()},
        **neutral,
    )
    between = {
        "working_angle": (-np.pi, np.pi),
        "axis_offset": (-0.4, 0.4),
        "damping_ratio": (0.0, 0.2),
        "support_offset": (-0.8, 0.8),
        "synchronous_speed_1": (155.0, 157.0),
        "synchronous_speed_2": (155.0, 157.0),
        "breakdown_speed_1": (120.0, 130.0),
        "breakdown_speed_2": (120.0, 130.0),
        "mount_stiffness": (2e7, 2e8),
        "mount_angle": (-np.pi, np.pi),
        "mount_mass": (0.0, 300.0),
        "mount_damping_ratio": (0.0, 0.1),
        "mount_rotational_stiffness": (6e6, 3e7),
        "mount_inertia": (0.0, 20.0),
        "feed_mass": (0.0, 200.0),
        "throw_coefficient": (0.2, 1.0),
        "feed_position": (-1.0, 1.0),
    }
    p = p._replace(**{name: rng.uniform(*ends, rows) for name, ends in between.items()})
    return p._replace(**{name: np.full(rows, value) for name, value in fixed.items()})


def over_the_bounds(rows, seed):
    """Return machines anywhere within the declared bounds, a tenth of the values at an end."""
    rng = np.random.default_rng(seed)
    columns = []
    for hint in get_type_hints(Params, include_extras=True).values():
        low, high = hint.__metadata__[0].bounds
        u = rng.random(rows)
        if high == np.inf:
            column = np.where(u < 0.5, np.inf, low * 1e6**u)
        else:
            column = low * (high / low) ** u if low > 0 else low + (high - low) * u
        end = rng.random(rows)
        columns.append(np.where(end < 0.05, low, np.where(end > 0.95, high, column)))
    return Params._make(columns)


class Twin(NamedTuple):
    """Synchronous running of one machine at a given speed and dphi, from samples of one period."""

    moments: tuple[float, float]
    amplitudes: np.ndarray  # of x, y, alpha, slide, turn by e^(j psi_1)
    loss: float  # mean power of all dampers


def twin(p, w, dphi, instants=64):
    """Solve one machine, feed riding, as point masses on springs; average what its shafts feel."""
    c, s = np.cos(p.working_angle), np.sin(p.working_angle)
    turned = np.array([[c, -s], [s, c]])
    along = p.shaft_distance * np.cos(p.shaft_half_angle)
    half = p.shaft_distance * np.sin(p.shaft_half_angle)
    centre = turned @ [along, p.axis_offset]
    shafts = [turned @ [along, p.axis_offset + side * half] for side in (1, -1)]
    u = [np.cos(p.working_angle + p.mount_angle), np.sin(p.working_angle + p.mount_angle)]

    def body(point):  # displacement of a point of the body per x, y, alpha, slide, turn
        return np.array([[1, 0, -point[1], 0, 0], [0, 1, point[0], 0, 0]])

    def carried(point):  # of a point of the motor set
        moved = body(point)
        moved[:, 3] = u
        moved[:, 4] = [-(point - centre)[1], (point - centre)[0]]
        return moved

    body_turn, set_turn = np.array([[0, 0, 1, 0, 0]]), np.array([[0, 0, 1, 0, 1]])
    slide, turn = np.eye(5)[3:4], np.eye(5)[4:5]
    left = body(np.array([-p.support_half_spacing, -p.support_offset]))
    right = body(np.array([p.support_half_spacing, -p.support_offset]))
    feed = body(np.array([p.feed_position, 0.0]))[1:]
    inertial = [
        (p.body_mass, body(np.zeros(2))),
        (p.body_inertia, body_turn),
        (p.mount_mass, carried(centre)),
        (p.mount_inertia, set_turn),
        (p.feed_mass, feed),
    ]
    inertial += [(p.unbalanced_mass, carried(shaft)) for shaft in shafts]
    mass = sum(m * j.T @ j for m, j in inertial)
    sprung = p.body_mass + 2 * p.unbalanced_mass
    set_mass = p.mount_mass + 2 * p.unbalanced_mass
    set_inertia = p.mount_inertia + 2 * p.unbalanced_mass * half**2
    shares = (1 - p.support_imbalance) / 2, (1 + p.support_imbalance) / 2
    elastic = [
        (p.stiffness_x * shares[0], p.damping_ratio, sprung * shares[0], left[:1]),
        (p.stiffness_x * shares[1], p.damping_ratio, sprung * shares[1], right[:1]),
        (p.stiffness_y * shares[0], p.damping_ratio, sprung * shares[0], left[1:]),
        (p.stiffness_y * shares[1], p.damping_ratio, sprung * shares[1], right[1:]),
        (p.mount_stiffness, p.mount_damping_ratio, set_mass, slide),
        (p.mount_rotational_stiffness, p.mount_damping_ratio, set_inertia, turn),
    ]
    free = [True, True, True, p.mount_stiffness < np.inf, p.mount_rotational_stiffness < np.inf]
    elastic = [term for term in elastic if term[0] < np.inf]
    stiffness = sum(k * j.T @ j for k, _, _, j in elastic)
    damping = sum(2 * z * np.sqrt(k * m) * j.T @ j for k, z, m, j in elastic)

    t = 2 * np.pi / w * np.arange(instants) / instants
    angles = [p.working_angle + w * t, p.working_angle - (w * t - dphi)]
    directions = [np.array([np.cos(angle), np.sin(angle)]) for angle in angles]
    unbalances = (p.unbalance_1, p.unbalance_2)
    levers = [carried(shaft) for shaft in shafts]
    force = sum(
        j.T @ (me * w**2 * n) for j, me, n in zip(levers, unbalances, directions, strict=True)
    )
    phasor = 2 * np.mean(force * np.exp(-1j * w * t), axis=1)
    q = np.zeros(5, complex)
    dynamic = stiffness - w**2 * mass + 1j * w * damping
    q[free] = np.linalg.solve(dynamic[np.ix_(free, free)], phasor[free])
    wave = q[:, None] * np.exp(1j * w * t)
    velocity, acceleration = (1j * w * wave).real, (-(w**2) * wave).real
    moments = []
    for sense, j, me, n in zip((1, -1), levers, unbalances, directions, strict=True):
        a = j @ acceleration
        moments.append(float(np.mean(-sense * me * (n[0] * a[1] - n[1] * a[0]))))
    loss = float(np.mean(np.sum(velocity * (damping @ velocity), axis=0)))
    return Twin((moments[0], moments[1]), q, loss)


def net_torques(p, w):
    """Return motor torque less bearing torque of both vibrators, and the motor torques."""
    net, motor = [], []
    for i in ("1", "2"):
        get = dict(zip(Params._fields, p, strict=True))
        synchronous, breakdown = get["synchronous_speed_" + i], get["breakdown_speed_" + i]
        slip, behind = synchronous - breakdown, synchronous - w
        breakdown = p.overload_capacity * get["rated_torque_" + i] * get["voltage_factor"] ** 2
        torque = breakdown * 2 / (slip / behind + behind / slip)
        motor.append(torque)
        net.append(torque - get["bearing_constant_" + i] * get["unbalance_" + i] * w**2)
    return net, motor
