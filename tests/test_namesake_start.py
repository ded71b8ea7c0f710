"""The command starts where Python finds ours, and else names what it finds instead."""

import subprocess
import sys
from pathlib import Path
from shutil import copy

import pytest

import vibrolife

HOUSE = Path(vibrolife.__file__).parent


def started(*folders):
    """Run the command ``uq --version`` where Python looks into some folders first."""
    path = [*map(str, folders), *sys.path]
    code = f"import sys; sys.path[:] = {path!r}; import vibrolife; vibrolife.main()"
    command = [sys.executable, "-I", "-c", code, "--version"]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("file", ["uq.py", "uq/__init__.py"])
def test_another_package_that_is_found_first_is_named(tmp_path, file):
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text("import not_there")
    ended = started(tmp_path, HOUSE)
    theirs, ours = tmp_path / file.partition("/")[0], HOUSE / "uq"
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr.startswith(f"uq: {theirs} is another 'uq' than that of vibrolife, {ours},")
    assert ended.stderr.count("\n") == 1


@pytest.mark.parametrize("text", ["import not_there", ""])
def test_another_package_that_is_installed_over_ours_is_reported(tmp_path, text):
    copy(HOUSE / "vibrolife.py", tmp_path)
    (tmp_path / "uq").mkdir()
    (tmp_path / "uq" / "__init__.py").write_text(text)
    (tmp_path / "uq" / "cli.py").write_text("def main(): raise AssertionError")
    ended = started(tmp_path)
    assert (ended.returncode, ended.stdout) == (1, "")
    assert f"{tmp_path / 'uq' / '__init__.py'} is not that of vibrolife" in ended.stderr
    assert ended.stderr.count("\n") == 1


def test_ours_starts():
    ended = started(HOUSE)
    assert ended.returncode == 0 and ended.stdout.startswith("vibrolife "), ended.stderr
