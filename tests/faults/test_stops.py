"""A run that is stopped, by whatever, goes on and gives the bits of one that is not."""

import json
import os
import random
import shutil
import signal

import psutil
import pytest
from killed_runs import MODEL, OUT, PATIENCE, ROWS, kept, until
from wordings import sentence

import uq

RANDOM = random.Random(2026)


@pytest.mark.parametrize("kills", [2, pytest.param(30, marks=pytest.mark.slow)])
def test_kills_after_some_rows_were_kept(study, under_way, call, injected, kills):
    samples = 100 + 100 * kills
    study.write_text(study.read_text().replace("samples = 1500", f"samples = {samples}"))
    assert call("run", study, *MODEL, "-o", "undisturbed.nc") == (0, "")
    done = 0
    for _ in range(kills):
        more = RANDOM.randint(1, 40)
        run = under_way(study, "--chunk-rows", "3", rows=more)
        run.process.join(RANDOM.uniform(0.0, 0.1))  # between two writes, or within one
        run.kill()
        injected("SIGKILL of a run")
        assert not OUT.exists()
        run_status = json.loads(call("status", OUT, "--json")[1])
        assert run_status["state"] == "interrupted"
        assert done + more <= run_status["done"] == kept().rows < samples  # nothing is lost
        done = run_status["done"]
    assert call("run", study, *MODEL) == (0, "")
    assert OUT.read_bytes() == (OUT.parents[1] / "undisturbed.nc").read_bytes()
    assert [path.name for path in OUT.parent.iterdir()] == [OUT.name]


@pytest.mark.slow
def test_a_kill_before_any_row_was_kept(study, undisturbed, start, call, injected):
    run = start("run", study, *MODEL, UQ_TEST_SECONDS="0.02")
    until(ROWS.exists)
    run.kill()
    injected("SIGKILL of a run that has kept no row")
    assert kept().rows == 0
    assert call("run", study, *MODEL) == (0, "")
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
@pytest.mark.parametrize("kills", [1, 10])
def test_kills_during_the_merge(write_study, start, call, injected, kills):
    study = write_study(model="linear", uncertain=("x1", "x2", "x3"), samples=200_000)
    options = ("--workers", "0", "--quiet", "--chunk-rows", "2000")
    assert call("run", study, *options, "-o", "undisturbed.nc")[0] == 0
    caught = 0
    while caught < kills:
        run = start("run", study, *options)
        until(lambda run=run: list(ROWS.glob(".*.part")) or not run.process.is_alive())
        run.process.join(RANDOM.uniform(0.0, 0.05))
        run.kill()
        caught += not OUT.exists() and bool(list(ROWS.glob(".*.part")))
        if OUT.exists():  # too late: once more
            OUT.unlink()
    injected("SIGKILL during the merge", caught)
    shutil.copytree(ROWS, "copy")
    code, output = call("run", study, *options[:2])
    assert code == 0
    assert sentence("done", output=OUT, done=200_000, rows=200_000) in output
    assert OUT.read_bytes() == (OUT.parents[1] / "undisturbed.nc").read_bytes()
    # Killed just before the rows are removed: they are of no use any more.
    shutil.copytree("copy", ROWS)
    assert "already complete" in call("run", study)[1]
    assert [path.name for path in OUT.parent.iterdir()] == [OUT.name]


def wanting(half_width, text):
    return text.replace("seed = 5", f"seed = 5\nuntil = {{output='y', half_width={half_width}}}")


@pytest.mark.slow
def test_kills_of_a_run_that_stops_when_it_knows_enough(study, under_way, call, injected):
    study.write_text(wanting(0.03, study.read_text()))
    assert call("run", study, *MODEL, "-o", "undisturbed.nc") == (0, "")
    for _ in range(3):
        under_way(study).kill()
        injected("SIGKILL of a run that stops early")
    assert call("run", study, *MODEL) == (0, "")
    assert 47 < uq.open_result(OUT).attrs["samples"] < 1500
    assert OUT.read_bytes() == (OUT.parents[1] / "undisturbed.nc").read_bytes()


LOOKS = (375, 750, 1500)


