"""The cache folder of a user without a home."""

import os
import pwd
import tempfile
from unittest.mock import patch

from uq import cli
from uq.files.whole_files import cache_path


def test_without_a_home_no_folder_is_made_in_the_current_one(folder, monkeypatch):
    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    with patch.object(pwd, "getpwuid", side_effect=KeyError):
        path = cache_path("vibrolife")
    assert path.is_absolute() and not path.exists()
    assert os.listdir(folder) == []


def test_a_tilde_that_no_shell_expanded_is_no_folder(uq, folder, monkeypatch):
    monkeypatch.setenv("HOME", "~")
    monkeypatch.setenv("XDG_CACHE_HOME", "~/.cache")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(folder / "config"))
    assert uq("--version").code == 0
    left = {name: os.environ.get(name) for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")}
    assert left == {"HOME": None, "XDG_CACHE_HOME": None, "XDG_CONFIG_HOME": f"{folder}/config"}


def test_without_any_temporary_folder_the_line_names_the_variable(uq, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(tempfile, "_candidate_tempdir_list", lambda: ["/nowhere"])
    monkeypatch.setattr(cli, "_run", lambda arguments: tempfile.gettempdir())
    ended = uq("status", "a.nc")
    assert (ended.code, ended.out, ended.err.count("\n")) == (1, "", 1)
    assert "/nowhere" in ended.err and "TMPDIR" in ended.err
