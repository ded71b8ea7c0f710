"""The table of coverage: its truths, its counting, and what it says of an interval that is off."""

import html
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from benchmarks.coverage import fewer_rows, known_indices, nested, noise, problems
from benchmarks.coverage.chapters import CHAPTERS, chapter_of
from benchmarks.coverage.page import page
from benchmarks.coverage.parts import PARTS
from benchmarks.coverage.tally import Tally

ROWS = 200_000


@pytest.fixture(scope="module")
def big():
    """Return many rows of the problems."""
    return problems.computed(problems.study_of("monte-carlo", ROWS))


def test_truths_are_those_of_many_rows(big):
    truths, upper = problems.jump(), big["regime"].values == 1
    y, life = big["jump"].values, big["life"].values
    near = 4 / np.sqrt(ROWS)
    assert upper.mean() == pytest.approx(truths["share"], abs=near)
    assert y.mean() == pytest.approx(truths["mean"], abs=near * y.std())
    for name, rows in (("upper", upper), ("lower", ~upper)):
        assert y[rows].mean() == pytest.approx(truths["within"][name], abs=2 * near)
    between = np.where(upper, y[upper].mean(), y[~upper].mean()).var() / y.var()
    assert between == pytest.approx(truths["between"], abs=near)
    for p in (0.05, 0.5, 0.95):
        for values, ppf in (
            (y, problems.jump_ppf),
            (big["ishigami"].values, problems.ishigami_ppf),
            (life, problems.LIFE.ppf),
        ):
            assert np.mean(values < ppf(p)) == pytest.approx(p, abs=near)
    assert np.mean(y[upper] < problems.jump_ppf(0.5, "upper")) == pytest.approx(0.5, abs=2 * near)
    assert np.mean(big["never"].values < 2.0) == pytest.approx(problems.never_cdf(2.0), abs=near)
    assert np.mean(np.isinf(big["never"].values)) == pytest.approx(
        1 - problems.never_cdf(1e9), abs=near
    )


def test_indices_of_the_jump_are_those_of_many_rows(big):
    truths, y = problems.jump(), big["jump"].values
    upper = (big["regime"].values == 1).astype(float)
    for name in ("x1", "x2", "x3"):
        parts = np.array_split(np.argsort(big[name].values), 400)
        for values, truth in ((y, truths["S1"]), (upper, truths["event"]["S1"])):
            first = np.var([values[part].mean() for part in parts]) / values.var()
            assert first == pytest.approx(truth[name], abs=0.01)


def test_indices_of_the_life_are_those_of_many_rows(big):
    life = big["never"].values
    truths = known_indices.life_truths()
    targets = {
        "log(life)": np.log(big["life"].values),
        "rank(never)": stats.rankdata(life) / len(life),
        "rate(never)": 1 / life,
        "P(never<1.0)": (life < 1.0).astype(float),
    }
    assert set(targets) == set(truths)
    for name, values in targets.items():
        for kind, of in (("S1", big["r1"]), ("ST", big["r2"] + big["r3"])):
            parts = np.array_split(np.argsort(of.values), 400)
            share = np.var([values[part].mean() for part in parts]) / values.var()
            assert truths[name][kind] == pytest.approx(
                share if kind == "S1" else 1 - share, abs=0.01
            )


def test_the_rare_jump_is_as_rare_as_it_is_said_to_be():
    u = np.random.default_rng(0).standard_normal((ROWS * 10, 3))
    hits = int((fewer_rows._jump(u) > 0).sum())
    expected = fewer_rows._jump_probability() * len(u)
    assert abs(hits - expected) < 4 * np.sqrt(expected)


