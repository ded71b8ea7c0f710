"""Processes beside wear by impact: without any, lives keep their way; each follows its equation."""

import math

import numpy as np
import pytest
from service_rods import FIELDS, rows

from models.beam import MODEL
from models.beam.batch import batch as by_impact_alone
from models.beam.parameters import Params, Settings
from uq import InputError, load_study
from uq.contract import Status

QUICK = {"depths": (2e-5, 4e-5), "accuracy": 0.05}


def lives(x, **choices):
    settings = Settings(**(QUICK | choices))
    outputs, status = MODEL.batch(x, np.arange(len(x), dtype=np.uint64), settings)
    assert not status.any()
    return outputs


def of_impact_alone(x, **choices):
    settings = Settings(**(QUICK | choices))
    return by_impact_alone(x, np.arange(len(x), dtype=np.uint64), settings)


def table(**entries):
    return tuple(entries.items())


def test_without_a_process_lives_are_those_of_impact_alone_to_the_bit():
    x = rows(4)
    x[2, FIELDS.index("force_amplitude")] = 0.0
    x[2, FIELDS.index("random_force_level")] = 1e-9
    # None of these matters while its process is off.
    x[3, FIELDS.index("creep_time")] = 1e6
    x[3, FIELDS.index("relaxed_share")] = 0.5
    x[3, FIELDS.index("oxide_thickness")] = 1e-5
    x[3, FIELDS.index("rod_radius")] = 1e-2
    outputs = lives(x, instants=(1e3, 1e4), growths=QUICK["depths"])
    beam, status = of_impact_alone(x, instants=(1e3, 1e4))
    assert not status.any()
    for name, values in beam.items():
        np.testing.assert_array_equal(outputs[name], values, err_msg=name)
    for end in ("", "_error", "_censored"):
        same = outputs[f"time_to_gap_growth{end}"], beam[f"time_to_depth{end}"]
        np.testing.assert_array_equal(*same)
    assert not outputs["time_to_opening"].any()


def test_lives_along_the_integrator_are_those_of_the_beam():
    """Creep of a femtometre changes nothing but the way in which lives are found."""
    x = rows(12, creep_down=1e-15)
    outputs, (beam, _) = lives(x, instants=(5e3,)), of_impact_alone(x, instants=(5e3,))
    life, error = (outputs[f"first_time_to_depth{end}"] for end in ("", "_error"))
    expected, doubt = (beam[f"first_time_to_depth{end}"] for end in ("", "_error"))
    np.testing.assert_array_equal(np.isinf(life), np.isinf(expected))
    finite = np.isfinite(life)
    off = np.abs(life - expected)[finite]
    assert (off <= np.hypot(error, doubt)[finite]).mean() >= 0.9
    assert (off <= 0.05 * expected[finite]).all()
    np.testing.assert_allclose(
        outputs["largest_worn_depth"], beam["largest_worn_depth"], rtol=0.02, atol=1e-7
    )
    np.testing.assert_allclose(outputs["gap_ratio"], beam["gap_ratio"], rtol=0.02)
    np.testing.assert_allclose(outputs["linear_time_to_depth"], beam["linear_time_to_depth"])


