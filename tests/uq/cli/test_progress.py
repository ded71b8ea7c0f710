"""How far a run is: what is counted, what is said of it, and that it fits where it is shown."""

import contextlib
import os
import re
import sys
import time

import numpy as np
import pytest
from wordings import sentence

import uq as api
from uq.cli import progress
from uq.cli.progress import details
from uq.execution.executor import Progress

MUCH = Progress(
    123_456_789,
    1_000_000_000,
    4_567,
    status={"ok": 1, "non-finite": 123_456_789, "raised": 1_234_567},
    median=("a_life_with_a_name[depth=2]", 1e9),
    shares={f"regime-with-a-long-name-{i}": 0.2 for i in range(5)},
    dashboard="http://127.0.0.1:8787/status",
)


def test_progress_reports_how_rows_ended_and_what_they_give():
    lines = details(
        Progress(
            300,
            400,
            3,
            status={"ok": 290, "raised": 3, "out-of-budget": 7},
            median=("life[site=left]", 5 * 86400.0),
            shares={"slow": 0.625, "fast": 0.375},
        )
    )
    assert lines == [
        "raised 3, out-of-budget 7",
        "median life[site=left]: 5 days",
        "slow 62%, fast 38%",
    ]
    assert details(Progress(1, 2, 0)) == []
    never, short = ("other", float("inf")), ("short", 0.25)
    assert details(Progress(1, 2, 0, median=never)) == ["median other: most rows never end"]
    assert details(Progress(1, 2, 0, median=short)) == ["median short: 0.25 s"]


def test_progress_of_a_run_counts_and_glances_at_its_rows(folder, write_study):
    path = write_study(model="kinds", uncertain=("x1", "x2"), samples=200)
    seen = []
    study = api.load_study(path, "sample_models:KINDS")
    options = {"workers": 0, "chunk_rows": 50, "progress": seen.append}
    ds = api.run(study, "out.nc", **options)
    first, last = seen[0], seen[-1]
    assert (first.done, first.under_way) == (0, 50)  # a row may take minutes
    assert (last.done, sum(last.status.values())) == (200, 200)
    lives = np.where(ds["life_censored"], np.inf, ds["life"]).reshape(200, -1)[:, 0]
    label, median = last.median
    assert label == "life[side=left,depth=0.5]"
    assert np.quantile(lives, 0.49) <= median <= np.quantile(lives, 0.51)
    slow = float((ds["regime"] == 0).mean())
    assert last.shares == pytest.approx({"slow": slow, "fast": 1 - slow})


def test_progress_reports_no_life_that_the_study_does_not_show(folder, write_study):
    more = '[analysis]\noutputs = ["work"]'
    path = write_study(model="kinds", uncertain=("x1", "x2"), samples=20, more=more)
    seen = []
    api.run(api.load_study(path, "sample_models:KINDS"), workers=0, progress=seen.append)
    assert seen[-1].done == 20 and seen[-1].median is None


def test_a_terminal_of_80_columns_holds_the_progress(monkeypatch):
    ours, theirs = os.openpty()
    compiling = Progress(0, 1_000_000_000, 0, compiling=True)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress.shown(quiet=False) as show:
            for progress_text in (compiling, MUCH):
                show(progress_text)
                time.sleep(0.5)
    out = b""
    with contextlib.suppress(OSError):
        while more := os.read(ours, 65_536):
            out += more
    os.close(ours)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", out.decode())
    lines = re.split(r"[\r\n]+", text)
    assert max(map(len, lines)) <= 80
    for words in (
        "compiling the model",
        "123456789 of 1000000000 rows",
        "non-finite 123456789",
        "31.7 years",
        "status",
    ):
        assert any(words in line for line in lines), words


