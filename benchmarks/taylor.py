"""The vibrator by heyoka's Taylor series, eight machines at a time: the best alternative.

The equations of `models.vibrator.equations.rigid`, written to suit it: a product of two series is
expensive and one of a series and a constant is cheap, and all entries of the body's mass matrix are
linear in sin^2 and sin cos of the two angles. Elimination spares it the cofactors. The signum of
the bearing loss is +1, as at any speed that matters.
"""

import heyoka as hy
import numpy as np

BATCH = 8


def _constants(m):
    """Return what the equations need of machines, made once for all, by name."""
    c = {name: getattr(m, name) for name in ("mass", "moment_x", "moment_y", "inertia")}
    c |= {"working_angle": m.working_angle, "offset": m.support_offset}
    for i in "12":
        u, mobility, loss = (
            getattr(m, f"{name}_{i}") for name in ("unbalance", "mobility", "bearing_loss")
        )
        x, y = getattr(m, f"shaft_x_{i}"), getattr(m, f"shaft_y_{i}")
        f, slip = u * u * mobility, getattr(m, f"slip_{i}")
        shaft = {"u": u, "mobility": mobility, "r": u * mobility, "loss": loss, "x": x, "y": y}
        shaft |= {"f": f, "fx": f * x, "fy": f * y, "fxx": f * x * x, "fyy": f * y * y}
        shaft |= {"fxx_yy": f * (y * y - x * x), "fxy2": 2 * f * x * y, "slip2": slip * slip}
        shaft |= {"torque": getattr(m, f"torque_{i}"), "top": getattr(m, f"synchronous_speed_{i}")}
        c |= {name + i: value for name, value in shaft.items()}
    for kind in ("stiffness", "damping"):
        along_x, along_y = getattr(m, f"{kind}_x"), getattr(m, f"{kind}_y")
        c |= {f"{kind}_x": along_x, f"{kind}_y": along_y}
        c[f"{kind}_a"] = along_y * m.half_spacing**2
    return c


def _equations(names):
    """Return the equations of motion with the named constants as parameters."""
    p = {name: hy.par[i] for i, name in enumerate(names)}
    state = hy.make_vars("x", "y", "a", "psi_1", "psi_2", "vx", "vy", "va", "w_1", "w_2")
    x, y, a, psi_1, psi_2, vx, vy, va, w_1, w_2 = state
    xx, xy, xa = p["mass"], 0.0, -p["moment_y"]
    yy, ya, aa = p["mass"], p["moment_x"], p["inertia"]
    lean, lean_rate = x + p["offset"] * a, vx + p["offset"] * va
    spring = p["stiffness_x"] * lean + p["damping_x"] * lean_rate
    force_x, force_y = -spring, -(p["stiffness_y"] * y + p["damping_y"] * vy)
    force_a = -(p["stiffness_a"] * a + p["damping_a"] * va + p["offset"] * spring)
    rotors = []
    for i, sign, angle, w in (("1", 1.0, psi_1, w_1), ("2", -1.0, psi_2, w_2)):
        o = {name: p[name + i] for name in ("u", "mobility", "r", "loss", "x", "y")}
        theta = p["working_angle"] + sign * angle
        cosine, sine = hy.cos(theta), hy.sin(theta)
        s2, sc = sine * sine, sine * cosine
        xx -= p["f" + i] * s2
        xy += p["f" + i] * sc
        xa += p["fx" + i] * sc + p["fy" + i] * s2
        yy -= p["f" + i] - p["f" + i] * s2
        ya -= p["fx" + i] - p["fx" + i] * s2 + p["fy" + i] * sc
        aa -= p["fxx" + i] + p["fxx_yy" + i] * s2 + p["fxy2" + i] * sc
        w2, lag = w * w, p["top" + i] - w
        torque = p["torque" + i] * lag / (p["slip2" + i] + lag * lag) - o["loss"] * w2
        radial, across = o["u"] * w2, sign * o["r"] * torque
        along_x = radial * cosine + across * sine
        along_y = radial * sine - across * cosine
        force_x += along_x
        force_y += along_y
        force_a += o["x"] * along_y - o["y"] * along_x
        rotors.append((o, sign, cosine, sine, torque))
    # Elimination in the symmetric system of the body.
    l_y, l_a = xy / xx, xa / xx
    d_y, rest = yy - l_y * xy, ya - l_y * xa
    m_a = rest / d_y
    right_y = force_y - l_y * force_x
    right_a = force_a - l_a * force_x - m_a * right_y
    acc_a = right_a / (aa - l_a * xa - m_a * rest)
    acc_y = right_y / d_y - m_a * acc_a
    acc_x = force_x / xx - l_y * acc_y - l_a * acc_a
    turns = [
        o["mobility"] * torque
        - sign * o["r"] * (c * (acc_y + o["x"] * acc_a) - s * (acc_x - o["y"] * acc_a))
        for o, sign, c, s, torque in rotors
    ]
    return list(zip(state, [vx, vy, va, w_1, w_2, acc_x, acc_y, acc_a, *turns], strict=True))


class Taylor:
    """Series to one tolerance, compiled for it."""

    def __init__(self, system, tolerance):
        constants = _constants(system)
        self.parameters = np.array(list(constants.values()))
        self.integrator = hy.taylor_adaptive_batch(
            _equations(list(constants)),
            np.zeros((10, BATCH)),
            tol=tolerance,
            pars=np.zeros((len(constants), BATCH)),
            fast_math=True,
        )

    def advance(self, state, duration):
        """Return the states, shape (n, 10), of n machines (a multiple of 8) after some time."""
        end, ta = np.empty_like(state), self.integrator
        for first in range(0, len(state), BATCH):
            batch = slice(first, first + BATCH)
            ta.set_time(0.0)
            ta.state[:] = state[batch].T
            ta.pars[:] = self.parameters[:, batch]
            ta.propagate_until(duration)
            end[batch] = ta.state.T
        return end