@pytest.mark.parametrize(
    ("scar", "power"), [("prismatic", 1.0), ("flat-bar", 1.5), ("dimple", 2.0), ("inclined", 2.5)]
)
def test_a_shallow_scar_takes_the_linear_estimate(scar, power):
    """At a constant work-rate T = (1 + kappa)^(p-1) B d^p/(k U)."""
    # Not the sizes of the reference rod, which is integrated in its place.
    sizes = {"rod_radius": 7e-3, "support_width": 5e-3, "support_radius": 2e-2}
    sizes |= {"contact_area": 6e-6, "wear_coefficient": 3e-14}
    x = rows(**sizes, support_wear_ratio=0.5)
    depths = (1e-8, 2e-8)
    outputs = lives(x, scar=scar, depths=depths)
    # The work-rate stated is that in half the steps.
    np.testing.assert_allclose(outputs["lifetime_ratio"], 1, rtol=3e-3)
    life = outputs["first_time_to_depth"][0]
    assert math.log2(life[1] / life[0]) == pytest.approx(power, abs=1e-3)
    radius, width = 7e-3, 5e-3
    factor = {
        "prismatic": 6e-6,
        "flat-bar": 4 / 3 * width * math.sqrt(2 * radius),
        "dimple": math.pi * math.sqrt(radius * 2e-2),
        "inclined": 8 * math.sqrt(2 * radius) / (15 * 1e-2),
    }[scar]
    known_time = 1.5 ** (power - 1) * factor * depths[0] ** power
    known_time /= 3e-14 * outputs["work_rate_heavy"][0]
    assert life[0] == pytest.approx(known_time, rel=3e-3)


def test_a_support_that_wears_as_fast_doubles_the_growth_of_the_gap():
    x = rows(3, support_wear_ratio=1.0)
    outputs = lives(x, depths=(1e-5, 2e-5), growths=(2e-5, 4e-5))
    beam, _ = of_impact_alone(x)
    life = outputs["time_to_depth"]
    np.testing.assert_allclose(life, beam["time_to_depth"] / 2, rtol=0.01)
    np.testing.assert_allclose(outputs["time_to_gap_growth"], life, rtol=1e-9)


def test_duty_stretches_lives_by_the_share_of_operation():
    x = rows(creep_down=1e-15)
    whole = lives(x)
    half = lives(x, duty=(table(name="run", share=0.3), table(name="too", share=0.2)))
    np.testing.assert_allclose(half["time_to_depth"], 2 * whole["time_to_depth"], rtol=1e-6)
    run, stop = table(duration=1e3), table(duration=3e3, wear=0.0)
    turns = lives(x, duty=(run, stop), order="sequence")["time_to_depth"]
    operated = whole["time_to_depth"]
    np.testing.assert_allclose(turns, operated + 3e3 * np.floor(operated / 1e3), rtol=0.01)


def test_states_of_duty_have_responses_of_their_own():
    x = rows(creep_down=1e-15)
    weak = lives(
        rows(creep_down=1e-15, force_amplitude=4.8, forcing_frequency=62.81462), depths=(1e-8,)
    )
    strong = lives(x, depths=(1e-8,))
    mixed = lives(
        x,
        depths=(1e-8,),
        duty=(table(share=0.5), table(share=0.4, force=0.8, frequency=1.1)),
    )
    rate = 0.5 / strong["time_to_depth"] + 0.4 / weak["time_to_depth"]
    np.testing.assert_allclose(mixed["time_to_depth"], 1 / rate, rtol=1e-3)


def test_a_preloaded_support_opens_in_time_and_then_wears():
    p = {"preload_deflection": 3e-5, "relaxed_share": 0.25, "creep_down": 2e-5}
    path = 2e-5 + 0.75 * 3e-5
    opened = -4.7e7 * math.log(1 - 3e-5 / path)
    outputs = lives(rows(2, **p), depths=(2e-6,))
    np.testing.assert_allclose(outputs["time_to_opening"], opened, rtol=1e-12)
    assert (outputs["time_to_depth"] > opened).all()
    held = lives(rows(1, **(p | {"creep_down": 0.7e-5})))
    assert np.isinf(held["time_to_opening"]).all() and np.isinf(held["time_to_depth"]).all()


def test_swelling_ends_wear():
    x = rows(swelling_rate=1e-6)
    closed = 2.5e-4 / 1e-6
    outputs = lives(x, instants=(closed * 1.1, closed * 2))
    assert np.isinf(outputs["time_to_depth"]).all()
    worn = outputs["largest_worn_depth"][0]
    assert 0 < worn[0] < 1e-6 and worn[1] == pytest.approx(worn[0], rel=1e-12)


