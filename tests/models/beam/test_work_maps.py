"""Work-rates mapped over both gaps: lives from a map are those of the beam, and of any wear."""

import numpy as np
import pytest
from service_rods import FIELDS, rows

from models.beam import MODEL
from models.beam.parameters import Params, Settings
from models.beam.service.work_maps import (
    MAP_NODES,
    MAP_POSITIONS,
    TERMS,
    WorkMaps,
    fit_maps,
    mapped_work,
)
from uq.contract import Kept, Status

SHORT = {"depths": (2e-5, 4e-5), "accuracy": 0.05}
RANDOM = {
    "force_amplitude": 0.0,
    "random_force_level": 0.05,
    "mass_damping": 40.0,  # a short memory
    "forcing_frequency": 200.0,  # the unit of averaging times
}


def computed(x, **choices):
    settings = Settings(**(SHORT | choices))
    outputs, status = MODEL.batch(x, np.arange(len(x), dtype=np.uint64), settings)[:2]
    return settings, outputs, status


def test_a_map_follows_a_smooth_work_rate_and_its_error_covers():
    rng = np.random.default_rng(1)
    right, left = np.meshgrid(MAP_POSITIONS, MAP_POSITIONS, indexing="ij")

    def truth(u, v):
        return np.exp(-1.5 * u - 0.7 * v - 0.4 * (u + v) ** 2)

    fine = np.linspace(0.05, 0.95, 7)
    covered = []
    for _ in range(200):
        exact = truth(right, left)
        noise = 0.05 * exact
        work = exact + noise * rng.normal(size=exact.shape)
        maps = WorkMaps(
            np.zeros((1, 1, 2)),
            np.array([work, work])[None, None],
            np.array([noise, noise])[None, None],
        )
        fitted = fit_maps(maps)
        terms = fitted.terms[0, 0, 0]
        values = [
            mapped_work(u, v, fitted.terms[0, 0, 0]) / truth(u, v) for u in fine for v in fine
        ]
        errors = []
        for more in fitted.spread[0, 0, 0]:
            moved = [mapped_work(u, v, terms + more) / truth(u, v) for u in fine for v in fine]
            errors.append(np.subtract(moved, values))
        error = 1.645 * np.sqrt(np.square(errors).sum(axis=0))
        covered.append(np.abs(np.array(values) - 1) <= error)
        assert 0.02 < error.mean() < 0.1
    assert 0.85 <= np.mean(covered) <= 0.99
    assert fitted.terms.shape == (1, 1, 2, TERMS)


def test_a_work_rate_that_is_hardly_known_is_not_mapped():
    ones = np.ones((1, 1, 2, MAP_NODES, MAP_NODES))
    assert np.isinf(fit_maps(WorkMaps(np.zeros((1, 1, 2)), ones, 0.9 * ones)).gap).all()
    silent = fit_maps(WorkMaps(np.zeros((1, 1, 2)), 0 * ones, 0 * ones))
    assert mapped_work(0.3, 0.4, silent.terms[0, 0, 0]) < 1e-300 and not silent.spread.any()


@pytest.fixture(scope="module")
def mapped():
    """Two rods under a random force, and one under a harmonic force, whose work has no map."""
    x = rows(3, **RANDOM)
    x[2, FIELDS.index("random_force_level")] = 0.0
    x[2, FIELDS.index("force_amplitude")] = 6.0
    x[2, FIELDS.index("forcing_frequency")] = Params().forcing_frequency
    return x, *computed(x, map_growth=1e-4)


def test_rods_computed_again_from_their_maps_are_those_of_a_run_to_the_bit(mapped):
    x, settings, outputs, status = mapped
    assert not status.any()
    assert np.isnan(outputs["mapped_work_rate"][2]).all()
    changes = {"creep_down": 2e-5, "creep_time": 1e4, "support_wear_ratio": 0.5}
    other = x.copy()
    for name, value in changes.items():
        other[:, FIELDS.index(name)] = value
    other[:, FIELDS.index("wear_coefficient")] *= 2
    choices = {"scar": "flat-bar", "instants": (1e3,), "growths": (1e-5,), "map_growth": 1e-4}
    new_settings, expected, _ = computed(other, **choices)
    seed = np.arange(3, dtype=np.uint64)
    again, codes, reasons = MODEL.again(other, seed, new_settings, Kept(x, settings, outputs))
    assert set(again) == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(again[name][:2], values[:2], err_msg=name)
    assert codes.tolist() == [Status.OK, Status.OK, Status.OUT_OF_BUDGET]
    assert list(reasons) == [2] and "mapped" in reasons[2]


@pytest.mark.parametrize(
    ("inputs", "choices", "words"),
    [
        ({"initial_gap": 2e-4}, {}, "initial_gap moves the beam"),
        ({}, {"elements": 12}, "elements moves the beam"),
        ({}, {"duty": ((("share", 0.5), ("force", 0.5)),)}, "other states of duty"),
        ({}, {"map_growth": 2e-4}, "map_growth moves"),
    ],
)
def test_rods_that_would_move_otherwise_are_refused_in_one_line(mapped, inputs, choices, words):
    x, settings, outputs, _ = mapped
    other = x.copy()
    for name, value in inputs.items():
        other[:, FIELDS.index(name)] = value
    changed = Settings(**(SHORT | {"map_growth": 1e-4} | choices))
    with pytest.raises(ValueError) as caught:
        MODEL.again(other, np.arange(3, dtype=np.uint64), changed, Kept(x, settings, outputs))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_rod_that_leaves_its_map_is_out_of_budget(mapped):
    x, settings, outputs, _ = mapped
    deep = Settings(**(SHORT | {"depths": (2e-5, 2e-4), "map_growth": 1e-4}))
    kept = Kept(x[:2], settings, {name: values[:2] for name, values in outputs.items()})
    again, codes, _ = MODEL.again(x[:2], np.arange(2, dtype=np.uint64), deep, kept)
    assert (codes == Status.OUT_OF_BUDGET).all()
    np.testing.assert_array_equal(
        again["first_time_to_depth"][:, 0], outputs["first_time_to_depth"][:2, 0]
    )
    assert again["first_time_to_depth_censored"].tolist() == [[False, True]] * 2


@pytest.mark.slow
def test_lives_from_maps_agree_with_lives_of_the_beam_within_their_errors():
    x = rows(64, **RANDOM)
    _, direct, _ = computed(x)
    _, outputs, status = computed(x, map_growth=1e-4)
    assert not status.any()
    apart = np.abs(outputs["first_time_to_depth"] - direct["first_time_to_depth"])
    errors = [result["first_time_to_depth_error"] for result in (outputs, direct)]
    assert (apart <= np.hypot(*errors)).mean() >= 0.9
