"""The last excursion out of the band and the largest displacement, located and not sampled.

Three machines whose references come from an independent integration at 1e-12.
"""

import numpy as np
import pytest

from models.vibrator.batch import batch
from models.vibrator.parameters import Params, Settings
from uq.contract import Status

# A last swing leaves the band between two samples of either propagator.
RETURNING = Params(
    body_mass=2320.9840106156225,
    body_inertia=1964.5558425849715,
    unbalanced_mass=117.66154748979054,
    unbalance_1=3.8779499332446936,
    unbalance_2=3.9035704447268293,
    rotor_inertia=0.44048099283187603,
    support_half_spacing=1.1226069124803462,
    working_angle=0.40265688533577987,
    shaft_half_angle=0.17543624425318743,
    shaft_distance=0.9975319837625446,
    axis_offset=0.0,
    rated_torque_1=209.59252754271068,
    rated_torque_2=225.68392848370246,
    overload_capacity=3.0222927503904105,
    synchronous_speed_1=156.74668846679387,
    synchronous_speed_2=157.25331153320613,
    breakdown_speed_1=125.79670539373267,
    breakdown_speed_2=126.20329460626733,
    bearing_constant_1=8.786186125117014e-05,
    bearing_constant_2=5.3978263783566534e-05,
    stiffness_x=741031.3642350057,
    stiffness_y=2641643.304150887,
    damping_ratio=0.010130517755727701,
    support_offset=-0.22583244312554135,
    initial_phase_1=0.060126841519924756,
    initial_phase_2=-0.2016956195458679,
)
# The same between two steps of the lanes.
LATE = Params(
    body_mass=1668.0800087652808,
    body_inertia=3198.5591690297542,
    unbalanced_mass=108.24464120054425,
    unbalance_1=4.425654715329248,
    unbalance_2=4.425654715329248,
    rotor_inertia=0.4867841602677442,
    support_half_spacing=1.208158520555426,
    working_angle=1.1097263309935672,
    shaft_half_angle=1.2136499524084914,
    shaft_distance=0.7748170349777407,
    axis_offset=0.3117025554210707,
    rated_torque_1=242.35619114624782,
    rated_torque_2=242.35619114624782,
    overload_capacity=2.7138890632836867,
    synchronous_speed_1=157.0,
    synchronous_speed_2=157.0,
    breakdown_speed_1=126.0,
    breakdown_speed_2=126.0,
    bearing_constant_1=9.296652457896095e-05,
    bearing_constant_2=9.296652457896095e-05,
    stiffness_x=715332.5979057332,
    stiffness_y=1926101.3116284953,
    damping_ratio=0.00837260426767751,
    support_offset=0.3236219318395701,
    initial_phase_1=0.0,
    initial_phase_2=0.0,
)
# Springs so soft that the body swings furthest a second after the motors have locked.
RINGING = Params(
    body_mass=2009.3291190810464,
    body_inertia=2386.039978571084,
    unbalanced_mass=120.55532768667969,
    unbalance_1=5.196139921193618,
    unbalance_2=5.356526880125194,
    rotor_inertia=0.3692954581201573,
    support_half_spacing=1.2908381847316404,
    working_angle=0.4778729007385796,
    shaft_half_angle=0.2536009720965425,
    shaft_distance=0.912619981375088,
    axis_offset=0.0,
    rated_torque_1=220.78156977106903,
    rated_torque_2=232.70674211713768,
    overload_capacity=2.65436483053731,
    synchronous_speed_1=156.98027024628735,
    synchronous_speed_2=157.01972975371265,
    breakdown_speed_1=125.98416593014144,
    breakdown_speed_2=126.01583406985856,
    bearing_constant_1=6.8154456683677e-05,
    bearing_constant_2=0.00010370518405681673,
    stiffness_x=176808.0782174866,
    stiffness_y=169542.86029217546,
    damping_ratio=0.009730781462162347,
    support_offset=-0.19496804820434077,
    initial_phase_1=2.5165962225553375,
    initial_phase_2=2.676692099883452,
)
REFERENCE = {
    "synchronisation_time": [0.8037947, 1.5075412, 0.5267988],
    "max_excursion": [0.00752458, 0.0135031, 0.00818797],
}


def switched_on(**settings):
    x = np.array([RETURNING, LATE, RINGING])
    outputs, status = batch(x, np.zeros(3, np.uint64), Settings(**settings))
    assert (status == Status.OK).all()
    return outputs


@pytest.mark.parametrize(
    ("settings", "seconds", "share"),
    [({}, 2e-5, 3e-4), ({"steps_per_turn": 24}, 5e-6, 1e-4), ({"propagator": "exact"}, 1e-6, 2e-5)],
)
def test_start_up_is_that_of_the_reference(settings, seconds, share):
    outputs = switched_on(**settings)
    for name, limits in (
        ("synchronisation_time", {"rtol": 0, "atol": seconds}),
        ("max_excursion", {"rtol": share, "atol": 0}),
    ):
        np.testing.assert_allclose(outputs[name], REFERENCE[name], **limits, err_msg=name)
