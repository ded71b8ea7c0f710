"""The command line: what it prints, what it refuses, how it ends."""

import contextlib
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import uq as api
from uq.cli import progress
from uq.cli.printing import duration, print_json
from uq.cli.progress import details, sentence
from uq.running.job import Progress
from uq.study.registry import model_names


def everything(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


def strict_json(text):
    def refuse(constant):
        raise ValueError(constant)

    return json.loads(text, parse_constant=refuse)


def test_help_lists_every_verb(uq):
    ended = uq("--help")
    assert ended.code == 0
    verbs = (
        "models simulate init check schema plan run status extend rerun verify summary "
        "sensitivity convergence compare twin rare-event plot report"
    ).split()
    listed = ended.out.partition("Commands:\n")[2]
    assert [line.split()[0] for line in listed.splitlines() if line.strip()] == verbs
    assert "..." not in listed


def test_no_argument_asks_what_to_do_next(uq, write_study, folder):
    ended = uq()
    assert (ended.code, ended.err) == (0, "")
    for step in ("uq models", "uq init beam > ", "uq check", "uq run", "uq report", "uq --help"):
        assert step in ended.out
    assert "With what is here" not in ended.out
    (folder / "studies").mkdir()
    for name in ("one", "two"):
        write_study(name=name).rename(folder / "studies" / f"{name}.toml")
    (folder / "results").mkdir()
    (folder / "results" / "my one.nc").touch()
    out = uq().out
    assert "uq run studies/one.toml" in out and "1 other in" in out
    assert "uq report 'results/my one.nc' --open" in out
    assert max(map(len, out.splitlines())) <= 80


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("uq rep", ["report"]),
        ("uq run --sam", ["--samples"]),
        ("uq models be", ["beam"]),
        ("uq simulate expo", ["exponential-wear"]),
        ("uq init nothing", []),
    ],
)
def test_a_shell_completes_verbs_options_and_models(uq, monkeypatch, typed, completed):
    monkeypatch.setenv("_UQ_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    ended = uq()
    assert (ended.code, ended.out.split(), ended.err) == (0, completed, "")
    monkeypatch.setenv("_UQ_COMPLETE", "source_bash")
    assert "complete -o default -F _uq_completion uq" in uq().out


def test_models_are_listed(uq):
    ended = uq("models")
    assert ended.code == 0
    listed = strict_json(uq("models", "--json").out)
    assert {"name", "version", "title"} == set(listed[0])
    for entry in listed:
        assert f"\n{entry['name']} " in ended.out
    assert {"beam", "ishigami", "g-function", "linear", "exponential-wear"} <= {
        entry["name"] for entry in listed
    }


def test_one_model_is_shown_in_full(uq):
    shown = uq("models", "linear").out
    line = "x1    x_1     0.5      0 to 1"
    for words in (line, "fail_how", "one of nan, inf, raise, shape", "y"):
        assert words in shown
    described = strict_json(uq("models", "linear", "--json").out)
    assert described["parameters"]["x1"] == {
        "nominal": 0.5,
        "symbol": "x_1",
        "unit": "1",
        "meaning": "independent input",
        "bounds": [0.0, 1.0],
        "source": "definition of the function",
    }
    assert described["settings"]["fail_how"]["default"] == "nan"
    assert described["outputs"]["y"]["unit"] == "1"
    assert uq("models", "liner").err.startswith("no such model 'liner'; did you mean 'linear'?")


def test_a_parameter_may_be_infinite_unless_given(uq):
    assert "k       inf N m-1  10000 to inf" in uq("models", "sample_models:MOUNTED").out
    described = strict_json(uq("models", "sample_models:MOUNTED", "--json").out)
    shown = described["parameters"]["mount_stiffness"]
    assert (shown["nominal"], shown["bounds"]) == (None, [1e4, None])
    found = strict_json(uq("simulate", "sample_models:MOUNTED", "--json").out)
    assert found["inputs"] == {"mount_stiffness": None, "mass": 2.0}
    nominal = uq("simulate", "sample_models:MOUNTED")
    assert nominal.code == 0
    assert nominal == uq("simulate", "sample_models:MOUNTED", "--set", "mount_stiffness=inf")
    softer = uq("simulate", "sample_models:MOUNTED", "--set", "mount_stiffness=1e5")
    assert softer.out != nominal.out


@pytest.mark.parametrize("name", model_names())
def test_every_model_can_be_told_as_json(uq, name):
    described = strict_json(uq("models", name, "--json").out)
    assert described["name"] == name
    assert list(described) == [
        "name",
        "version",
        "title",
        "parameters",
        "settings",
        "outputs",
        "coordinates",
        "references",
    ]


def test_simulate_prints_values_with_units_and_meaning(uq):
    ended = uq("simulate", "exponential-wear", "--set", "depth=1e-3")
    assert ended.code == 0
    for words in ("life [s]", "time until the depth is reached", "4e+06", "46.3 days"):
        assert words in ended.out
    assert "never" in uq("simulate", "exponential-wear", "--set", "threshold=1").out


def simulate(uq, *arguments):
    ended = uq("simulate", "sample_models:KINDS", "--json", *arguments)
    return ended.code, strict_json(ended.out)


def test_simulate_as_json(uq):
    code, found = simulate(uq, "--set", "x1=0.1", "--set", "x2=0.1")
    assert code == 0
    assert found == {
        "model": "kinds",
        "inputs": {"x1": 0.1, "x2": 0.1},
        "outputs": {
            "work": [0.1, 0.1],
            "life": [[None, None], [None, None]],
            "angle": None,
            "regime": "slow",
        },
        "status": {"code": "ok", "meaning": "The row was computed."},
        "never": [f"life[side={s},depth={d}]" for s in ("left", "right") for d in (0.5, 1.5)],
        "censored": [],
        "undefined": ["angle"],
    }
    code, found = simulate(uq, "--set", f"x1={1 / 1.1!r}")
    assert code == 0
    assert found["outputs"]["life"][0][0] == 1 / 1.1 + 0.5
    assert len(found["censored"]) == 4
    assert found["never"] == found["undefined"] == []


def test_a_failed_row_is_told(uq):
    faults = ("--set", "x1=0.9", "--setting", "fail_above=0.5", "--setting", "fail_how=raise")
    ended = uq("simulate", "linear", *faults)
    assert ended.code == 1
    assert "raised" in ended.out
    assert "ValueError: x1 is above fail_above = 0.5" in ended.out
    found = strict_json(uq("simulate", "linear", "--json", *faults).out)
    assert found["outputs"] == {"y": None}
    assert found["undefined"] == []
    assert found["status"] == {
        "code": "raised",
        "meaning": "ValueError: x1 is above fail_above = 0.5",
    }


def test_a_trajectory_is_written_and_drawn(uq, folder):
    ended = uq("simulate", "sample_models:KINDS", "-o", "t.nc", "--plot", "t.png")
    assert ended.code == 0
    with xr.open_dataset("t.nc") as ds:
        assert ds["trajectory"].dims == ("time", "quantity")
    assert Path("t.png").read_bytes().startswith(b"\x89PNG")
    assert everything(folder) == ["t.nc", "t.png"]


def test_a_trajectory_overwrites_nothing_but_a_trajectory(uq, write_study, folder):
    uq("run", write_study(), "-o", "study.nc", "--quiet")
    xr.Dataset({"trajectory": ("time", [0.0, 1.0])}).to_netcdf("foreign.nc")
    api.simulate("linear").to_netcdf("row.nc")
    Path("notes.txt").write_text("precious")
    Path("empty").touch()
    for path in sorted(folder.iterdir()):
        before = path.read_bytes()
        ended = uq("simulate", "sample_models:KINDS", "-o", path.name)
        assert (ended.code, ended.out) == (2, "")
        assert ended.err == (
            f"{path.name}: exists, and is no trajectory of 'uq simulate'; choose another name\n"
        )
        assert path.read_bytes() == before

    for place in ("0.25", "0.5"):
        ended = uq("simulate", "sample_models:KINDS", "-o", "t.nc", "--set", f"x1={place}")
        assert (ended.code, ended.err) == (0, "")
        with xr.open_dataset("t.nc") as ds:
            assert ds["x1"] == float(place)


def test_init_gives_a_study_that_checks_and_runs(uq, folder):
    Path("linear.toml").write_text(uq("init", "linear").out)
    ended = uq("check", "linear.toml")
    assert ended.code == 0
    assert ended.out.startswith("linear.toml: in order")
    assert everything(folder) == ["linear.toml"]


def test_check_says_what_would_run(uq, write_study):
    path = write_study(method="saltelli", samples=16, replicates=3)
    ended = uq("check", path)
    assert ended.code == 0
    assert "240 = 16 samples x 3 replicates x 5 rows each" in ended.out
    assert "uniform(lower = 0.1, upper = 0.9)" in ended.out


def test_the_schema_is_json(uq):
    schema = strict_json(uq("schema").out)
    assert {"study", "design", "uncertain", "analysis"} <= set(schema["properties"])


def test_run_ends_with_the_summary_and_what_to_type_next(uq, write_study, folder):
    path = write_study(samples=300)
    first = uq("run", path)
    assert (first.code, first.err) == (0, "")
    assert "results/small.nc: 300 rows in" in first.out
    assert "uq sensitivity results/small.nc" in first.out
    shown = uq("summary", "results/small.nc").out
    assert shown in first.out
    again = uq("run", path)
    assert again.code == 0
    assert "complete already" in again.out
    assert shown in again.out
    assert everything(folder) == ["results", "results/small.nc", "small.toml"]


def test_quiet_means_quiet(uq, write_study):
    ended = uq("run", write_study(), "--quiet")
    assert ended == (0, "", "")


def test_samples_can_be_set_for_one_run(uq, write_study):
    path = write_study(method="sobol", samples=8)
    assert uq("run", path, "--samples", "32", "-o", "out.nc", "--quiet").code == 0
    assert api.open_result("out.nc").sizes["sample"] == 32
    ended = uq("run", path, "--samples", "33", "-o", "out.nc")
    assert ended.code == 2
    assert "must be a power of two; the next is 64" in ended.err


def test_too_many_failed_rows_are_an_exit_code_and_a_sentence(uq, write_study, folder):
    def ended(how, share):
        path = write_study(
            model="linear",
            samples=400,
            more=f'[settings]\nfail_above = 0.5\nfail_how = "{how}"\n'
            f"[analysis]\nmax_failed = {share}",
        )
        return uq("run", path, "--fresh")

    bad = ended("raise", 0.1)
    assert bad.code == 1
    assert bad.err.count("\n") == 1
    assert "of 400 rows failed, more than max_failed = 0.1 allows (raised: row " in bad.err
    assert Path("results/small.nc").exists()
    assert ended("nan", 0.9).code == 0


def test_lives_fits_and_regimes_are_shown(uq, folder):
    from computed import kinds, linear, with_output

    life = 1e5 * linear(samples=300)["x1"].values ** 0.5
    ds = with_output(linear(samples=300), "life", life, "lifetime")
    ds.to_netcdf("life.nc")
    shown = uq("summary", "life.nc", "--fits").out
    assert "B10" in shown and "lognormal: does not fit" in shown and "variance between" not in shown
    assert (
        "fits" in strict_json(uq("summary", "life.nc", "--fits", "--json").out)["outputs"]["life"]
    )
    kinds(samples=200).to_netcdf("kinds.nc")
    assert "variance between regimes" in uq("summary", "kinds.nc").out
    fast = strict_json(uq("summary", "kinds.nc", "--regime", "fast", "--json").out)
    assert fast["regime"]["slow"]["count"] == 0 < fast["regime"]["fast"]["count"]
    regional = uq("sensitivity", "kinds.nc", "--method", "regional", "--output", "regime")
    assert regional.code == 0 and "P(regime=fast)" in regional.out and "KS" in regional.out
    assert "Sensitivity by delta" in uq("sensitivity", "kinds.nc", "--regime", "fast").out
    wrong = uq("summary", "kinds.nc", "--regime", "fats")
    assert wrong.code == 2 and "did you mean 'fast'" in wrong.err


def test_summary_and_sensitivity_as_json(uq, write_study):
    uq("run", write_study(method="saltelli", samples=16, replicates=4), "-o", "out.nc", "--quiet")
    summary = strict_json(uq("summary", "out.nc", "--json").out)
    assert summary["samples"] == 320
    assert set(summary["outputs"]["y"]["quantiles"]) == {"0.05", "0.5", "0.95"}
    indices = strict_json(uq("sensitivity", "out.nc", "--json").out)
    assert indices["method"] == "sobol"
    assert set(indices["outputs"]["y"]["ST"]) == {"x1", "x2", "x3"}
    shown = uq("sensitivity", "out.nc")
    assert shown.code == 0
    assert "Sensitivity by sobol" in shown.out


def test_plot_draws_beside_the_result(uq, write_study, folder):
    uq("run", write_study(), "-o", "out.nc", "--quiet")
    ended = uq("plot", "out.nc")
    assert ended.code == 0
    drawn = ended.out.splitlines()
    assert drawn
    for name in drawn:
        assert (folder / name).is_relative_to(folder / "out")
        assert Path(name).stat().st_size > 1000


@pytest.mark.parametrize(
    "verb", [("models", "beam"), ("check",), ("summary",), ("sensitivity",), ("simulate", "beam")]
)
def test_tables_fit_in_80_columns(uq, write_study, verb):
    if verb[0] in ("check", "summary", "sensitivity"):
        path = write_study(
            model="kinds", method="saltelli", replicates=4, uncertain=("x1", "x2"), samples=16
        )
        api.run(api.load_study(path, "sample_models:KINDS"), "out.nc")
        verb += (path, "--model", "sample_models:KINDS") if verb[0] == "check" else ("out.nc",)
    ended = uq(*verb)
    assert ended.code == 0
    assert max(map(len, ended.out.splitlines())) <= 80
    assert "\x1b" not in ended.out


MISTAKES = {
    "sumary": "uq: No such command 'sumary'. Did you mean 'summary'? See 'uq --help'",
    "run": "uq: Missing argument 'STUDY'; see 'uq run --help'",
    "run a.toml --sampels 3": "uq: No such option: --sampels; did you mean '--samples'?",
    "run a.toml --workers -1": "uq: Invalid value for '--workers': ",
    "run a.toml --samples many": "uq: Invalid value for '--samples': ",
    "run absent.toml": "absent.toml: no such file",
    "run .": ".: is a directory",
    "run broken.toml": "broken.toml: not valid TOML: ",
    "run small.toml --model nowhere:M": "--model nowhere:M cannot be imported",
    "run small.toml -o folder": "folder: is a folder; give the name of a file in it",
    "run small.toml -o /proc/x.nc": "/proc/x.nc: cannot write in /proc: ",
    "run small.toml -o broken.toml": "broken.toml: not a readable netCDF file; ",
    "run small.toml --workers 1 --scheduler tcp://x:1": "workers and scheduler exclude each other",
    "simulate ishigamy": "no such model 'ishigamy'; did you mean 'ishigami'?",
    "simulate linear --set x1": "--set x1: write it as NAME=VALUE with a number",
    "simulate linear --set x1=-1e400": (
        "--set x1=-1e400: -1e400 is too large for a number; write it as inf if infinity is meant\n"
    ),
    "simulate beam --setting horizon=1e400": "--setting horizon=1e400: 1e400 is too large",
    "simulate linear --set x1=much": "--set x1=much: write it as NAME=VALUE with a number",
    "simulate linear --set x1=nan": "x1 = nan: ",
    "simulate linear --set x1=inf": "x1 = inf: must lie within 0.0 to 1.0 [1]",
    "simulate sample_models:MOUNTED --set mount_stiffness=1e3": (
        "mount_stiffness = 1000.0: must lie within 10000.0 to inf [N m-1]"
    ),
    "simulate linear --set x5=1": "x5 = 1.0: no such parameter of model 'linear'",
    "simulate linear --setting fail_how": "--setting fail_how: write it as NAME=VALUE",
    "simulate linear --setting fail_how=3": "setting fail_how = 3: must be one of nan, inf",
    "simulate vibrator --setting body_points=[[1.0,0.2,0.3]]": (
        "setting body_points = [[1.0, 0.2, 0.3]]: must be a list, each a list of 2, each a number "
        "within -30.0 to 30.0 [m]\n"
    ),
    "simulate linear --plot f.png": "model 'linear' gives no trajectory",
    "simulate sample_models:KINDS -o folder": "folder: is a folder",
    "simulate sample_models:KINDS --plot /proc/f.png": "/proc/f.png: cannot write in /proc: ",
    "simulate sample_models:KINDS --plot f.xyz": "f.xyz: Format 'xyz' is not supported",
    "models nothing": "no such model 'nothing'",
    "init nothing": "no such model 'nothing'",
    "check absent.toml": "absent.toml: no such file",
    "summary absent.nc": "absent.nc: no such file",
    "summary small.toml": "small.toml: not a readable netCDF file",
    "sensitivity folder": "folder: is a folder, not a result",
    "plot absent.nc": "absent.nc: no such file",
}


NEXT_STEP = re.compile(
    r"[Dd]id you mean|[Ss]ee '|must |allowed: |installed: |choose |give |write it |leave out"
    r"|'uq run STUDY'|'uq init |install it|exclude each other|a study is a TOML file"
    r"|supported formats|at line \d+, column"
)
"""What a line says that can be done, or what would be right."""


@pytest.mark.parametrize("line", MISTAKES)
def test_a_mistake_is_one_line_and_leaves_nothing_behind(uq, write_study, folder, line):
    write_study()
    (folder / "folder").mkdir()
    (folder / "broken.toml").write_text("[study\n")
    ended = uq(*line.split())
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(MISTAKES[line])
    assert ended.err.count("\n") == 1 and NEXT_STEP.search(ended.err)
    assert everything(folder) == ["broken.toml", "folder", "small.toml"]


def test_a_wrong_model_of_ones_own_is_one_line(uq, write_study, folder):
    path = write_study(model="x", uncertain=("x1",))
    ended = uq("run", path, "--model", "sample_models:WRONG_DTYPE")
    assert ended.code == 2
    assert ended.err == "model 'wrong-dtype': 'y' is float32, expected float64\n"
    assert everything(folder) == ["small.toml"]


@pytest.mark.parametrize("verb", [("schema",), ("models", "linear"), ("init", "linear")])
def test_a_reader_that_has_enough_is_no_error(verb):
    command = Path(sys.executable).with_name("uq")
    nobody, pipe = os.pipe()
    os.close(nobody)
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    ended = subprocess.run(
        [command, *verb],
        stdout=pipe,
        stderr=subprocess.PIPE,
        text=True,
        env=buffered,
        timeout=60,
    )
    os.close(pipe)
    assert (ended.returncode, ended.stderr) == (1, "")


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (None, ""),
        (3599.0, ""),
        (7200.0, "2 hours"),
        (-7200.0, "-2 hours"),
        (86400.0 * 3, "3 days"),
        (86400.0 * 365.25 * 40, "40 years"),
        (float("inf"), ""),
    ],
)
def test_times_in_words(seconds, words):
    assert duration(seconds) == words


