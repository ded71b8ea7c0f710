"""Nothing around a run changes a bit of it: caches, locales, terminals, standard input."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from faulty_studies import PATIENCE, computed_here

from uq.result.result_file import open_result

COMMAND = Path(sys.executable).with_name("uq")


@pytest.mark.slow
def test_processes_with_a_cold_cache_agree(study_of, folder, injected):
    model = "faulty_models:COMPILED"
    study = study_of(model, samples=20)
    environment = os.environ | {
        "XDG_CACHE_HOME": str(folder / "cache"),
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    environment.pop("NUMBA_CACHE_DIR", None)
    started = [
        subprocess.Popen(
            [COMMAND, "run", study.path, "-o", f"{i}.nc", "--model", model, "--quiet"],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for i in range(8)
    ]
    ended = [(*process.communicate(timeout=240), process.returncode) for process in started]
    assert [(err, code) for _, err, code in ended] == [("", 0)] * 8
    injected("cold numba cache, eight runs at once")
    results = [(folder / f"{i}.nc").read_bytes() for i in range(8)]
    assert len(set(results)) == 1
    assert list((folder / "cache").rglob("*.nbi"))


SURROUNDINGS = {
    "decimal comma": {"LC_ALL": "de_DE.UTF-8", "COLUMNS": "80"},
    "plain": {"LC_ALL": "C", "LANG": "C", "NO_COLOR": "1", "TERM": "dumb"},
}
COMMA = """
import locale
locale.setlocale(locale.LC_ALL, "")
assert format(1.5, "n") == "1,5"
"""


def with_decimal_comma(folder):
    """Return the environment of processes that all write 1,5, where such a locale can be made."""
    place, name = folder / "locale", SURROUNDINGS["decimal comma"]["LC_ALL"]
    place.mkdir()
    make = ["localedef", "-i", "de_DE", "-f", "UTF-8", place / name]
    if shutil.which("localedef") is None or subprocess.run(make, capture_output=True).returncode:
        return {}
    (place / "sitecustomize.py").write_text(COMMA)
    return {"LOCPATH": str(place), "PYTHONPATH": os.pathsep.join([str(place), *sys.path])}


@pytest.mark.slow
@pytest.mark.parametrize("surroundings", SURROUNDINGS)
def test_surroundings_change_no_bit(study_of, folder, injected, surroundings):
    study = study_of("linear", samples=40, fail_how="nan", fail_above=0.95)
    expected = computed_here(study)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= SURROUNDINGS[surroundings]
    if surroundings == "decimal comma":
        comma = with_decimal_comma(folder)
        environment |= comma
        injected("decimal comma", bool(comma))
    ended = subprocess.run(
        [COMMAND, "run", study.path, "--workers", "1"],
        env=environment,
        stdin=None,
        # Closed standard input: not even /dev/null is there.
        preexec_fn=lambda: os.close(0),
        capture_output=True,
        timeout=PATIENCE,
    )
    injected("no terminal, no colours, closed standard input")
    assert ended.returncode == 0, ended.stderr
    assert b"Error" not in ended.stderr
    assert b"\x1b" not in ended.stdout + ended.stderr
    assert max(map(len, ended.stdout.decode().splitlines())) <= 80
    assert open_result(folder / "results" / "small.nc").identical(expected)
