"""What the next inspection is worth, of depths: when, of how many, and what is no question."""

import numpy as np
import pytest
from command_line import strict_json
from learnt_studies import DEPTH as LEARNT_DEPTH
from learnt_studies import RATE as LEARNT_RATE
from learnt_studies import measured, wear
from worn_studies import RATE, pads

from uq.errors import InputError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.next_inspection import worth
from uq.learning.posterior_result import as_unit

DEPTH, LIFE = "depth[side=left]", "life[side=left,depth=100.0]"
OWN = {"distribution": "lognormal", "median": 1.0, "sigma": 0.4, "level": "own"}


@pytest.fixture(scope="module")
def worn():
    return pads()


def test_a_measurement_of_what_all_share_narrows_it_as_in_closed_form(worn):
    """The worn depth is rate x time, and the life 100 mm / rate."""
    information = worth(worn, DEPTH, times=(20.0, 40.0), units=(1, 20), cv=0.3, life=LIFE)
    assert information.spread == pytest.approx(RATE[1], rel=0.03)
    for time in (20.0, 40.0):
        for units in (1, 20):
            noise = np.log1p(0.3**2) / units
            exact = 1 - (noise / (RATE[1] ** 2 + noise)) ** 0.5
            assert information.narrowing[time, units] == pytest.approx(exact, abs=0.01)


def test_what_is_each_unit_s_own_is_not_narrowed():
    information = worth(pads(level="own", samples=1000), DEPTH, (20.0,), (1, 20), life=LIFE)
    assert information.spread < 0.1 and not information.narrowing[20.0, 20] > 0.3


def test_repeats_are_no_more_units():
    """Depths scatter between units alone: that a unit has three rows tells no more of it."""
    information = worth(wear(samples=2000, rate="shared", units=2, repeats=3), "life", cv=0.1)
    noise = LEARNT_DEPTH[1] ** 2 + np.log1p(0.1**2)
    exact = 1 - (noise / (LEARNT_RATE[1] ** 2 + noise)) ** 0.5
    assert information.spread == pytest.approx(LEARNT_RATE[1], rel=0.03)
    assert information.narrowing[None, 1] == pytest.approx(exact, abs=0.02)


def test_rows_as_those_of_one_unit_are_no_question():
    after = update(wear(samples=300, rate="shared", units=2), measured(8e5))
    with pytest.raises(InputError, match="the rows are those of unit A, not of more"):
        worth(as_unit(after, "A"), "life")


def test_times_are_in_the_unit_of_the_life(uq, folder, worn):
    write_result(worn, folder / "pads.nc")
    ask = ("next-inspection", "pads.nc", "--inspect", DEPTH, "--life", LIFE)
    assert "at 20 h" in uq(*ask, "--at", "20").out
    document = strict_json(uq(*ask, "--at", "20", "--json").out)
    assert document["time_units"] == "h"
    assert [row["time"] for row in document["narrowing"]] == [20.0] * 3
    assert uq(*ask, "--at", "1200 minutes", "--json").out == uq(*ask, "--at", "20", "--json").out
    assert "the unit 'kg' does not fit 'a life'" in uq(*ask, "--at", "1 kg").err


def test_it_is_worth_as_much_of_a_posterior(worn):
    told = {"unit": "A", "time": 30.0, "output": DEPTH, "kind": "measured", "value": 30, "cv": 0.3}
    before, after = (worth(ds, DEPTH, (20.0,), life=LIFE) for ds in (worn, update(worn, [told])))
    left = (1 / (1 / RATE[1] ** 2 + 1 / np.log1p(0.3**2))) ** 0.5
    assert after.spread == pytest.approx(left, rel=0.06)
    assert after.narrowing[20.0, 1] < before.narrowing[20.0, 1]


@pytest.mark.parametrize(
    ("asked", "why"),
    {
        (DEPTH, 300.0): "% of the rows have worn beyond the last depth of the result",
        (DEPTH, -1.0): "time = -1: must be finite, and 0 or more",
        (DEPTH, np.nan): "time = nan: must be finite, and 0 or more",
        (DEPTH, None): "time is missing: when depth[side=left] was inspected [h]",
        (LIFE, 20.0): "life[side=left,depth=100.0] is not a depth: leave out when",
        ("noise", 20.0): "noise is not a depth: leave out when",
        ("nose", None): "output = nose: no such output; did you mean 'noise'?",
    }.items(),
)
def test_what_cannot_be_asked_is_said(worn, asked, why):
    output, time = asked
    with pytest.raises(InputError) as refused:
        worth(worn, output, () if time is None else (time,), life=LIFE)
    assert why in str(refused.value)
    assert len(refused.value.lines) == 1


def test_a_depth_that_some_rows_do_not_determine_is_rough(worn):
    """One pad in twelve has worn through 200 mm by 100 h."""
    (note,) = worth(worn, DEPTH, (20.0, 100.0), life=LIFE).notes
    assert note.startswith("Rough: by 100 h, 8.") and "% of the rows have worn beyond" in note


def test_rows_that_were_not_followed_long_enough_do_not_tell():
    with pytest.raises(InputError, match="were censored before"):
        worth(pads(settings={"horizon": 40.0}, samples=500), DEPTH, (60.0,), life=LIFE)


@pytest.mark.parametrize(("more", "why"), [({"units": (0,)}, "units = 0"), ({"cv": -1}, "cv = -1")])
def test_numbers_that_make_no_sense_are_refused(worn, more, why):
    with pytest.raises(InputError, match=f"{why}: must be"):
        worth(worn, DEPTH, (20.0,), life=LIFE, **more)