def test_json_knows_only_finite_numbers():
    with pytest.raises(ValueError, match="not JSON compliant"):
        print_json({"a": float("nan")})


MUCH = Progress(
    123_456_789,
    1_000_000_000,
    4_567,
    status={"ok": 1, "non-finite": 123_456_789, "raised": 1_234_567},
    median=("a_life_with_a_name[depth=2]", 1e9),
    shares={f"regime-with-a-long-name-{i}": 0.2 for i in range(5)},
    dashboard="http://127.0.0.1:8787/status",
)


def test_progress_tells_how_rows_ended_and_what_they_say():
    told = details(
        Progress(
            300,
            400,
            3,
            status={"ok": 290, "raised": 3, "out-of-budget": 7},
            median=("life[site=left]", 5 * 86400.0),
            shares={"slow": 0.625, "fast": 0.375},
        )
    )
    assert told == [
        "raised 3, out-of-budget 7",
        "median life[site=left]: 5 days",
        "slow 62%, fast 38%",
    ]
    assert details(Progress(1, 2, 0)) == []
    never, short = ("other", float("inf")), ("short", 0.25)
    assert details(Progress(1, 2, 0, median=never)) == ["median other: most rows do not end"]
    assert details(Progress(1, 2, 0, median=short)) == ["median short: 0.25 s"]