@pytest.mark.parametrize(
    ("choices", "words"),
    [
        ({"depths": ("40 %",)}, "depths: '40 %' needs wall_thickness"),
        ({"depths": ("40",), "wall_thickness": 1e-3}, "'40' must be a number of metres"),
        ({"depths": ("140 %",), "wall_thickness": 1e-3}, "'140 %' must be"),
        ({"duty": (table(share=0.7), table(share=0.6))}, "sum to 1.3, more than 1"),
        ({"duty": (table(share=0.7, frequency=0.0),)}, "frequency factor"),
        ({"gap_history": ((0.0, 0.0), (2.0, 0.0), (1.0, 0.0))}, "must ascend in time"),
        ({"wear_law_numbers": table(exponent=2.0)}, "'archard' has no 'exponent'"),
        ({"wear_law": "power", "wear_law_numbers": table(decay=2.0)}, "'power' has no 'decay'"),
        ({"growths": (2e-5, 1e-5)}, "growths must be a list of increasing numbers"),
    ],
)
def test_settings_that_make_no_sense_are_refused_in_one_line(choices, words):
    with pytest.raises(ValueError) as caught:
        Settings(**choices)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_depth_may_be_a_share_of_the_wall():
    settings = Settings(depths=("20 %", 1e-3, "40 %"), wall_thickness=4e-3)
    assert settings.depths == pytest.approx((0.8e-3, 1e-3, 1.6e-3))


def test_a_preload_that_nothing_opens_is_refused_with_a_reason():
    x = np.concatenate([rows(preload_deflection=1e-5), rows(wear_coefficient=1e-12)])
    settings = Settings(scar="flat-bar", depths=(1e-8,))
    outputs, status, reasons = MODEL.batch(x, np.zeros(2, np.uint64), settings)
    assert status.tolist() == [Status.NON_FINITE, Status.OK]
    assert list(reasons) == [0] and "preload_deflection" in reasons[0]
    assert np.isnan(outputs["first_time_to_depth"][0]).all()
    assert np.isfinite(outputs["first_time_to_depth"][1]).all()


def test_a_study_whose_preload_nothing_opens_is_refused_before_it_runs():
    preloaded = MODEL.nominal | {"preload_deflection": 1e-5}
    assert "creep_down" in MODEL.refusal(Settings(), preloaded)
    assert MODEL.refusal(Settings(), MODEL.nominal) == ""
    assert MODEL.refusal(Settings(), preloaded | {"creep_down": 2e-5}) == ""
    history = Settings(gap_history=((0.0, 0.0), (1e6, 2e-5)))
    assert MODEL.refusal(history, preloaded) == ""
    varied = {name: value for name, value in preloaded.items() if name != "creep_down"}
    assert MODEL.refusal(Settings(), varied) == ""
    study = load_study("studies/beam-lifetime.toml")
    with pytest.raises(InputError, match="nothing opens the gaps"):
        study.with_changes({"fixed.preload_deflection": 1e-5})


def test_an_oxide_and_a_law_of_wear_change_the_rate():
    plain = lives(rows(creep_down=1e-15), depths=(1e-8,))["time_to_depth"]
    oxide = {"oxide_thickness": 1e-3, "oxide_wear_factor": 0.5}
    np.testing.assert_allclose(
        lives(rows(**oxide), depths=(1e-8,))["time_to_depth"], 2 * plain, rtol=1e-6
    )
    law = {"wear_law": "power", "wear_law_numbers": table(exponent=2.0)}
    outputs = lives(rows(), depths=(1e-8,), **law)
    work = outputs["work_rate"][:, :, None]
    np.testing.assert_allclose(outputs["time_to_depth"], plain / work, rtol=0.01)


