"""Next rows: drawn where they teach most, and weighted so that means have no bias."""

import numpy as np
import pytest
from computed import as_text, computed, study_of
from limit_states import PARTS, PLANE
from scipy.special import ndtr

import uq as api
from uq.errors import InputError
from uq.execution.options import RunOptions
from uq.explore.next_rows import Aim, _proposed, _study_of, extend_by_next
from uq.files.whole_files import write_result
from uq.result.result import Result

SIGNS = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}
TABLES = {
    "study": {"name": "waves", "model": "ishigami"},
    "uncertain": dict.fromkeys(("x1", "x2", "x3"), SIGNS),
    "analysis": {"thresholds": {"y": 10.0}},
}


def design(samples=120, seed=1, **more):
    return {"design": {"method": "monte-carlo", "samples": samples, "seed": seed} | more}


def waves(samples=120, seed=1, **more):
    return computed(study_of(TABLES | design(samples, seed, **more)))


def of_waves(x1, x2, x3):
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def test_rows_near_a_limit_have_values_near_it_and_small_weights():
    ds = waves(150)
    table = api.next_rows(ds, 40, "y", near=10.0)
    assert list(table.columns) == ["x1", "x2", "x3", "weight"]
    y = of_waves(*table[["x1", "x2", "x3"]].to_numpy().T)
    near = abs(y - 10) < 3
    assert near.mean() > 3 * float((abs(ds["y"] - 10) < 3).mean())
    assert table["weight"].to_numpy()[near].mean() < 0.8


@pytest.mark.parametrize("output", ["", "y"])
def test_rows_that_fill_the_space_or_whose_output_is_uncertain_are_far_from_the_others(output):
    ds = waves(60)
    rows = np.column_stack([ds[name] for name in ("x1", "x2", "x3")])

    def distance(points):
        apart = np.linalg.norm(points[:, None] - rows, axis=2)
        return np.where(apart == 0, np.inf, apart).min(axis=1).mean()

    table = api.next_rows(ds, 50, output)
    assert distance(table[["x1", "x2", "x3"]].to_numpy()) > 1.06 * distance(rows)


@pytest.mark.parametrize(
    "aim",
    [Aim(), *(pytest.param(aim, marks=pytest.mark.slow) for aim in (Aim("y"), Aim("y", 10.0)))],
)
def test_weighted_means_have_no_bias(aim):
    """Of 60 (or 30) results of 100 rows and 50 next ones, against 3.5 and P(y > 10) = 0.0380."""
    means, shares, totals = [], [], []
    for seed in range(1000, 1060 if aim.output else 1030):
        result = Result(waves(100, seed))
        study = _study_of(result, None)
        scores, weights = _proposed(result, study, 50, aim)
        new = of_waves(*(2 * np.pi * ndtr(scores) - np.pi).T)
        y = np.concatenate([result.dataset["y"].values, new])
        means.append(np.mean(weights * y))
        shares.append(np.mean(weights * (y > 10)))
        totals.append(weights.mean())
    for estimates, truth in ((means, 3.5), (shares, 0.0380), (totals, 1.0)):
        error = np.std(estimates, ddof=1) / np.sqrt(len(estimates))
        assert abs(np.mean(estimates) - truth) < 3 * error


@pytest.mark.slow
@pytest.mark.parametrize("aim", [Aim(), Aim("y"), Aim("y", 10.0)])
def test_weighted_means_of_two_rounds_have_no_bias(aim, tmp_path):
    """Of 150 results of 120 rows, 30 next ones and 20 more, which learn from the 30."""
    means, shares, totals, last = [], [], [], []
    for seed in range(5000, 5150):
        result = Result(waves(120, seed))
        for rows in (30, 20):
            path = tmp_path / f"{seed}-{rows}.nc"
            result = Result(extend_by_next(result, rows, aim, path, None, RunOptions(workers=0)))
        weights, y = (result.dataset[name].values for name in ("weight", "y"))
        means.append(np.mean(weights * y))
        shares.append(np.mean(weights * (y > 10)))
        totals.append(weights.mean())
        last.append(weights[-20:].mean())
    for estimates, truth in ((means, 3.5), (shares, 0.0380), (totals, 1.0), (last, 1.0)):
        error = np.std(estimates, ddof=1) / np.sqrt(len(estimates))
        assert abs(np.mean(estimates) - truth) < 3 * error


