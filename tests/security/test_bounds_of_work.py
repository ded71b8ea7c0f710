"""What a file asks for is bounded, and whatever was not foreseen ends in one line."""

import os
import stat
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from own_machines import PAD

from models.numerics import cache
from uq.cli import app
from uq.errors import InputError
from uq.execution import runner
from uq.machines import program_outputs
from uq.machines.machine_file import OutputTable, filled, read_machine
from uq.machines.program_outputs import value_in
from uq.machines.returned import RowError
from uq.render.figures.figure import replaced
from uq.result.result_file import open_result
from uq.stats.quantile_functions import negative_binomial


def test_a_rare_share_is_found_in_few_steps(monkeypatch):
    from uq.stats import quantile_functions as functions

    steps = []
    distribution = functions.special.nbdtr

    class Far:
        betainc = staticmethod(functions.special.betainc)
        nbdtr = staticmethod(lambda *given: steps.append(given) or distribution(*given))
        nbdtrik = staticmethod(lambda *given: 0.0)  # as far off as it may be

    monkeypatch.setattr(functions, "special", Far)
    assert negative_binomial(0.95, 1, 0.05) + 1 == 59
    assert negative_binomial(0.9, 1, 1e-9) == pytest.approx(2.302585e9, rel=1e-6)
    assert len(steps) < 200


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("tolerance = {coverage = 0.999999999999, confidence = 0.9}", "at most 0.999999999"),
        (f"thresholds = {{y = {list(range(300))}}}", "300 entries (allowed: at most 200)"),
        (f"quantiles = {[(i + 1) / 400 for i in range(300)]}", "300 entries"),
        ("\n".join(f"k{i} = 1" for i in range(20_000)), "[analysis] has 20000 entries"),
    ],
)
def test_a_study_that_asks_for_endless_work_is_refused(uq, write_study, more, words):
    ended = uq("check", write_study(more=f"[analysis]\n{more}"))
    assert (ended.code, ended.err.count("\n")) == (2, 1) and words in ended.err


@pytest.mark.parametrize("template", ["pipe", "/dev/zero"])
def test_a_template_that_never_ends_is_refused(write_program, folder, template):
    write_program(text=PAD.replace('"deck"', f'"{template}"'))
    os.mkfifo(folder / "pipe")
    with pytest.raises(InputError, match="not a file"):
        read_machine(folder / "machine.toml")


def test_a_format_and_a_pattern_that_explode_are_refused(folder, monkeypatch):
    with pytest.raises(ValueError, match="wider than 999"):
        filled("{load:1000000000d}", {"load": 1})
    assert filled("{load:12.6e}", {"load": 1.0}) == "1.000000e+00"
    monkeypatch.setattr(program_outputs, "_SEARCH_SECONDS", 0.2)
    (folder / "out").write_text("a" * 40 + "!")
    with pytest.raises(RowError, match="takes too long"):
        value_in(folder, "y", OutputTable(file="out", pattern="((?:a+)+)$"))


def test_a_pattern_that_explodes_is_ended_in_a_thread_too(folder, monkeypatch):
    """Threads of a served model search without the interpreter, which others need meanwhile."""
    monkeypatch.setattr(program_outputs, "_SEARCH_SECONDS", 3.0)
    Path("out").write_text(f"life = 2.5\n{'a' * 60}!")
    with ThreadPoolExecutor(1) as threads:
        life = threads.submit(value_in, folder, "y", OutputTable(file="out", pattern="= (.*)$"))
        assert life.result() == 2.5
        endless = OutputTable(file="out", pattern="((?:a+)+)$")
        with pytest.raises(RowError, match="takes too long to search for"):
            threads.submit(value_in, folder, "y", endless).result()


def test_a_figure_is_whole_or_absent(folder):
    path = folder / "figure.png"
    with pytest.raises(OSError, match="full"), replaced(path) as part:
        part.write_bytes(b"half")
        raise OSError("full")
    assert list(folder.iterdir()) == []


def test_a_nonsensical_scheduler_is_refused_in_one_line(uq, write_study):
    ended = uq("run", write_study(), "--scheduler", "nonsense")
    assert (ended.code, ended.err.count("\n")) == (2, 1) and "not an address" in ended.err


@pytest.mark.parametrize("error", [OSError(5, "Input/output error", "x.nc"), ValueError("odd")])
def test_what_nobody_foresaw_ends_in_one_line(uq, folder, monkeypatch, error):
    def fail(*arguments, **options):
        raise error

    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setattr(app, "app", fail)
    ended = uq("models")
    assert (ended.code, ended.err.count("\n")) == (1, 1)
    kept = list(folder.glob("uq-*.txt"))
    assert [path.name in ended.err for path in kept] == [True] * (not isinstance(error, OSError))
    assert all(stat.S_IMODE(path.stat().st_mode) == 0o600 for path in kept)


def test_compiled_code_goes_to_a_folder_of_ours_alone(folder, monkeypatch):
    monkeypatch.setattr(cache, "gettempdir", lambda: str(folder))
    made = cache._private_folder()
    assert stat.S_IMODE(made.lstat().st_mode) == 0o700
    assert cache._private_folder() == made
    made.chmod(0o777)
    with pytest.raises(PermissionError):
        cache._private_folder()
    made.rmdir()
    (folder / "elsewhere").mkdir(mode=0o700)
    made.symlink_to(folder / "elsewhere")
    with pytest.raises(PermissionError):
        cache._private_folder()


def test_without_a_home_no_folder_of_a_tilde_is_made(folder, monkeypatch):
    monkeypatch.setattr(cache, "gettempdir", lambda: str(folder))
    monkeypatch.setattr(cache, "user_cache_path", lambda *name, **how: Path("~/.cache/vibrolife"))
    assert cache.folder_of(cache.folder_of).is_relative_to(folder)
    assert not (folder / "~").exists()


@pytest.mark.parametrize("verb", [("summary",), ("summary", "--json"), ("report",)])
def test_flipped_data_are_pointed_out(uq, write_study, no_other_figures, verb):
    runner.run(write_study(), "x.nc", workers=0)
    assert "checksum" not in uq(verb[0], "x.nc", *verb[1:]).err
    with netCDF4.Dataset("x.nc", "a") as file:
        file["y"][3] += 1.0
    ended = uq(verb[0], "x.nc", *verb[1:])
    assert ended.code == 0 and "has changed since it was written" in ended.err


@pytest.mark.parametrize(
    ("name", "attribute", "value"),
    [
        ("x1", "admissible", "text"),
        ("x1", "source", 1.5),
        ("y", "scales", "{"),
        ("status", "flag_values", np.array([7, 8, 9, 10, 11, 12])),
        ("row", None, 3),
        ("group", None, -1),
    ],
)
def test_a_result_out_of_type_shape_or_range_is_refused(uq, write_study, name, attribute, value):
    runner.run(write_study(), "x.nc", workers=0)
    with netCDF4.Dataset("x.nc", "a") as file:
        if attribute:
            file[name].setncattr(attribute, value)
        else:
            file[name][:] = value
    ended = uq("summary", "x.nc")
    assert (ended.code, ended.err.count("\n")) == (2, 1) and "not a sound result" in ended.err


def test_a_unit_does_nothing_to_the_terminal(uq, write_study):
    runner.run(write_study(), "x.nc", workers=0)
    with netCDF4.Dataset("x.nc", "a") as file:
        file["y"].units = "\x1b[31ms"
    assert "\x1b" not in uq("summary", "x.nc").out
    assert "\x1b" not in open_result("x.nc")["y"].attrs["units"]
