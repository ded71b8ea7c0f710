"""Which level decides: the machine, each unit's own, or the start, against known shares."""

import numpy as np
import pytest
from answered import numbers
from computed import asking, kinds, linear
from nested_studies import nested_result

from uq import answer, trace
from uq.render.html.answer import fragment
from uq.result.variables import parameter_variable
from uq.study.installed_models import find_model


def test_the_level_that_decides_is_named_with_its_share():
    """y = x1 + 2 x2 + 3 x3 + 4 x4: x4 alone has 16 of 30 parts of the variance."""
    levels = {"x1": "own", "x2": "own", "x3": "chance", "x4": "chance"}
    ds = nested_result(levels=levels, samples=300, units=1)
    conclusions = answer(ds)
    share, low, high, rest, *_ = numbers(
        r"Chance \(x4 and x3\) explains # % \(# to # %\) of the variance,"
        r" the machine # % \(# to # %\)\.",
        conclusions.levels.sentence,
    )
    assert low < 100 * 25 / 30 < high and share + rest == pytest.approx(100, abs=0.11)
    assert conclusions.levels.sentence in conclusions.lines
    assert conclusions.levels.leader.name == "chance"
    assert any(advice.rule == "chance" for advice in conclusions.advice)


def of_regimes(share_of_start, samples=400, is_initial=True, of_pairs=False):
    """Return pairs of repeats: the regime is that of the machine, but in this share of the start.

    The start is x2, or whether x2 and x3 lie on the same side.
    """
    levels = {"x1": "own", "x2": "chance"} | ({"x3": "chance"} if of_pairs else {})
    ds = nested_result(levels=levels, samples=samples, units=1)
    random = np.random.default_rng(1)
    machine, start = ds["x1"].values > 0.5, ds["x2"].values > 0.5
    start ^= of_pairs and ds["x3"].values > 0.5
    ended = np.where(random.random(ds.sizes["row"]) < share_of_start, start, machine)
    attrs = {"role": "output", "kind": "category", "long_name": "how it ended", "units": "1"}
    attrs |= {"may_be_undefined": 0, "flag_values": np.int8([0, 1]), "flag_meanings": "calm rough"}
    if is_initial:
        ds["x2"].attrs["initial"] = 1
    ds = ds.assign(regime=("row", ended.astype(np.int8), attrs))
    return asking(ds, outputs=["regime", "y"])


def test_the_start_is_called_by_its_name_where_it_decides_the_regime():
    ds = of_regimes(0.95)
    conclusions = answer(ds)
    word = conclusions.regimes[0].predicate
    share, low, high, *_ = numbers(
        r"Initial conditions \(x2\) explain # % \(# to # %\) of the variance"
        rf" in whether it is {word},"
        r" the machine # % \(# to # %\)\.",
        conclusions.levels.sentence,
    )
    codes = ds["regime"].values.reshape(-1, 2)
    apart = (codes[:, 0] != codes[:, 1]).mean()
    expected = 100 * apart / 2 / codes.var()  # between repeats, of the whole variance
    assert share == pytest.approx(expected, abs=1) and low < expected < high
    (another, *_) = numbers(
        r"# % \(# to # %\) of repeats end in another regime\.", conclusions.levels.switching
    )
    assert another == pytest.approx(100 * apart, abs=0.06)
    assert conclusions.levels.sentence in conclusions.lines
    assert "Tighter tolerances would help little: initial conditions explain most" in repr(
        conclusions
    )
    page = fragment(conclusions)
    assert (
        page.index("answer-promise")
        < page.index("Initial conditions (x2)")
        < page.index("Value of the")
    )
    key = "answer/levels/shares/chance/value"
    assert trace(ds, key)["value"] == conclusions.levels.levels[0].share.value
    assert key in page


def test_single_inputs_are_called_so_where_another_level_decides():
    """Neither x2 nor x3 alone matters, together they decide."""
    ds = of_regimes(0.55, samples=1000, of_pairs=True)
    conclusions = answer(ds)
    assert conclusions.levels.leader.inputs == ("x2", "x3")
    by = "x1, although it alone explains only 21 % (15 to 26 %)"
    assert conclusions.regimes[0].decided_by.startswith(
        f"Main single input: {by}. Over x1, the share ranges from "
    )
    traced = trace(ds, f"answer/regimes/{conclusions.regimes[0].predicate}/decided_by")
    assert traced["sentence"] == conclusions.regimes[0].decided_by and traced["equal"]
    assert "x1 would again contribute most" not in conclusions.enough.sentence
    other = answer(of_regimes(0.05))
    assert other.levels.leader.words == "the machine"
    assert not any(advice.rule == "chance" for advice in other.advice)
    assert not any(regime.is_of_single for regime in other.regimes)


def test_where_no_level_decides_alone_the_shares_are_said():
    conclusions = answer(of_regimes(0.3))
    assert conclusions.levels.sentence.startswith(
        "No level clearly explains most of the variance in whether"
    )
    assert not any(advice.rule == "chance" for advice in conclusions.advice)


def test_without_a_start_it_is_called_chance():
    conclusions = answer(of_regimes(0.95, is_initial=False))
    assert conclusions.levels.sentence.startswith("Chance (x2) explains")


def test_a_study_of_single_rows_has_no_levels():
    assert answer(linear(samples=100)).levels is None


def test_a_start_that_is_the_same_in_all_rows_is_said():
    ds = kinds(samples=64, analysis={"outputs": ["regime", "work"]})
    assert answer(ds).starts_alike == ""
    attrs = {"role": "fixed", "long_name": "speed", "initial": 1}
    fixed = ds.assign(initial_speed=((), 0.0, attrs))
    sentence = "The effect of initial conditions on the regime is unknown: initial speed is fixed."
    assert answer(fixed).starts_alike == sentence and sentence in repr(answer(fixed))
    ds["x2"].attrs["initial"] = 1
    assert answer(ds).starts_alike == ""


@pytest.mark.parametrize(
    ("machine", "starts"),
    [
        ("beam", {"initial_displacement", "initial_velocity"}),
        ("mole", {"initial_displacement", "initial_velocity"}),
        ("vibrator", {"initial_phase_1", "initial_phase_2"}),
    ],
)
def test_results_say_which_inputs_are_the_start(machine, starts):
    model = find_model(machine)
    attrs = {name: parameter_variable(model, name, 0.0)[2] for name in model.parameter_names}
    assert {name for name, attributes in attrs.items() if "initial" in attributes} == starts