def test_extend_adds_them_in_rounds_with_weights(uq, tmp_path):
    (tmp_path / "waves.toml").write_text(as_text(TABLES | design(60)))
    uq("run", tmp_path / "waves.toml", "-o", "a.nc", "--quiet")
    first = uq("extend", "a.nc", "--next", 30, "--output", "y", "--near", 10, "-o", "b.nc")
    assert first.code == 0 and "30 rows computed" in first.out, first.err
    proposed = api.next_rows("a.nc", 30, "y", near=10.0)
    ds = api.open_result("b.nc")
    assert ds.sizes["row"] == 90
    assert np.array_equal(ds["x2"].values[60:], proposed["x2"])
    assert ds["weight"].values[60:] == pytest.approx(proposed["weight"])
    assert np.array_equal(ds["y"].values[:60], api.open_result("a.nc")["y"])
    assert uq("extend", "b.nc", "--next", 20, "-o", "c.nc", "--quiet").code == 0
    three = api.open_result("c.nc")
    assert three["round"].values.tolist() == [0] * 60 + [1] * 30 + [2] * 20
    assert three["weight"].values.mean() == pytest.approx(1.0, abs=0.2)
    line = api.summary(three).loc["y"]
    assert abs(line["mean"] - 3.5) < 1.5
    assert not list(tmp_path.glob("*next*"))
    over = uq("extend", "b.nc", "--next", 20, "-o", "a.nc")
    assert over.code == 2 and "a.nc: exists already; choose another output" in over.err
    assert len(np.unique(ds["x1"])) == 90
    learnt = uq("emulate", "b.nc", "-o", "b.emulator")
    assert learnt.code == 2 and "an emulator: not with rows that have weights" in learnt.err
    again = uq("run", tmp_path / "waves.toml", "-o", "b.nc")
    assert "b.nc: has rows that have weights ('uq extend --next'); choose another" in again.err
    assert again.code == 2 and again.err.count("\n") == 1


def test_rows_of_many_inputs_are_side_by_side(uq, tmp_path):
    tables = {"study": {"name": "pulse", "model": "oscillator"}, "uncertain": PARTS} | design(40)
    write_result(computed(study_of(tables, "limit_states:OSCILLATOR")), tmp_path / "a.nc")
    shown = uq("next-rows", "a.nc", "-n", 8, "--model", "limit_states:OSCILLATOR")
    assert shown.code == 0, shown.err
    lines = [line.split() for line in shown.out.splitlines() if line]
    assert [len(line) for line in lines if line[0] == "yield_displacement"] == [5, 5]
    assert lines[0] == ["0", "1", "2", "3"]
    assert all(len(line) <= 80 for line in shown.out.splitlines())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--next", 20), "--next N needs -o NEW.nc"),
        (("--next", 2, "-o", "b.nc"), "--next"),
        (("--next", 20, "-o", "b.nc", "--output", "z"), "'z': no such output of model 'ishigami'"),
        (("--next", 20, "-o", "b.nc", "--output", "y", "--near", "nan"), "near nan: must be"),
        (("--next", 20, "-o", "b.nc", "--output", "y", "--near", "-inf"), "near -inf: must be"),
        ((), "add --samples N, or --next N -o NEW.nc"),
    ],
)
def test_mistakes_are_one_line(uq, tmp_path, arguments, words):
    (tmp_path / "waves.toml").write_text(as_text(TABLES | design(40)))
    uq("run", tmp_path / "waves.toml", "-o", "a.nc", "--quiet")
    ended = uq("extend", "a.nc", *arguments)
    assert ended.code == 2 and words in ended.err and ended.err.count("\n") == 1
    assert not list(tmp_path.glob("b*"))


def test_dependent_rows_are_refused():
    ds = waves(64, method="sobol")
    with pytest.raises(InputError, match="need independent rows drawn from laws"):
        api.next_rows(ds, 10)


def test_weights_that_a_mixture_bounds_are_trusted():
    few = Result(waves(50, seed=202))
    study = _study_of(few, None)
    scores, weights = _proposed(few, study, 25, Aim("y", 4.5))
    assert weights.max() < 3 and len(scores) == 25


def test_no_row_is_proposed_twice():
    few = Result(waves(50))
    scores, _ = _proposed(few, _study_of(few, None), 500, Aim("y", 17.0))
    assert len(np.unique(scores, axis=0)) == 500


