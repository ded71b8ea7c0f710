"""Inputs of the vibrator that are uncertain unless a study says otherwise, and their laws."""

from collections.abc import Mapping
from typing import Any

# fmt: off
UNCERTAIN: Mapping[str, Mapping[str, Any]] = {
    "synchronous_speed_1": {
        "distribution": "normal", "mean": 157.0, "sd": 0.157,
        "source": "assumed: +-0.2 % as two standard deviations",
    },
    "synchronous_speed_2": {
        "distribution": "normal", "mean": 157.0, "sd": 0.157,
        "source": "assumed: as motor 1",
    },
    "rated_torque_1": {
        "distribution": "normal", "mean": 240.0, "sd": 12.0,
        "source": "assumed: +-10 % as two standard deviations, the scatter of motors of one series",
    },
    "rated_torque_2": {
        "distribution": "normal", "mean": 240.0, "sd": 12.0,
        "source": "assumed: as motor 1",
    },
    "breakdown_speed_1": {
        "distribution": "normal", "mean": 126.0, "sd": 1.26,
        "source": "assumed: +-2 % as two standard deviations, resistance of a warm or cold rotor",
    },
    "breakdown_speed_2": {
        "distribution": "normal", "mean": 126.0, "sd": 1.26,
        "source": "assumed: as motor 1",
    },
    "unbalance_1": {
        "distribution": "normal", "mean": 5.0, "sd": 0.05,
        "source": "from the paper: +-2 % between motors, as two standard deviations",
    },
    "unbalance_2": {
        "distribution": "normal", "mean": 5.0, "sd": 0.05,
        "source": "as vibrator 1",
    },
    "bearing_constant_1": {
        "distribution": "uniform", "lower": 0.0, "upper": 0.0003,
        "source": "assumed: from no friction to a badly greased bearing",
    },
    "bearing_constant_2": {
        "distribution": "uniform", "lower": 0.0, "upper": 0.0003,
        "source": "assumed: as vibrator 1",
    },
    "stiffness_x": {
        "distribution": "normal", "mean": 621000.0, "sd": 46600.0,
        "source": "assumed: +-15 % as two standard deviations, springs of one batch",
    },
    "stiffness_y": {
        "distribution": "normal", "mean": 2070000.0, "sd": 155000.0,
        "source": "assumed: +-15 % as two standard deviations, springs of one batch",
    },
    "support_offset": {
        "distribution": "normal", "mean": -0.4, "sd": 0.01,
        "source": "assumed: +-20 mm as two standard deviations, position of the mass centre",
    },
    "axis_offset": {
        "distribution": "normal", "mean": 0.0, "sd": 0.005,
        "source": "assumed: +-10 mm as two standard deviations, position of the mass centre",
    },
}
# fmt: on
"""Input -> its law in a new study, as in a study file."""