def test_progress_of_a_run_counts_and_glances_at_its_rows(folder, write_study):
    path = write_study(model="kinds", uncertain=("x1", "x2"), samples=200)
    seen = []
    study = api.load_study(path, "sample_models:KINDS")
    options = {"workers": 0, "chunk_rows": 50, "progress": seen.append}
    ds = api.run(study, "out.nc", **options)
    last = seen[-1]
    assert (last.done, sum(last.status.values())) == (200, 200)
    lives = np.where(ds["life_censored"], np.inf, ds["life"]).reshape(200, -1)[:, 0]
    label, median = last.median
    assert label == "life[side=left,depth=0.5]"
    assert np.quantile(lives, 0.49) <= median <= np.quantile(lives, 0.51)
    slow = float((ds["regime"] == 0).mean())
    assert last.shares == pytest.approx({"slow": slow, "fast": 1 - slow})


def test_progress_tells_of_no_life_that_the_study_does_not_show(folder, write_study):
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
            for one in (compiling, MUCH):
                show(one)
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
    assert lines[-1].endswith("0:00 left, 1 failed; raised 1")


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
    assert lines[3].endswith("failed; median life: 1 s; slow 25%, fast 75%")


def test_a_model_that_compiles_is_told_of_once(capsys):
    with progress.shown(quiet=False) as show:
        for _ in range(3):  # one kernel after the other
            show(Progress(0, 4, 0, compiling=True))
    assert capsys.readouterr().err == "compiling the model: once, and it may take a minute\n"


def test_progress_is_a_sentence():
    assert sentence(Progress(100, 400, 3), 50.0) == (
        "100 of 400 rows, 50 rows/s, 0:06 left, 3 failed"
    )
    assert sentence(Progress(1, 3601, 0), 1.0).endswith("1:00:00 left, 0 failed")


def test_the_time_that_a_model_compiles_is_not_taken_for_that_of_its_rows():
    pace = progress.Pace()
    assert pace(Progress(10, 400, 0), 60.0) == 0.0
    assert sentence(Progress(10, 400, 0), 0.0) == "10 of 400 rows, 0 failed"
    assert pace(Progress(110, 400, 0), 62.0) == pytest.approx(50.0)