def test_what_is_off_needs_a_reason():
    lines = []
    for reasons in ({}, {"mean": "a good reason"}):
        tally = Tally("a problem", reasons)
        for i in range(1000):
            tally.add("mean", 0.0, -1.0, 1.0 if i % 2 else -0.5)
            tally.add("median", 0.0, -1.0, 1.0 if i % 20 else -0.5)
            tally.add("never given", 0.0, None, np.nan)
            tally.add("mean", 0.0, 1.0, 2.0, by="somebody else")
        lines.append(tally.lines())
    assert [line.coverage[0] for line in lines[0][:2]] == [0.5, 0.95]
    assert [line.unexplained for line in lines[0]] == [True, False, False, False]
    assert not any(line.unexplained for line in lines[1])
    shown = page(lines[1], 60.0)
    assert "**mean** | uq | 50.0% (46.9% to 53.1%) | 1000 | 1.25 | a good reason |" in shown
    assert "| mean | somebody else | 0.0%" in shown
    assert "none given" in shown
    assert "\n- [Others](#others): mean (A problem), 50.0%: a good reason\n" in shown
    assert "\n| [Others](#others) | 1 | 0 | 1 |\n" in shown and "\n## Others\n" in shown


def test_each_table_of_the_page_stands_folded_in_a_chapter():
    page = Path("docs/coverage.md").read_text()
    contents = re.findall(r"^\| \[(.*?)\]\(", page, re.MULTILINE)
    chapters = re.split(r"^## ", page, flags=re.MULTILINE)[1:]
    assert list(CHAPTERS) == contents == [chapter.partition("\n")[0] for chapter in chapters]
    for title, chapter in zip(contents, chapters, strict=True):
        problems = re.findall(
            r"<summary>(.*?)(?: \([^()]* than stated\))?</summary>\n\n\|", chapter
        )
        assert {chapter_of(html.unescape(problem)) for problem in problems} == {title}
        assert len(problems) == chapter.count("\n| --- ") >= 1


@pytest.mark.parametrize(
    "name",
    [
        "plain-monte-carlo",
        "lives",
        "sobol-life",
        "shapley",
        "shapley-dependent",
        "nested-few-samples",
        "levels-two-values",
        "null-regional",
        "twin",
        "differences",
    ],
)
def test_parts_count_what_is_printed(name):
    lines = PARTS[name].count(2)
    assert all(line.repetitions == 2 for line in lines if line.by == "uq")
    assert any(line.by == "uq" and line.given == 2 for line in lines)


def test_truths_of_the_random_model_are_those_of_many_rows():
    law = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    study = problems.study_of("saltelli", 2**14, 1, noise.NAME, dict.fromkeys(("x1", "x2"), law))
    y = problems.computed(study)["y"].values.reshape(-1, 5)
    a, ab_1, ab_2, b, again = ((y - y.mean()) / y[:, [0, 3]].std()).T
    for mixed, name in ((ab_1, "x1"), (ab_2, "x2")):
        assert np.mean(b * (mixed - a)) == pytest.approx(noise.TRUTH["S1"][name], abs=0.03)
        assert np.mean((a - mixed) ** 2) / 2 == pytest.approx(noise.TRUTH["ST"][name], abs=0.03)
    assert np.mean((a - again) ** 2) / 2 == pytest.approx(noise.SHARE, abs=0.03)


def test_truths_of_the_nested_model_are_those_of_many_rows():
    more = {"units": 2, "repeats": 2}
    study = problems.study_of("monte-carlo", 50_000, 1, nested.NAME, nested.LAWS, design=more)
    ds = problems.computed(study)
    y, upper = ds["y"].values.reshape(-1, 2, 2), ds["regime"].values.reshape(-1, 2, 2)
    assert y.mean() == pytest.approx(nested.MEAN, abs=0.01)
    assert y.var() == pytest.approx(nested.VARIANCE, rel=0.02)
    assert np.mean(y > nested.RARE) == pytest.approx(1 - nested.cdf(nested.RARE), rel=0.1)
    assert np.mean(y < nested.ppf(0.05)) == pytest.approx(0.05, rel=0.05)
    shared = np.cov(y[:, 0, 0], y[:, 1, 1])[0, 1]
    both = np.cov(y[:, 0, 0], y[:, 0, 1])[0, 1]
    assert 12 * shared == pytest.approx(nested.PARTS["shared"], rel=0.05)
    assert 12 * (both - shared) == pytest.approx(nested.PARTS["own"], rel=0.1)
    assert upper.mean() == pytest.approx(nested.UPPER, abs=0.005)
    assert np.mean(upper[..., 0] != upper[..., 1]) == pytest.approx(nested.ANOTHER, abs=0.005)
