"""Samples: one protocol for rows of every kind, whose strategy is chosen in one place."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import uq
from uq.assess.weighted_mixture import as_sample
from uq.contract import Output
from uq.result.element import Element
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.importance_weights import smoothed

CHOSEN_IN = {"sample.py", "counted_rows.py", "observed_lives.py", "weighted_mixture.py"}
ROWS = 240


class HalvedLives:
    """Lives of which each row is one of two, the other half as long, with equal probability."""

    inputs = ("scale",)
    spread = 0.35

    def below(self, lives, time):
        return ((lives < time) * 1.0 + (lives / 2 < time) * 1.0) / 2


def life(**more):
    values = np.random.default_rng(2).weibull(2.0, ROWS) + 0.1
    nowhere = np.zeros(ROWS, dtype=bool)
    declared = Output("s", "a life", "lifetime")
    return replace(Element("life", "life", declared, {}, values, nowhere, nowhere), **more)


LOGS = 0.1 * np.random.default_rng(3).normal(size=ROWS)
EVEN = Dependence(np.arange(ROWS) % 8)
SAMPLES = {
    "plain": as_sample(life(), INDEPENDENT),
    "replicates": as_sample(life(), EVEN),
    "clusters": as_sample(life(), Dependence(np.arange(ROWS) // 4, samples=60, are_samples=True)),
    "weighted": as_sample(
        life(weights=smoothed(LOGS).weights), INDEPENDENT, weights=smoothed(LOGS)
    ),
    "laws": as_sample(life(law=HalvedLives()), INDEPENDENT),
    "laws in replicates": as_sample(life(law=HalvedLives()), EVEN),
}


@pytest.mark.parametrize("kind", SAMPLES)
def test_rows_of_every_kind_answer_the_same_questions(kind):
    sample = SAMPLES[kind]
    below, above = sample.probability_below(1.0), sample.probability_above(1.0)
    moments, middle = sample.moments(), sample.quantile(0.5)
    for estimate in (below, above, moments.mean, middle, sample.life_quantile(0.5)):
        assert estimate.low < estimate.value < estimate.high, kind
    assert below.value + above.value == pytest.approx(1)
    assert sample.never_ending().value == 0
    curve = sample.survival(sample.times[:20])
    assert curve.survival[0] > curve.survival[-1] and (curve.low <= curve.high).all()
    assert {"mean", "sd", "quantile", "probability_above", "probability_below"} <= sample.by.keys()
    for estimator in (sample.share_estimator(1.0, "below"), sample.quantile_estimator(0.5)):
        rows = estimator.sample(sample.element)
        assert rows.kept.all() and np.isfinite(estimator.of(rows.numbers))


def test_only_a_simple_random_sample_promises_tolerance_bounds():
    bounds = {kind: sample.tolerance_bounds(0.95, 0.95) for kind, sample in SAMPLES.items()}
    assert {kind for kind, of_sides in bounds.items() if of_sides} == {"plain", "laws"}
    assert bounds["plain"] == bounds["laws"]  # those of lives as computed
    assert bounds["plain"]["lower"].value < 0.3 and bounds["plain"]["upper"].value > 1.5


def test_only_weighted_rows_are_worth_another_number_of_rows():
    worth = {kind: sample.effective_rows for kind, sample in SAMPLES.items()}
    assert worth.pop("weighted") < ROWS and set(worth.values()) == {None}


def test_no_caller_tells_the_kinds_of_rows_apart():
    folder = Path(uq.__file__).parent / "assess"
    guilty = {
        (path.name, node.id if isinstance(node, ast.Name) else node.attr)
        for path in folder.rglob("*.py")
        if path.name not in CHOSEN_IN
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Name)
        and node.id in ("CountedRows", "WeightedMixture")
        or isinstance(node, ast.Attribute)
        and node.attr == "is_plain"
    }
    assert not guilty
