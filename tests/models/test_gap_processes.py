"""What moves a gap beside wear, laws of wear and duty, in the model of one gap."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.beam import parameters as beam
from models.gap_wear import declarations as gap_wear
from models.gap_wear.batch import batch
from models.gap_wear.declarations import GapWearParameters, GapWearSettings
from models.numerics.duty import ORDERS
from models.numerics.scars import SCARS, scar, scar_volume
from models.numerics.wear_laws.laws import ARCHARD, LAWS
from uq.contract import Status

YEAR = 31_557_600.0
S, K, U = 4.4e-5, 1e-14, 5e-3
RATE = K * U / S  # of the nominal gap's growth


def table(**entries):
    return tuple(entries.items())


def lives(rows=None, settings=None, depth=None, growth=None, **values):
    """Return the outputs of rows, or of the nominal row with other values."""
    rows = [GapWearParameters()._replace(**values)] if rows is None else rows
    settings = GapWearSettings() if settings is None else settings
    if depth is not None:
        settings = replace(settings, depths=(depth,))
    if growth is not None:
        settings = replace(settings, growths=(growth,))
    outputs, status, _ = batch(np.array(rows), np.zeros(len(rows), np.uint64), settings)
    assert not status.any()
    return outputs


def life(settings=None, output="time_to_depth", **values):
    return lives(settings=settings, **values)[output].item()


def test_swelling_closes_a_gap_for_good():
    """X = X_0 + r t - s (t - t_s) closes at t = (X_0 + s t_s)/(s - r)."""
    swelling, start = 3 * RATE, 1e7
    closed = (1e-4 + swelling * start) / (swelling - RATE)
    values = {"swelling_rate": swelling, "swelling_start": start}
    assert life(**values, depth=0.999 * RATE * closed) == pytest.approx(0.999 * closed, rel=1e-12)
    assert life(**values, depth=1.001 * RATE * closed) == np.inf
    settings = GapWearSettings(instants=(start, 2 * closed))
    out = lives(settings=settings, **values)
    expected = [RATE * start, RATE * closed]
    np.testing.assert_allclose(out["worn_depth"][0], expected, rtol=1e-6)
    gaps = [1e-4 + RATE * start, 1e-4 + RATE * closed - swelling * (2 * closed - start)]
    np.testing.assert_allclose(out["gap"][0], gaps, rtol=1e-6)
    assert out["wear_share"][0, 0] == pytest.approx(1, rel=1e-6)
    assert math.isnan(out["wear_share"][0, 1])  # the gap has not grown


def test_a_preloaded_gap_that_swells_may_open_for_a_while():
    """C_c (1 - exp(-t/tau)) - s t exceeds delta_0 between two times at most."""
    p = GapWearParameters(preload_deflection=2e-5, creep_down=6e-5, swelling_rate=2e-13)

    def gap(t):
        return -2e-5 - 6e-5 * math.expm1(-t / p.creep_time) - 2e-13 * t

    opened = life(rows=[p], output="time_to_opening")
    assert opened > 0 and abs(gap(opened)) < 1e-17
    assert gap(0.999 * opened) < 0 < gap(1.001 * opened)
    unworn = p._replace(work_rate=0.0)  # grows by 3.3e-5 in between
    grown = life(rows=[unworn], growth=3e-5, output="time_to_gap_growth")
    assert gap(grown) == pytest.approx(1e-5, rel=1e-9) and gap(1.01 * grown) > gap(grown)
    assert life(rows=[p._replace(swelling_rate=1e-11)], output="time_to_opening") == np.inf


def test_a_history_of_the_gap_moves_it_by_a_factor():
    history = ((0.0, 0.0), (1e7, 3e-5), (2e7, -1e-5), (5e7, 4e-5))
    settings = GapWearSettings(gap_history=history, instants=(5e6, 1.5e7, 4e7, 8e7))
    values = {"gap_history_factor": 2.0, "work_rate": 0.0}
    out = lives(settings=settings, **values)
    expected = 1e-4 + 2 * np.interp(settings.instants, *np.array(history).T)
    np.testing.assert_allclose(out["gap"][0], expected, rtol=1e-12)
    times = [
        lives(settings=settings, **values, growth=growth)["time_to_gap_growth"][0, 0]
        for growth in (2e-5, 6.1e-5, 7.9e-5, 8.1e-5)
    ]
    np.testing.assert_allclose(times[0], 1e7 / 3, rtol=1e-12)
    np.testing.assert_allclose(times[1:3], 2e7 + 3e7 * (np.array([6.1, 7.9]) + 2) / 10, rtol=1e-12)
    assert times[3] == np.inf
    preloaded = {"preload_deflection": 5e-5}
    opened = lives(settings=settings, **values, **preloaded)["time_to_opening"][0]
    assert opened == pytest.approx(1e7 * 5 / 6, rel=1e-12)


def with_law(name, *, accuracy=1e-4, instants=(), **numbers):
    return GapWearSettings(
        wear_law=name, wear_law_numbers=table(**numbers), accuracy=accuracy, instants=instants
    )


def test_a_power_of_the_work_rate_above_a_threshold():
    settings = with_law("power", exponent=1.7, threshold=2e-3)
    known_time = S * 4.36e-4 / (K * (U - 2e-3) ** 1.7)
    assert life(settings) == pytest.approx(known_time, rel=1e-12)
    assert life(with_law("power", threshold=2 * U)) == np.inf
    assert life(with_law("power")) == pytest.approx(life(), rel=1e-14)


def test_wear_begins_where_the_work_rate_exceeds_its_threshold():
    """U = U_0 (X/X_r)^2 > x_th only above X = sqrt(x_th/U_0) X_r, which creep reaches."""
    settings = with_law("power", threshold=1.21 * U, instants=(1e7, 3e7))
    p = GapWearParameters(exponent=2.0, creep_down=3e-5)
    begin = -p.creep_time * math.log(1 - 1e-5 / 3e-5)
    out = lives(rows=[p], settings=settings)
    assert 1e7 < begin < 3e7
    assert out["worn_depth"][0, 0] == 0 < out["worn_depth"][0, 1]
    assert np.isfinite(out["time_to_depth"][0, 0])
    assert life(rows=[p._replace(creep_down=0.9e-5)], settings=settings) == np.inf


@pytest.mark.parametrize("kappa", [0.0, 1.5])
def test_an_oxide_wears_at_a_rate_of_its_own(kappa):
    oxide = {"oxide_thickness": 1e-5, "oxide_wear_factor": 1 / 15}
    known_time = (15 * 1e-5 + 4.26e-4) / RATE
    time = life(support_wear_ratio=kappa, **oxide)
    assert time == pytest.approx(known_time, rel=1e-12)


@pytest.mark.parametrize("shape", SCARS)
def test_a_step_ends_where_the_rod_has_passed_its_oxide(shape):
    """At a steady work-rate T = V_ox/(psi k U) + (V - V_ox)/(k U), for every scar."""
    rng = np.random.default_rng(3)
    settings = GapWearSettings(depths=(5e-5,), scar=shape)
    for psi in (1 / 15, 0.7, 4.0):
        p = GapWearParameters(oxide_thickness=rng.uniform(2e-6, 3e-5), oxide_wear_factor=psi)
        kappa = p.support_wear_ratio
        bodies = scar(
            shape, np.array(p.contact_area), p.rod_radius, p.support_width, p.support_radius,
            p.support_inclination,
        )  # fmt: skip
        oxide, depth = (
            scar_volume((1 + kappa) * h, *map(float, bodies)) / (1 + kappa)
            for h in (p.oxide_thickness, 5e-5)
        )
        expected = (oxide / psi + depth - oxide) / (p.wear_coefficient * p.work_rate)
        time = lives(rows=[p], settings=settings)["time_to_depth"][0]
        np.testing.assert_allclose(time, expected, rtol=1e-12)


@pytest.mark.parametrize("share", [0.2, 3.0])
def test_running_in(share):
    """psi exp(V/V_r) + 1 - psi = exp(psi k U t/V_r)."""
    volume = 4e-9
    worn = S * 4.36e-4
    known_time = volume / (share * K * U) * math.log(share * math.expm1(worn / volume) + 1)
    errors = []
    for accuracy in (4e-3, 1e-3, 2.5e-4, 6.25e-5):
        out = lives(settings=with_law("running-in", share=share, volume=volume, accuracy=accuracy))
        errors.append(abs(out["time_to_depth"][0, 0] / known_time - 1))
        assert errors[-1] * known_time <= out["time_to_depth_error"][0, 0]
        assert errors[-1] < accuracy
    np.testing.assert_allclose(np.log2(np.divide(errors[1:-1], errors[2:])), 2, atol=0.4)


def test_the_law_of_edf():
    """V = S_inf t + (A U^b - S_inf) (1 - exp(-n t))/n."""
    steady, decay = 1.14e-16, 2.44e-8
    t = 3e8
    settings = with_law("edf", instants=(t,), accuracy=1e-6)  # the published values are the default
    out = lives(settings=settings, wear_coefficient=1e-13, depth=0.1)
    worn = steady * t - (1e-13 * U**1.2 - steady) * math.expm1(-decay * t) / decay
    assert out["worn_depth"][0, 0] == pytest.approx(worn / S, rel=1e-6)


def duty(*states, order="mixed", **choices):
    return GapWearSettings(duty=states, order=order, **choices)


def test_mixed_duty_wears_at_the_mean_rate():
    full = table(name="full", share=0.5)
    low = table(name="low", share=0.3, work_rate=0.2)
    chemistry = table(name="chemistry", share=0.1, wear=4.0)  # off in what is left of the time
    known_time = 4.36e-4 / (RATE * (0.5 + 0.3 * 0.2 + 0.1 * 4.0))
    assert life(duty(full, low, chemistry)) == pytest.approx(known_time, rel=1e-12)
    assert life(duty(table(share=0.25))) == pytest.approx(4 * life(), rel=1e-12)
    assert life(duty(table(share=0.0))) == np.inf


def test_a_sequence_with_outages_counts_the_time_of_the_calendar():
    run, outage = 1.25 * YEAR, 0.25 * YEAR
    states = table(name="run", duration=run), table(name="outage", duration=outage, wear=0.0)
    operated = 4.36e-4 / RATE
    cycles = math.floor(operated / run)
    time = life(duty(*states, order="sequence"))
    assert time == pytest.approx(operated + cycles * outage, rel=1e-12)
    mixed = life(duty(table(share=run / (run + outage))))
    bound = run * outage / (run + outage)  # q (1 - q) P r in depth, at the rate q r
    assert abs(time - mixed) <= bound * (run + outage) / run


def test_a_gap_that_an_offset_closes_does_not_wear():
    hot, cold = table(share=0.5, gap_offset=-2e-4), table(share=0.5)
    assert life(duty(hot, cold), depth=5e-5) == pytest.approx(2 * 5e-5 / RATE, rel=1e-12)
    opened = 1e-4 / (0.5 * RATE)  # then both states wear
    time = life(duty(hot, cold), depth=1.5e-4)
    assert time == pytest.approx(opened + 0.5e-4 / RATE, rel=1e-4)
    always = table(duration=1e7, gap_offset=-2e-2 / 2)
    assert life(duty(always, order="sequence")) == np.inf


def test_a_preloaded_gap_that_nothing_opens_is_refused():
    rows = np.array([GapWearParameters(preload_deflection=1e-5), GapWearParameters()])
    outputs, status, reasons = batch(rows, np.zeros(2, np.uint64), GapWearSettings())
    assert status.tolist() == [Status.NON_FINITE, Status.OK]
    assert np.isnan(outputs["time_to_depth"][0, 0]) and np.isfinite(outputs["time_to_depth"][1, 0])
    assert list(reasons) == [0] and "set creep_down" in reasons[0]


SHARE = table(share=0.5)


@pytest.mark.parametrize(
    ("choices", "words"),
    [
        ({"duty": (table(share=0.7), table(share=0.4))}, "sum to 1.1, more than 1"),
        ({"duty": (table(name="a", duration=1.0),)}, "state 'a' needs share, a number within 0.0"),
        ({"duty": (table(name="a", share=0.5, x=1.0),)}, "state 'a', in order 'mixed', has no 'x'"),
        ({"duty": (table(duration=0.0),), "order": "sequence"}, "must be positive"),
        ({"duty": (table(share=0.5),), "order": "sequence"}, "state '1' needs duration"),
        ({"gap_history": ((0.0, 0.0), (2.0, 1e-5), (1.0, 2e-5))}, "1 s follows 2 s"),
        ({"duty": (SHARE, table(name="1", share=0.1))}, "two duty states are called '1'"),
        ({"gap_history": ((1.0, 0.0), (2.0, 1e-5))}, "begin with time 0 and change 0"),
        ({"gap_history": ((0.0, 0.0), (2.0, -10.0))}, "within -0.01 to 0.01 [m]: -10"),
        ({"wear_law": "wer"}, "must be one of archard, power, running-in"),
        ({"wear_law": "running-in", "wear_law_numbers": SHARE}, "needs volume, a number"),
        ({"wear_law": "power", "wear_law_numbers": SHARE}, "has no 'share'; it takes exponent,"),
        ({"wear_law_numbers": SHARE}, "'archard' has no 'share'; it takes no numbers"),
        ({"growths": (2.0, 1.0)}, "growths must be a list of increasing"),
        ({"depths": ()}, "depths must be a list of increasing"),
        ({"instants": (2.0, 1.0)}, "increasing"),
    ],
)
def test_settings_that_make_no_sense_are_refused_in_one_line(choices, words):
    with pytest.raises(ValueError) as caught:
        GapWearSettings(**choices)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_the_names_of_scars_laws_and_orders_are_those_of_their_kernels():
    for declared in (gap_wear, beam):
        assert declared.WEAR_LAWS == (ARCHARD, *(law.name for law in LAWS))
        assert declared.SCARS == SCARS and declared.ORDERS == ORDERS
    assert len(set(gap_wear.WEAR_LAWS)) == 1 + len(LAWS)


HISTORY = ((0.0, 0.0), (4e7, 2e-5), (9e7, -1e-5), (3e8, 5e-5))
DEPTH = 2e-4
STATES = (
    table(share=0.6, work_rate=1.3),
    table(share=0.2, wear=0.4, gap_offset=-3e-5),
    table(share=0.1, gap_offset=2e-5),
)
AGEING = table(exponent=1.0, steady_rate=2e-17, decay=1e-8)


def test_a_second_integrator_agrees_with_all_processes_on():
    """Rows drawn at random against scipy's DOP853, which is restarted at kinks of the history."""
    rng = np.random.default_rng(11)
    rows = [
        GapWearParameters(
            initial_gap=1e-4,
            preload_deflection=rng.choice([0.0, 3e-5]),
            relaxed_share=0.2,
            exponent=rng.uniform(0.5, 2),
            wear_coefficient=1e-14 * 10 ** rng.uniform(-0.3, 0.5),
            support_wear_ratio=rng.uniform(0, 2),
            creep_down=rng.uniform(3e-5, 6e-5),
            creep_time=rng.uniform(2e7, 8e7),
            relaxation_time=rng.uniform(2e7, 8e7),
            swelling_rate=rng.uniform(0, 1e-13),
            swelling_start=rng.uniform(0, 1e8),
            gap_history_factor=rng.uniform(0, 1.5),
            oxide_thickness=rng.uniform(0, 1e-5),
            oxide_wear_factor=rng.uniform(0.2, 2),
        )
        for _ in range(30)
    ]
    settings = GapWearSettings(
        depths=(DEPTH,),
        scar="flat-bar",
        duty=STATES,
        wear_law="edf",
        wear_law_numbers=AGEING,
        gap_history=HISTORY,
    )
    out = lives(rows=rows, settings=settings)
    within = 0
    for i, p in enumerate(rows):
        ended = out["time_to_depth"][i, 0]
        reference = depth_time(p, 2 * ended)
        assert ended == pytest.approx(reference, rel=1e-3)
        within += abs(ended - reference) <= out["time_to_depth_error"][i, 0] + 1e-8 * reference
    assert within >= 27