@pytest.mark.slow
def test_another_wish_after_a_kill_changes_no_row(study, under_way, call, folder, injected):
    plain = study.read_text()
    assert call("run", study, *MODEL, "-o", "whole.nc") == (0, "")
    whole = uq.open_result("whole.nc")
    study.write_text(wanting(0.01, plain))
    under_way(study, rows=400, seconds=0.01).kill()
    kept = json.loads(call("status", OUT, "--json")[1])["done"]
    study.write_text(wanting(0.5, plain))  # known at the first look, which is past
    injected("[design] until edited between runs", 2)
    assert call("run", study, *MODEL) == (0, "")
    ended = uq.open_result(OUT)
    size = ended.sizes["row"]
    assert size == min(look for look in LOOKS if look >= kept)
    card = " ".join(call("summary", OUT)[1].split())
    assert f"ended at {size} of 1 500 samples: required half-width of 0.5 reached" in card
    for name in ("x1", "x2", "y", "z", "status"):
        assert ended[name].values.tobytes() == whole[name].values[:size].tobytes()
    study.write_text(plain)  # no wish any more: all rows
    assert call("run", study, *MODEL) == (0, "")
    assert OUT.read_bytes() == (folder / "whole.nc").read_bytes()


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)]
)
def test_a_request_to_stop_keeps_all_rows_and_says_how_to_go_on(
    study, undisturbed, start, call, injected, number
):
    run = start("run", study, *MODEL[:-1], "--chunk-rows", "7", UQ_TEST_SECONDS="0.01")
    until(lambda: kept().rows > 100)
    run.send(number)
    injected("Ctrl-C" if number == signal.SIGINT else "SIGTERM")
    code, message = run.wait()
    assert code == 128 + number
    done = json.loads(call("status", OUT, "--json")[1])["done"]
    assert message == sentence("interrupted", done=done, rows=1500, place=ROWS)
    code, output = call("run", study, *MODEL[:-1])
    assert code == 0
    assert output.startswith(sentence("done", output=OUT, done=done, rows=1500))
    assert OUT.read_bytes() == undisturbed


def test_a_running_run_can_be_watched_and_has_a_lock(study, undisturbed, under_way, call, injected):
    run = under_way(study)
    run_status = json.loads(call("status", OUT, "--json")[1])
    assert run_status["state"] == "running"
    assert run_status["process"]["pid"] == run.process.pid
    assert 0 < run_status["done"] < run_status["rows"] == 1500
    assert run_status["done"] + run_status["left"] == 1500
    assert sum(run_status["status"].values()) == run_status["done"]
    assert run_status["rate"] > 0
    os.kill(run.process.pid, signal.SIGSTOP)  # it lives, and does not end while the next one starts
    code, output = call("run", study, *MODEL)
    assert code == 2
    injected("lock of a living process")
    host = run_status["process"]["host"]
    assert output == sentence("in use", rows=ROWS, pid=run.process.pid, host=host)
    run.kill()
    assert (ROWS / "lock").exists()  # stale, and recognised as such
    injected("lock of a dead process")
    assert json.loads(call("status", OUT, "--json")[1])["state"] == "interrupted"
    # Its number is that of another process, or of one after the computer was started anew.
    words = (ROWS / "lock").read_text().split("\n")
    (ROWS / "lock").write_text("\n".join([str(os.getpid()), *words[1:]]))
    injected("lock whose process number is in use again")
    assert json.loads(call("status", OUT, "--json")[1])["state"] == "interrupted"
    assert call("run", study, *MODEL) == (0, "")
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_lock_that_names_nobody_says_what_to_do(study, undisturbed, under_way, call):
    under_way(study).kill()
    (ROWS / "lock").write_text("")
    refused = sentence("in use by nobody", rows=ROWS, lock=ROWS / "lock")
    assert call("run", study, *MODEL) == (2, refused)
    (ROWS / "lock").unlink()
    assert call("run", study, *MODEL) == (0, "")
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_lock_of_another_host_is_respected(study, under_way, call, injected):
    under_way(study).kill()
    (ROWS / "lock").write_text("1\nelsewhere\n")
    injected("lock of another computer")
    code, output = call("run", study, *MODEL)
    assert code == 2
    where = {"pid": 1, "host": "elsewhere", "lock": ROWS / "lock"}
    assert output == sentence("in use elsewhere", rows=ROWS, **where)
    (ROWS / "lock").unlink()
    assert call("run", study, *MODEL)[0] == 0


@pytest.mark.slow
@pytest.mark.parametrize("chunk_rows", [1, 7, 1000])
@pytest.mark.parametrize("workers", [0, 1, 2, 4])
def test_kills_with_workers_and_any_chunks(
    study, undisturbed, start, call, folder, injected, workers, chunk_rows
):
    options = (*MODEL[:2], "--workers", workers, "--quiet", "--chunk-rows", chunk_rows)
    (folder / "temporary").mkdir()
    temporary = {"TMPDIR": str(folder / "temporary")}
    run = start("run", study, *options, UQ_TEST_SECONDS="0.01", **temporary)
    wanted = RANDOM.randint(1, 900)
    until(lambda: kept().rows >= wanted)
    assert run.process.is_alive()
    family = psutil.Process(run.process.pid).children(recursive=True)
    run.kill()
    assert wanted <= kept().rows < 1500
    injected("SIGKILL of a run with workers" if workers else "SIGKILL of a run")
    assert psutil.wait_procs(family, PATIENCE)[1] == []
    assert not list((folder / "temporary").iterdir())
    assert call("run", study, *options)[0] == 0
    assert OUT.read_bytes() == undisturbed
