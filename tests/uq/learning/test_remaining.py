"""What is left of the lives of units that run: from which time on, in which unit, how much."""

import numpy as np
import pytest
from computed import computed, study_of
from learnt_studies import DEPTH, RATE, lognormal, measured, wear
from scipy.stats import lognorm
from worn_studies import RATE as WEAR
from worn_studies import pads

from uq.errors import InputError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.answer import learnt, learnt_facts
from uq.learning.remaining_life import ANY, remaining
from uq.result.result import Result

LEFT = "life[side=left,depth=100.0]"


def inspection(unit, kind, time, output="life"):
    return {"unit": unit, "output": output, "kind": kind, "time": time}


def lives_of(ds, *by):
    return {(life.unit, life.output): life for life in remaining(Result(ds), by)}


@pytest.fixture(scope="module")
def worn():
    return pads(samples=1000)


def test_a_life_counts_from_when_its_own_unit_was_last_seen():
    told = [
        inspection("A", "survived", 3e5),
        inspection("A", "survived", 5e5),
        inspection("B", "survived", 8e5),
        inspection("C", "survived", 2e5),
        inspection("C", "ended", 9e5),
        measured(7e5)[0] | {"unit": "D"},
    ]
    lives = lives_of(update(wear(samples=300, rate="shared", units=5), told))
    assert {unit: life.seen for (unit, _), life in lives.items()} == {
        ANY: 9e5,
        "A": 5e5,
        "B": 8e5,
    }  # what has ended, or is measured as a life, has no life left
    assert list(lives["A", "life"].by) == [1e6]  # the threshold of the study


def test_it_agrees_with_the_closed_form():
    """Life is lognormal; nothing is shared, so that a unit never inspected is as before."""
    ds = update(wear(samples=3000, units=2), [inspection("A", "survived", 6e5)])
    law = lognorm((RATE[1] ** 2 + DEPTH[1] ** 2) ** 0.5, scale=DEPTH[0] / RATE[0])
    for (_, _), life in lives_of(ds, 5e5, 1.2e6).items():
        assert life.seen == 6e5
        runs = 1.0 if life.unit == "A" else law.sf(6e5)
        assert life.runs.value == pytest.approx(runs, abs=0.01)
        assert life.by[5e5].value == 0.0
        gone = (law.cdf(1.2e6) - law.cdf(6e5)) / law.sf(6e5)
        assert life.by[1.2e6].value == pytest.approx(gone, abs=0.01)
        for p, left in life.life.items():
            assert left.value == pytest.approx(law.isf((1 - p) * law.sf(6e5)) - 6e5, rel=0.04)
            assert left.low < left.value < left.high


def test_times_are_in_the_unit_of_the_life(uq, folder, worn):
    """Hours: as the times of inspections, so those asked for and those that are shown."""
    told = [inspection("A", "survived", 60.0, LEFT)]
    life = lives_of(update(worn, told), 150.0)["A", LEFT]
    law = lognorm(WEAR[1], scale=100.0 / WEAR[0])
    assert (life.units, life.seen) == ("h", 60.0)
    gone = (law.cdf(150) - law.cdf(60)) / law.sf(60)
    assert life.by[150.0].value == pytest.approx(gone, abs=0.03)
    assert life.life[0.5].value == pytest.approx(law.isf(law.sf(60) / 2) - 60, rel=0.06)
    write_result(worn, folder / "pads.nc")
    (folder / "found.csv").write_text(f'unit,time,output,kind\nA,60,"{LEFT}",survived\n')
    shown = uq("update", "pads.nc", "found.csv", "-o", "after.nc", "--by", "150").out
    assert "A: life[side=left,depth=100.0] survived at 60 h" in shown
    assert "life[side=left,depth=100.0]  remaining life [h] of units that run" in shown
    both = [
        uq("update", "pads.nc", "found.csv", "-o", f"{i}.nc", "--by", by, "--json").out
        for i, by in enumerate(("6.25 days", "150"))
    ]
    assert both[0] == both[1] and '"150.0"' in both[0]
    wrong = uq("update", "pads.nc", "found.csv", "-o", "other.nc", "--by", "2 kg")
    assert wrong.code == 2 and wrong.err == (
        "--by 2 kg: the unit 'kg' does not fit 'a life'"
        " (allowed: s, minutes, hours, days, years, ms)\n"
    )
    assert not (folder / "other.nc").exists()


