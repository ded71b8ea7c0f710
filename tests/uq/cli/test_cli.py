"""The command line: what it prints and where, verb by verb."""

import json
import os
import shlex
import time
from math import inf, nan
from pathlib import Path

import pytest
from command_line import everything, strict_json
from wordings import sentence

import uq as api
from uq.cli.printing import print_json

STUDIES = Path(__file__).parents[3] / "studies"
GROUPS = {
    "Start": "models init simulate import schema serve",
    "Run": "plan run status extend next-rows rerun",
    "Read": "summary sensitivity levels twin emulate export plot report",
    "Decide": "compare what-if fleet rare-event",
    "Learn": "update next-inspection",
    "Check": "check convergence verify row trace",
}


@pytest.mark.parametrize("option", ["--help", "-h"])
def test_help_lists_every_verb_in_its_group(uq, option):
    ended = uq(option)
    assert ended.code == 0
    listed, heading = {}, ""
    for line in ended.out.splitlines():
        if line.startswith("  "):
            listed.setdefault(heading, []).append(line.split()[0])
        else:
            heading = line.rstrip(":")
    assert {heading: " ".join(listed[heading]) for heading in GROUPS} == GROUPS
    assert list(listed)[-len(GROUPS) :] == list(GROUPS)
    assert "..." not in ended.out.partition("\nStart:")[2]
    assert max(map(len, ended.out.splitlines())) <= 80


@pytest.mark.parametrize("verb", " ".join(GROUPS.values()).split())
def test_the_help_of_a_verb_ends_with_an_example_that_parses(uq, verb):
    import typer

    from uq.cli.app import app

    ended = uq(verb, "-h")
    assert ended == uq(verb, "--help") and ended.code == 0
    assert max(map(len, ended.out.splitlines())) <= 80
    example = ended.out.partition("  Example:\n")[2].strip()
    name, given, *arguments = shlex.split(example.partition(" > ")[0])
    assert (name, given, example.count("\n")) == ("uq", verb, 0)
    typer.main.get_command(app).commands[verb].make_context(verb, arguments)


def test_the_example_of_next_rows_is_a_study_with_independent_rows(uq):
    example = shlex.split(uq("next-rows", "--help").out.partition("  Example:\n")[2].strip())
    study = api.load_study(STUDIES / f"{Path(example[2]).stem}.toml")
    assert study.design.method == "monte-carlo"
    assert example[example.index("--output") + 1] in study.analysis.outputs


def test_no_argument_asks_what_to_do_next(uq, write_study, folder):
    ended = uq()
    assert (ended.code, ended.err) == (0, "")
    for step in ("uq models", "uq init beam > ", "uq check", "uq run", "uq report", "uq --help"):
        assert step in ended.out
    assert "In this folder" not in ended.out
    (folder / "studies").mkdir()
    for name, more in (("longer", "# more"), ("one", "")):
        write_study(name=name, more=more).rename(folder / "studies" / f"{name}.toml")
    (folder / "results").mkdir()
    (folder / "results" / "my one.nc").touch()
    out = uq().out
    assert "uq run studies/one.toml" in out and "1 other in" in out
    assert "uq report 'results/my one.nc' --open" in out
    assert max(map(len, out.splitlines())) <= 80
    os.utime("studies/longer.toml", (later := time.time() + 600, later))
    assert "uq run studies/longer.toml" in uq().out  # the last one that was edited


def test_init_gives_a_study_that_checks_and_runs(uq, folder):
    Path("linear.toml").write_text(uq("init", "linear").out)
    ended = uq("check", "linear.toml")
    assert ended.code == 0
    assert ended.out.startswith("linear.toml: valid")
    assert everything(folder) == ["linear.toml"]


def test_check_shows_thresholds_and_values_that_do_not_vary(uq, folder):
    folder.joinpath("pads.toml").write_text(
        """
        study = {name = "pads", model = "exponential-wear"}
        design = {method = "monte-carlo", samples = 200}
        fixed = {depth = 2e-3}
        uncertain = {rate = {distribution = "lognormal", mean = 1e-9, cv = 0.2}}
        [analysis]
        thresholds = {life = ["24 hours", "2 days"]}
        tolerance = {coverage = 0.9, confidence = 0.95}
        """
    )
    text = " ".join(uq("check", "pads.toml").out.split())
    assert "life: 24 hours, 2 days" in text
    assert "cover 90 % with 95 % confidence" in text
    assert "Fixed values, of the study depth = 2 mm" in text
    assert "Fixed values, nominal threshold = 0 m s⁻¹" in text


