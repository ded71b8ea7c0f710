"""Which bearing is it? What a disphasing angle and a speed say of a vibrator's bearings."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from computed import computed

from uq.learning.inspections import read_tables
from uq.learning.posterior import posterior
from uq.learning.posterior_checks import distrust
from uq.result.result import Result
from uq.study.definition import load_study

STUDY = Path(__file__).parents[3] / "studies" / "vibrator-tolerances.toml"
ERRORS = {"disphasing_angle": np.radians(1.0), "speed": 0.1}  # rad, rad/s


def machines(samples, seed):
    study = load_study(STUDY)
    design = study.design.model_copy(update={"samples": samples, "seed": seed})
    return computed(replace(study, design=design))


@pytest.mark.slow
def test_it_finds_the_worse_bearing():
    """Of 300 machines drawn from the tolerances."""
    rows, true = machines(4000, 1), machines(300, 2)
    differs, of_true = (
        ds.bearing_constant_1.values - ds.bearing_constant_2.values for ds in (rows, true)
    )
    rng, held, sure = np.random.default_rng(3), [], []
    for machine, difference in enumerate(of_true):
        seen = [
            {
                "unit": "A",
                "output": output,
                "kind": "measured",
                "value": true[output].values[machine] + sd * rng.standard_normal(),
                "sd": sd,
            }
            for output, sd in ERRORS.items()
        ]
        learned = posterior(Result(rows), read_tables(seen))
        if distrust(learned):
            continue
        weights = learned.units["A"].weights.weights
        order = np.argsort(differs)
        share = np.cumsum(weights[order]) / weights.sum()
        low, high = np.interp([0.025, 0.975], share, differs[order])
        held.append(low <= difference <= high)
        sure.append((np.average(differs > 0, weights=weights), difference > 0))
    assert len(held) > 0.75 * len(of_true)  # the others need more rows
    assert 0.90 <= np.mean(held) <= 0.99
    chance, first = np.transpose(sure)
    assert abs((first - chance).sum()) < 3 * (chance * (1 - chance)).sum() ** 0.5
    clear = np.abs(chance - 0.5) > 0.4
    assert clear.mean() > 0.3 and ((chance > 0.5) == first)[clear].mean() > 0.9