def test_seconds_may_be_asked_for_as_people_write_them(uq, folder):
    write_result(wear(samples=200), folder / "wear.nc")
    (folder / "found.csv").write_text("unit,time,output,kind\nA,4e5,life,survived\n")
    both = [
        uq("update", "wear.nc", "found.csv", "-o", "after.nc", "--by", by, "--json").out
        for by in ("10 days", "864000")
    ]
    assert both[0] == both[1] and '"864000.0"' in both[0]


def test_lives_in_several_units_count_each_in_its_own(uq, folder):
    ds = pads(300, model="COUNTED", analysis={"outputs": ["life", "strokes"]})
    told = [inspection("A", "survived", 60.0, LEFT), inspection("A", "survived", 5000.0, "strokes")]
    after = update(ds, told)
    lives = lives_of(after)
    assert (lives["A", LEFT].units, lives["A", LEFT].seen) == ("h", 60.0)
    assert (lives["A", "strokes"].units, lives["A", "strokes"].seen) == ("1", 5000.0)
    assert lives["A", "strokes"].life[0.05].value < 1500  # of 60 strokes an hour, not 5,000 hours
    write_result(ds, folder / "pads.nc")
    (folder / "found.csv").write_text(f'unit,time,output,kind\nA,60,"{LEFT}",survived\n')
    wrong = uq("update", "pads.nc", "found.csv", "-o", "after.nc", "--by", "150")
    assert wrong.err == (
        "--by 150: lives are in several units (h, 1); name one life in [analysis] outputs\n"
    )
    timed = {"unit": "A", "time": 3.0, "output": "noise", "kind": "below", "value": 9.0}
    with pytest.raises(InputError, match=r"time = 3: leave it out: noise is not a life, and lives"):
        update(ds, [timed])
    assert lives_of(update(pads(300), [timed]))["A", LEFT].seen == 3.0  # where all are in hours


def test_rows_that_are_all_one_law_have_no_interval():
    """Nothing but the integrated input is uncertain: rows tell its law, and nothing else."""
    told = [inspection("A", "survived", 7e5), inspection("A", "ended", 7.7e5)]
    study = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 500, "seed": 1},
        "uncertain": {"depth": lognormal(*DEPTH)},
        "fixed": {"rate": RATE[0]},
    }
    left = lives_of(update(computed(study_of(study)), told))[ANY, "life"].life
    law = lognorm(DEPTH[1], scale=DEPTH[0] / RATE[0])
    for p, estimate in left.items():
        assert estimate.value == pytest.approx(law.isf((1 - p) * law.sf(7.7e5)) - 7.7e5, rel=1e-3)


@pytest.mark.parametrize("time", [-1.0, np.nan, np.inf])
def test_only_a_time_can_be_asked_for(worn, time):
    after = update(worn, [inspection("A", "survived", 60.0, LEFT)])
    with pytest.raises(InputError, match="must be finite, and 0 or more"):
        learnt(after, [time])


def test_what_hardly_runs_on_has_no_life_left(worn):
    """It was looked at, and running, after it must have worn through."""
    seen = {"unit": "A", "time": 99.0, "output": "noise", "kind": "above", "value": 1.5}
    life = lives_of(update(worn, [seen]))["A", LEFT]
    assert life.life == {} and "hardly any row agrees" in life.runs.reason


def test_units_that_may_be_one_are_named():
    told = [inspection(unit, "survived", 2e5) for unit in ("A 07", "a07", "A70")]
    notes = learnt(update(wear(samples=200, rate="shared", units=3), told)).notes
    assert [note for note in notes if "treated" in note] == [
        "Warning: 'A 07' and 'a07' are treated as two units."
    ]


def test_json_names_the_unit(worn):
    document = learnt_facts(
        learnt(update(worn, [inspection("A", "survived", 60.0, LEFT)]), [150.0])
    ).json
    assert {entry["units"] for unit in document["units"].values() for entry in unit.values()} == {
        "h"
    }