def test_check_says_what_would_run(uq, write_study):
    path = write_study(method="saltelli", samples=16, replicates=3)
    ended = uq("check", path)
    assert ended.code == 0
    assert "240 = 16 samples x 3 replicates x 5 rows each" in ended.out
    assert "uq plan " in ended.out
    assert "uniform(lower = 0.1, upper = 0.9)" in ended.out


def test_the_schema_is_json(uq):
    schema = strict_json(uq("schema").out)
    assert {"study", "design", "uncertain", "analysis"} <= set(schema["properties"])


def test_run_ends_with_the_card(uq, write_study, folder):
    path = write_study(samples=300)
    first = uq("run", path)
    assert (first.code, first.err) == (0, "")
    assert "results/small.nc: 300 rows computed in" in first.out
    assert "uq report results/small.nc --open" in first.out
    shown = uq("summary", "results/small.nc").out
    assert first.out.endswith(f"\n\n{shown}")
    again = uq("run", path)
    assert again.code == 0
    assert "already complete" in again.out
    assert again.out.endswith(f"\n\n{shown}")
    assert everything(folder) == ["results", "results/small.nc", "small.toml"]


def test_quiet_means_quiet(uq, write_study):
    ended = uq("run", write_study(), "--quiet", "--workers", 0)
    assert ended == (0, "", "")


def test_samples_can_be_set_for_one_run(uq, write_study):
    path = write_study(method="sobol", samples=8)
    assert uq("run", path, "--samples", "32", "-o", "out.nc", "--quiet", "--workers", 0).code == 0
    assert api.open_result("out.nc").sizes["row"] == 32
    ended = uq("run", path, "--samples", "33", "-o", "out.nc")
    assert ended.code == 2
    assert sentence("size", least=32, next=64) in ended.err


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
    assert "of 400 " + sentence("too many failed", share=0.1, status="raised") in bad.err
    assert Path("results/small.nc").exists()
    assert ended("nan", 0.9).code == 0


def test_lives_fits_and_regimes_are_shown(uq, folder):
    from computed import kinds, linear, with_output

    life = 1e5 * linear(samples=300)["x1"].values ** 0.5
    ds = with_output(linear(samples=300), "life", life, "lifetime")
    ds.to_netcdf("life.nc")
    shown = uq("summary", "life.nc", "--fits").out
    assert "B10" in shown and "lognormal: rejected" in shown and "variance between" not in shown
    assert (
        "fits" in strict_json(uq("summary", "life.nc", "--fits", "--json").out)["outputs"]["life"]
    )
    kinds(samples=200).to_netcdf("kinds.nc")
    assert "variance between regimes" in uq("summary", "kinds.nc", "--explain", "--full").out
    fast = strict_json(uq("summary", "kinds.nc", "--regime", "fast", "--json").out)
    assert fast["regime"]["slow"]["count"] == 0 < fast["regime"]["fast"]["count"]
    regional = uq("sensitivity", "kinds.nc", "--method", "regional", "--output", "regime")
    assert regional.code == 0 and "P(regime=fast)" in regional.out and "KS" in regional.out
    assert "Sensitivity by delta" in uq("sensitivity", "kinds.nc", "--regime", "fast").out
    wrong = uq("summary", "kinds.nc", "--regime", "fats")
    assert wrong.code == 2 and "did you mean 'fast'" in wrong.err


def test_summary_and_sensitivity_as_json(uq, write_study):
    uq(
        "run",
        write_study(method="saltelli", samples=16, replicates=4),
        "-o",
        "out.nc",
        "--quiet",
        "--workers",
        0,
    )
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
    uq("run", write_study(), "-o", "out.nc", "--quiet", "--workers", 0)
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


def test_a_number_that_is_not_finite_is_null_in_json(capsys):
    print_json({"a": [nan, (inf,), 1.5]})
    assert json.loads(capsys.readouterr().out) == {"a": [None, [None], 1.5]}