WEAR = {
    "study": {"name": "wear", "model": "exponential-wear"},
    "fixed": {"depth": 2.5e-4},
    "uncertain": {"rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}},
}
MEAN_LIFE = 1e6 * np.exp(0.5**2 / 2)


def worn_in_rounds(tmp_path, seed):
    """Return a result of 80 rows and three rounds of 20 next ones."""
    result = Result(computed(study_of(WEAR | design(80, seed))))
    for number in range(3):
        path = tmp_path / f"{seed}-{number}.nc"
        result = Result(extend_by_next(result, 20, Aim("life"), path, None, RunOptions(workers=0)))
    return path


def test_the_mean_is_given_and_words_are_of_next_rows(uq, tmp_path):
    path = worn_in_rounds(tmp_path, seed=0)
    line = api.summary(path).loc["life"]
    assert line["mean_low"] < MEAN_LIFE < line["mean_high"] < 1.3 * line["mean_low"]
    card, full, numbers = (uq("summary", path, *by).out for by in ((), ("--full",), ("--json",)))
    assert "no 95/95 life: the rows have weights ('uq extend --next')" in card
    uq("report", path, "-o", "page.html")
    page = (tmp_path / "page.html").read_text()
    assert "The rows have weights, and a page needs rows of equal weight." in page
    for text in (card, full, numbers, page):
        assert not any(words in text for words in ("nspections", "other laws"))


def test_an_update_does_not_replace_rows_that_no_inspection_has_weighted(uq, tmp_path):
    path = worn_in_rounds(tmp_path, seed=1)
    (tmp_path / "seen.csv").write_text("unit,output,kind,time\nA,life,survived,1e5\n")
    (tmp_path / "wear.toml").write_text(as_text(WEAR | design(80)))
    uq("run", tmp_path / "wear.toml", "-o", "a.nc", "--quiet")
    ended = uq("update", "a.nc", tmp_path / "seen.csv", "-o", path)
    assert "has rows that no inspections have weighted; choose another output" in ended.err
    assert ended.code == 2 and ended.err.count("\n") == 1


@pytest.mark.slow
def test_the_interval_of_the_mean_covers_after_three_rounds(tmp_path):
    """Of 60 results all have a mean; some have a heavy tail, which has no interval."""
    lines = [api.summary(worn_in_rounds(tmp_path, seed)).loc["life"] for seed in range(60)]
    ends = [(line["mean_low"], line["mean_high"]) for line in lines if line["mean_high"] > 0]
    held = [low < MEAN_LIFE < high for low, high in ends]
    assert np.isfinite([line["mean"] for line in lines]).all() and len(held) > 50
    assert np.mean(held) > 0.91


def test_a_limit_that_is_no_number_is_one_line(uq, tmp_path):
    (tmp_path / "waves.toml").write_text(as_text(TABLES | design(40)))
    uq("run", tmp_path / "waves.toml", "-o", "a.nc", "--quiet")
    for near in ("nan", "inf"):
        ended = uq("next-rows", "a.nc", "--output", "y", "--near", near)
        assert ended.code == 2 and f"next rows: near {near}: must be finite" in ended.err
        with pytest.raises(InputError, match=f"near {near}: must be finite"):
            api.next_rows("a.nc", 20, "y", near=float(near))


def test_the_number_of_rows_that_an_output_needs_is_stated():
    ds = waves(18)
    words = r"'y' has a value in 1\d of those to learn from, four fifths of 18, and 16 are needed"
    with pytest.raises(InputError, match=words):
        api.next_rows(ds, 20, "y")
    ds = waves(40)
    ds["y"][:] = 1.0
    with pytest.raises(InputError, match="next rows: 'y' has the same value in all rows to"):
        api.next_rows(ds, 20, "y")


def test_a_limit_that_no_life_has_is_one_line():
    ds = computed(study_of(WEAR | design(40)))
    with pytest.raises(InputError, match="next rows: -1 is no life"):
        api.next_rows(ds, 20, "life", near=-1.0)


def test_rows_of_each_round_have_random_numbers_of_their_own(tmp_path):
    tables = {"study": {"name": "rough", "model": "linear"}, "uncertain": PLANE} | design(40)
    result = Result(computed(study_of(tables, "limit_states:ROUGH")))
    for path in (tmp_path / "first.nc", tmp_path / "second.nc"):
        options = RunOptions(workers=0)
        ds = extend_by_next(result, 20, Aim(), path, "limit_states:ROUGH", options)
        result = Result(ds)
    noise = (ds["rough"] - ds["x1"]).values
    assert len(np.unique(noise.round(9))) == 80