def test_without_a_terminal_progress_is_plain_lines(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_PLAIN_SECONDS", 0.0)
    with progress.shown(quiet=False) as show:
        show(Progress(1, 4, 1, status={"ok": 0, "raised": 1}, dashboard="http://there/status"))
        show(Progress(4, 4, 1, status={"ok": 3, "raised": 1}, dashboard="http://there/status"))
    first, *lines = capsys.readouterr().err.splitlines()
    assert first == "dask dashboard: http://there/status"
    assert [line.partition(" rows")[0] for line in lines] == ["1 of 4", "4 of 4"]
    assert lines[-1].endswith("less than 1 min left, 1 invalid; raised 1")


def test_quiet_is_quiet(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_PLAIN_SECONDS", 0.0)
    with progress.shown(quiet=True) as show:
        show(Progress(0, 4, 0, compiling=True))
        show(MUCH)
    assert capsys.readouterr() == ("", "")


def test_plain_lines_stay_short(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_PLAIN_SECONDS", 0.0)
    with progress.shown(quiet=False) as show:
        show(MUCH._replace(done=0))
        show(MUCH)
        show(MUCH._replace(status={}))
        show(Progress(1, 4, 0, median=("life", 1.0), shares={"slow": 0.25, "fast": 0.75}))
    _, *lines = capsys.readouterr().err.splitlines()
    assert max(map(len, lines)) <= 120
    assert lines[1].endswith("; non-finite 123456789, raised 1234567")
    assert lines[2].endswith("; median a_life_with_a_name[depth=2]: 31.7 years")
    assert lines[3].endswith("invalid; median life: 1 s; slow 25%, fast 75%")


def test_a_model_that_compiles_is_reported_once(capsys):
    with progress.shown(quiet=False) as show:
        for _ in range(3):  # one kernel after the other
            show(Progress(0, 4, 0, compiling=True))
    assert capsys.readouterr().err == sentence("compiling") + "\n"


def test_progress_is_a_sentence():
    assert progress.sentence(Progress(100, 400, 3), 50.0) == (
        "100 of 400 rows, 50 rows/s, less than 1 min left, 3 invalid"
    )
    assert progress.sentence(Progress(1, 3601, 0), 1.0).endswith("about 1 h left, 0 invalid")
    under_way = Progress(3, 40, 0, under_way=2)
    assert progress.sentence(under_way, 0.0) == "3 of 40 rows, 2 under way, 0 invalid"


def test_the_time_that_a_model_compiles_is_not_taken_for_that_of_its_rows():
    pace = progress.Pace()
    assert pace(Progress(10, 400, 0), 60.0) == 0.0
    assert progress.sentence(Progress(10, 400, 0), 0.0) == "10 of 400 rows, 0 invalid"
    assert pace(Progress(110, 400, 0), 62.0) == pytest.approx(50.0)


def test_the_pace_of_slow_rows_counts_from_the_start():
    pace = progress.Pace()
    assert pace(Progress(0, 8, 0, under_way=2), 2.0) == 0.0
    assert pace(Progress(1, 8, 0, under_way=2), 32.0) == pytest.approx(1 / 30)
    assert pace(Progress(2, 8, 0, under_way=2), 32.1) == pytest.approx(2 / 30.1)


def test_the_pace_of_fast_rows_counts_from_the_first():
    pace = progress.Pace()
    assert pace(Progress(5, 400, 0, reused=5), 2.0) == 0.0
    assert pace(Progress(6, 400, 0, reused=5), 4.0) == 0.0
    assert pace(Progress(106, 400, 0, reused=5), 6.0) == pytest.approx(50.0)


def test_the_time_left_runs_down_between_rows():
    slow = Progress(2, 8, 0, under_way=2)
    assert "about 3 min left" in progress.sentence(slow, 2 / 60)
    assert "about 2 min left" in progress.sentence(slow, 2 / 60, since=60.0)
    assert "less than 1 min left" in progress.sentence(slow, 2 / 60, since=200.0)


@pytest.mark.parametrize("seed", range(20))
def test_the_time_left_is_right_within_a_factor_of_two(seed):
    """Rows of unequal length come in chunks from two workers, which take a minute to start."""
    rng = np.random.default_rng(seed)
    rows, chunk, start = 6016, 60, 60.0
    seconds = 0.05 * rng.lognormal(0, 1.0, rows - 16).reshape(-1, chunk).sum(axis=1)
    free, arrivals = [start, start], []
    for taken in seconds:
        worker = int(np.argmin(free))
        free[worker] += taken
        arrivals.append(free[worker])
    pace, done, end = progress.Pace(), 16, max(arrivals)
    pace(Progress(0, rows, 0, under_way=done), 0.0)
    # The first rows come from this process, which has to load the model.
    assert pace(Progress(done, rows, 0), 20.0) == 0
    pace(Progress(done, rows, 0, under_way=2 * chunk), start)
    for now in sorted(arrivals):
        done += chunk
        rate = pace(Progress(done, rows, 0, under_way=min(2 * chunk, rows - done)), now)
        if done > 500 and end - now > 0.1 * (end - start):
            assert 0.5 < (rows - done) / rate / (end - now) < 2


def test_a_run_that_slows_down_is_noticed():
    pace = progress.Pace()
    for now in range(61):
        pace(Progress(100 * now, 20_000, 0), now)
    for now in range(61, 181):
        rate = pace(Progress(6000 + 10 * (now - 60), 20_000, 0), now)
    assert rate == pytest.approx(10, rel=0.05)
