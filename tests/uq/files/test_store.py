"""A result file appears whole or not at all, and what cannot be written is known before."""

import resource
import signal
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import everything

from uq.errors import InputError, RunError
from uq.execution import tally
from uq.files import whole_files
from uq.files.interrupts import undo_all

DS = xr.Dataset({"a": ("row", np.arange(100_000.0))})


def test_missing_folders_are_made(folder):
    whole_files.write(DS, Path("a/b/out.nc"))
    assert everything(folder) == ["a", "a/b", "a/b/out.nc"]
    assert xr.load_dataset("a/b/out.nc").identical(DS)


def test_a_failed_write_leaves_nothing_and_keeps_what_was_there(folder):
    with pytest.raises(RunError, match=r"^a/b/out\.nc: could not be written: "):
        _write_with_file_limit(Path("a/b/out.nc"))
    assert everything(folder) == []
    whole_files.write(DS.isel(row=[0]), Path("out.nc"))
    with pytest.raises(RunError):
        _write_with_file_limit(Path("out.nc"))
    assert everything(folder) == ["out.nc"]
    assert xr.load_dataset("out.nc").sizes == {"row": 1}


def test_a_chunk_that_cannot_be_written_leaves_nothing(folder):
    (folder / "0-3.rows").mkdir()  # a name that no file can take
    with pytest.raises(OSError, match="directory"):
        tally.save(folder / "0-3.rows", np.arange(3))
    assert everything(folder) == ["0-3.rows"]


def _write_with_file_limit(path):
    """Write where no file may grow beyond 100 kB, as on a disk that is full."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, limits[1]))
    try:
        whole_files.write(DS, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, handler)


def test_a_write_that_is_cut_short_can_be_undone(folder, monkeypatch):
    seen = []

    def cut(*paths):
        seen.extend(everything(folder))
        undo_all()
        raise KeyboardInterrupt

    monkeypatch.setattr(whole_files.os, "replace", cut)
    with pytest.raises(KeyboardInterrupt):
        whole_files.write(DS, Path("a/out.nc"))
    assert len(seen) == 2
    assert everything(folder) == []


ELSEWHERE = "choose another place with -o"


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("folder", "folder: is a folder; give the name of a file in it"),
        ("file/out.nc", f"file/out.nc: {{here}}/file is a file, not a folder; {ELSEWHERE}"),
        *(
            (path, f"{path}: cannot write in /proc: No such file or directory; {ELSEWHERE}")
            for path in ("/proc/out.nc", "/proc/a/b.nc")
        ),
    ],
)
def test_a_target_that_cannot_be_written_is_refused(folder, path, words):
    (folder / "folder").mkdir()
    (folder / "file").touch()
    with pytest.raises(InputError) as refused:
        whole_files.check_target(Path(path), 1000)
    assert str(refused.value) == words.format(here=folder)
    assert everything(folder) == ["file", "folder"]


def test_a_result_larger_than_the_disk_is_refused_before_the_run(folder):
    with pytest.raises(InputError, match=r"out\.nc: the result takes about 1000000000000 MB, and"):
        whole_files.check_target(folder / "new" / "out.nc", 10**18)
    whole_files.check_target(folder / "new" / "out.nc", 1000)
    assert everything(folder) == []
