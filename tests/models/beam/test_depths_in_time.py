"""The worn depth at given instants: the lives read the other way round."""

import numpy as np
import pytest
from laws import Law, lives

from models.beam import MODEL
from models.beam.parameters import Params, Settings
from models.beam.response.response import APERIODIC
from uq.contract import Status

DEPTHS = Settings().depths


def rows(n=1, **values):
    x = np.tile(Params(), (n, 1)).astype(float)
    for name, value in values.items():
        x[:, Params._fields.index(name)] = value
    return x


def compute(x, **settings):
    return MODEL.batch(x, np.arange(len(x), dtype=np.uint64), Settings(**settings))


def test_a_known_law_is_followed_in_time():
    """A rate 4 x_1 makes the growth e^(4 t) - 1; one without memory of time is straight."""
    instants = np.array([0.02, 0.1, 0.15, 0.3])
    law = Law(lambda gaps: np.stack([4 * gaps[:, 0], 0 * gaps[:, 1] + 2], axis=1))
    wear = lives(law, [0.5, 1.0], instants=instants[None])
    assert wear.depth[0, 0, :3] == pytest.approx(np.expm1(4 * instants[:3]), rel=3e-3)
    assert wear.depth[0, 1] == pytest.approx(2 * instants, rel=1e-12)
    assert wear.depth[0, 0, 3] >= 1.0  # after the last growth


@pytest.mark.parametrize(
    "regime", [pytest.param(APERIODIC, id="flow"), pytest.param(2, id="steps")]
)
def test_each_growth_is_there_at_the_end_of_its_life(regime):
    growths = np.linspace(0.1, 1.0, 7)
    law = lambda: Law(lambda gaps: gaps * np.array([2.0, 1.3]) * (1 + (gaps > 1.4)))  # noqa: E731
    of = {"n": 2, "regime": regime}
    instants = lives(law(), growths, **of).time.reshape(2, -1)
    wear = lives(law(), growths, instants=instants, **of)
    depth = wear.depth.reshape(2, 2, 2, -1)  # beam, site, site of the life, growth
    for site in range(2):
        assert depth[:, site, site] == pytest.approx(np.tile(growths, (2, 1)), rel=1e-12)


def test_wear_that_has_ended_stays_where_it_is():
    """A gap that grows to the free amplitude, 1.5, like 0.5 (1 - e^-t)."""
    law = Law(lambda gaps: np.maximum(0.0, 1.5 - gaps.max(axis=1, keepdims=True)) + 0 * gaps)
    wear = lives(law, [0.2, 0.4, 1.0], instants=np.array([[0.3, 1.0, 1e6, 1e9]]))
    expected = [0.5 * -np.expm1(-0.3), 0.5 * -np.expm1(-1.0), 0.5, 0.5]
    assert wear.ended[0]
    assert wear.depth[0] == pytest.approx(np.array([expected, expected]), rel=0.01)


@pytest.mark.parametrize("frequency", [57.1042, 32.3591])
def test_a_beam_has_worn_by_each_depth_at_the_end_of_its_life(frequency):
    x = rows(forcing_frequency=frequency)
    reference, _ = compute(x, accuracy=0.1)
    ends = np.unique(reference["time_to_depth"])
    instants = (*ends.tolist(), 2 * ends[-1])
    outputs, status = compute(x, accuracy=0.1, instants=instants)
    assert status == [Status.OK]
    for site, of in enumerate(reference["time_to_depth"][0]):
        worn = outputs["worn_depth"][0, site]
        assert worn[np.searchsorted(ends, of)] == pytest.approx(DEPTHS, rel=1e-12)
        assert (np.diff(worn) >= 0).all() and worn[-1] == DEPTHS[-1]
    first = np.searchsorted(ends, reference["first_time_to_depth"][0])
    assert outputs["largest_worn_depth"][0, first] == pytest.approx(DEPTHS, rel=1e-12)


def test_time_scales_with_the_wear_coefficient_and_the_area():
    x = rows(3, wear_coefficient=[1e-14, 3e-14, 1e-14], contact_area=[4e-6, 4e-6, 8e-6])
    outputs, _ = compute(x, accuracy=0.1, instants=(1000.0, 1500.0, 3000.0))
    first, faster, slower = outputs["worn_depth"]
    assert faster[:, 0] == pytest.approx(first[:, 2], rel=1e-12)
    assert slower[:, 2] == pytest.approx(first[:, 1], rel=1e-12)
    assert (first[:, 2] > 1.5 * first[:, 1]).all() and (first > 0).all()


@pytest.mark.slow
def test_a_random_load_wears_by_each_depth_in_its_life():
    x = rows(random_force_level=0.05)
    depths = (2e-5, 4e-5)
    reference, _ = compute(x, accuracy=1.0, depths=depths)
    ends = np.unique(reference["time_to_depth"])
    outputs, _ = compute(x, accuracy=1.0, depths=depths, instants=(ends[0] / 7, *ends.tolist()))
    for site, of in enumerate(reference["time_to_depth"][0]):
        worn = outputs["worn_depth"][0, site]
        assert worn[1 + np.searchsorted(ends, of)] == pytest.approx(depths, rel=1e-9)
        assert 0 < worn[0] < worn[1]


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"instants": (2.0, 1.0)}, "increasing"),
        ({"instants": (2.0, 20.0), "horizon": 10.0}, "beyond the horizon"),
    ],
)
def test_instants_that_make_no_sense_are_refused(settings, why):
    with pytest.raises(ValueError, match=why):
        Settings(**settings)