@pytest.mark.parametrize(
    ("on", "choices"),
    [
        ({"creep_down": 1e-6}, {}),
        ({"preload_deflection": 1e-5}, {}),
        ({"swelling_rate": 1e-12}, {}),
        ({}, {"wear_law": "edf"}),
        ({}, {"duty": (table(duration=1e3),), "order": "sequence"}),
        ({}, {"gap_history": ((0.0, 0.0), (1e7, 1e-5))}),
    ],
)
def test_nothing_only_scales_lives_where_a_process_keeps_its_own_time(on, choices):
    neutral, settings = MODEL.nominal, Settings(**choices)
    name = "first_time_to_depth"
    varied = {key: value for key, value in neutral.items() if key not in on}
    for constants in (neutral | on, varied):
        exponents = MODEL.given(settings, constants).outputs[name].exponents
        assert exponents == {} or not (on or choices)
    unused = {key: value for key, value in neutral.items() if key != "creep_time"}
    expected = {"wear_coefficient": -1.0, "contact_area": 1.0}
    assert MODEL.given(Settings(), unused).outputs[name].exponents == expected


def test_rods_that_differ_in_scale_alone_are_integrated_once():
    x = rows(1, wear_coefficient=1e-14)
    many = np.tile(x, (400, 1))
    many[:, FIELDS.index("wear_coefficient")] = np.geomspace(1e-16, 1e-12, 400)
    choices = {"scar": "flat-bar", "duty": (table(share=0.5),), "horizon": 1e4}
    outputs = lives(many, **choices)
    alone = lives(many[:1], **choices)
    life = outputs["first_time_to_depth"][:, 0]
    cut = life == 1e4
    assert cut.any() and not cut.all()
    assert (outputs["first_time_to_depth_censored"][:, 0] == cut).all()
    np.testing.assert_array_equal(life[0], alone["first_time_to_depth"][0, 0])
    unit = (life * many[:, FIELDS.index("wear_coefficient")])[~cut]
    np.testing.assert_allclose(unit, unit[-1], rtol=1e-12)


def test_a_sequence_that_repeats_often_is_mixed_and_its_error_says_so():
    x = rows(wear_coefficient=1e-15)
    states = table(duration=10.0), table(duration=30.0, wear=0.0, force=0.5)
    mixed = lives(x, duty=(table(share=0.25), table(share=0.75, wear=0.0, force=0.5)))
    turns = lives(x, duty=states, order="sequence")
    np.testing.assert_array_equal(turns["time_to_depth"], mixed["time_to_depth"])
    np.testing.assert_allclose(
        turns["time_to_depth_error"], mixed["time_to_depth_error"] + 40.0, rtol=1e-12
    )
    long = table(duration=3e4), table(duration=9e4, wear=0.0, force=0.5)
    slow = lives(x, duty=long, order="sequence")["time_to_depth"]
    operated = mixed["time_to_depth"] / 4
    np.testing.assert_allclose(slow, operated + 9e4 * np.floor(operated / 3e4), rtol=0.02)


def test_the_gap_at_an_instant_is_what_wear_and_creep_have_opened():
    p = {"creep_down": 2e-5, "creep_time": 1e4, "support_wear_ratio": 1.0}
    instants = (1e3, 3e3, 1e7)
    outputs = lives(rows(**p), instants=instants, growths=(1e-6, 1e-5))
    moved = -2e-5 * np.expm1(-np.array(instants) / 1e4)
    worn, gap = outputs["worn_depth"][0], outputs["gap"][0]
    np.testing.assert_allclose((gap - Params().initial_gap - moved)[:, :2], 2 * worn[:, :2])
    assert np.isnan(gap[:, 2]).all() and np.isnan(outputs["wear_share"][0, :, 2]).all()
    np.testing.assert_allclose(
        outputs["wear_share"][0, :, :2], 2 * worn[:, :2] / (2 * worn + moved)[:, :2]
    )
    plain = lives(rows(), instants=(1e3,))
    np.testing.assert_allclose(plain["gap"], Params().initial_gap + plain["worn_depth"])
    assert (plain["wear_share"] == 1).all()
