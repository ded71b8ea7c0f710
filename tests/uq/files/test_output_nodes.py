"""Only regular files are ever replaced: a link is written through, all else is refused."""

import os
import socket
import stat
from pathlib import Path

import pytest
import sample_models

import uq as api
from uq.errors import InputError


def fifo(path):
    os.mkfifo(path)
    return "a named pipe"


def bound(path):
    with socket.socket(socket.AF_UNIX) as bound_socket:
        bound_socket.bind(str(path))
    return "a socket"


def device(path):
    """Make a device that swallows everything, where that is allowed."""
    try:
        os.mknod(path, stat.S_IFCHR | 0o600, os.makedev(1, 3))
    except PermissionError:
        return fifo(path)
    return "a device"


def link(path):
    path.symlink_to("behind")
    return fifo(path.with_name("behind"))


def circle(path):
    path.symlink_to(path.name)
    return "a link that leads nowhere"


def state(folder):
    return {path: (path.lstat().st_mode, path.lstat().st_ino) for path in folder.rglob("*")}


@pytest.fixture
def result(uq, write_study):
    uq("run", write_study(samples=8), "--workers", "0", "--quiet")
    return Path("results/small.nc")


@pytest.fixture
def drawn_once(uq, write_study):
    """Return a result of which there is one figure."""
    study = write_study(method="morris", samples=8, replicates=2)
    uq("run", study, "--workers", "0", "--quiet")
    return Path("results/small.nc")


LINES = """
run small.toml --workers 0 -o node
run small.toml --workers 0 --fresh -o node
simulate sample_models:KINDS -o node
simulate sample_models:KINDS --plot node
report results/small.nc -o node
extend node --samples 16
rerun node --failed
status node
verify node
summary node
report node
"""


@pytest.mark.parametrize("make", [fifo, bound, device, link, circle])
def test_what_is_no_file_is_refused(uq, result, folder, make):
    what = make(folder / "node")
    before = state(folder)
    for line in LINES.split("\n")[1:-1]:
        ended = uq(*line.split())
        assert (ended.code, ended.out) == (2, ""), line
        assert ended.err.startswith(f"node: is {what}, ") and ended.err.count("\n") == 1
        assert state(folder) == before


@pytest.mark.parametrize("length", [230, 300])
def test_a_name_too_long_is_refused(uq, result, folder, length):
    before, name = state(folder), length * "n"
    for line in LINES.split("\n")[1:-1]:
        ended = uq(*line.replace("node", name).split())
        assert (ended.code, ended.out) == (2, ""), line
        assert ended.err.startswith(f"{name}: ") and ended.err.count("\n") == 1, line
        message = ended.err.removeprefix(f"{name}: ")
        assert message.startswith("is too long a name") or (
            length == 230 and "no such" in message
        ), line
        assert state(folder) == before


def test_basins_and_figures_refuse_too(uq, drawn_once, folder):
    what = device(folder / "node")
    axes = {"x1": (0.0, 1.0, 2)}
    with pytest.raises(InputError, match=f"^node: is {what}, not a file; "):
        api.basins(sample_models.KINDS, axes, output="node")
    assert "morris-y.png" in uq("plot", drawn_once, "-o", "figures").out
    (folder / "figures" / "morris-y.png").unlink()
    what = fifo(folder / "figures" / "morris-y.png")
    ended = uq("plot", drawn_once, "-o", "figures")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert ended.err.startswith(f"figures/morris-y.png: is {what}, not a file; ")
    assert uq("plot", drawn_once, "-o", "node").code == 2


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("run small.toml --workers 0 --fresh -o link.nc", "link.nc"),
        ("simulate sample_models:KINDS -o link.nc", "link.nc"),
        ("simulate sample_models:KINDS --plot link.png", "link.png"),
        ("report results/small.nc -o link.html", "link.html"),
    ],
)
def test_a_link_is_written_through(uq, result, folder, there, line, name):
    target, again = folder / "elsewhere" / "deep" / "target", folder / "again"
    (folder / name).symlink_to(again)
    again.symlink_to("elsewhere/deep/target")
    if there:
        uq(*line.replace("link", "first").split())
        target.parent.mkdir(parents=True)
        (folder / name.replace("link", "first")).rename(target)
    assert uq(*line.split()).code == 0
    assert (folder / name).is_symlink() and again.is_symlink()
    assert target.is_file() and target.stat().st_size > 1000
    assert [path.name for path in target.parent.iterdir()] == ["target"]
    assert not [path for path in folder.iterdir() if path.name.endswith((".rows", ".part"))]


def test_a_result_behind_a_link_goes_on(uq, result, folder):
    (folder / "disk").mkdir()
    result.rename(folder / "disk" / "kept.nc")
    result.symlink_to(folder / "disk" / "kept.nc")
    assert uq("extend", result, "--samples", 16, "--workers", "0", "--quiet").code == 0
    assert result.is_symlink()
    assert api.open_result(folder / "disk" / "kept.nc").sizes["row"] == 16
    assert "already complete" in uq("run", "small.toml", "--samples", 16).out
    assert uq("verify", result).code == 0


def test_figures_go_into_a_folder_behind_a_link(uq, drawn_once, folder):
    (folder / "figures").symlink_to("disk/figures")
    assert uq("plot", drawn_once, "-o", "figures").code == 0
    assert (folder / "disk" / "figures" / "morris-y.png").is_file()


def test_standard_output_is_no_place_for_a_file(uq, result, folder):
    before = state(folder)
    for line in (
        "run small.toml -o -",
        "simulate sample_models:KINDS -o -",
        "simulate sample_models:KINDS --plot -",
        "report results/small.nc -o -",
        "plot results/small.nc -o -",
    ):
        ended = uq(*line.split())
        assert (ended.code, ended.out) == (2, "")
        assert ended.err.startswith("-: output goes to a file, not to standard output; give its")
        assert state(folder) == before