def depth_time(p, end):
    """Return the time to a rod's depth, in the words of the equations."""
    factor, kappa = 4 / 3 * p.support_width * math.sqrt(2 * p.rod_radius), p.support_wear_ratio
    relaxing = p.preload_deflection * (1 - p.relaxed_share)
    new = -p.preload_deflection if p.preload_deflection > 0 else p.initial_gap

    def rate(t, state):
        volume = max(state[0], 0.0)
        h = (volume / factor) ** (2 / 3)
        moved = -p.creep_down * math.expm1(-t / p.creep_time)
        moved -= relaxing * math.expm1(-t / p.relaxation_time)
        moved -= p.swelling_rate * max(0.0, t - p.swelling_start)
        moved += p.gap_history_factor * np.interp(t, *np.array(HISTORY).T)
        total = 0.0
        for duty_state in map(dict, STATES):
            gap = new + h + moved + duty_state.get("gap_offset", 0.0)
            if gap > 0:
                work = p.work_rate * duty_state.get("work_rate", 1.0)
                work *= (gap / p.initial_gap) ** p.exponent
                worn = p.wear_coefficient * work * duty_state.get("wear", 1.0)
                worn = 2e-17 + (worn - 2e-17) * math.exp(-1e-8 * t)
                if h / (1 + kappa) < p.oxide_thickness:
                    worn *= p.oxide_wear_factor
                total += duty_state["share"] * worn
        return [(1 + kappa) * total]

    def deep(t, state):
        return state[0] - factor * ((1 + kappa) * DEPTH) ** 1.5

    deep.terminal = True
    t, state = 0.0, [0.0]
    for kink in sorted({*np.array(HISTORY)[1:, 0].tolist(), p.swelling_start, end}):
        if not t < kink <= end:
            continue
        solved = solve_ivp(
            rate, (t, kink), state, "DOP853", events=deep, rtol=1e-9, atol=1e-19, max_step=2e6
        )
        if len(solved.t_events[0]):
            return solved.t_events[0][0]
        t, state = kink, solved.y[:, -1]
    return np.inf
