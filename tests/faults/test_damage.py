"""What is damaged on disk is found and computed again; what cannot be written is said."""

import contextlib
import json
import os
import random
import subprocess
import tempfile
from pathlib import Path

import pytest
from killed_runs import MODEL, OUT, ROWS, until
from wordings import sentence

import uq

RANDOM = random.Random(2026)


@pytest.fixture
def kept(study, undisturbed, under_way):
    """Leave a run that was killed when several chunk files were there."""
    under_way(study, chunks=3).kill()
    return sorted(ROWS.glob("*.rows"))


def truncated(content):
    return content[:-1]


def emptied(content):
    return b""


def one_bit_flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 4]) + content[middle + 1 :]


@pytest.mark.parametrize(
    "damage",
    [
        *(
            pytest.param(damage_kind, marks=pytest.mark.slow)
            for damage_kind in (truncated, emptied)
        ),
        one_bit_flipped,
    ],
)
def test_a_damaged_chunk_file_is_computed_again(study, undisturbed, kept, call, injected, damage):
    kept[1].write_bytes(damage(kept[1].read_bytes()))
    words = damage.__name__.replace("_", " ")
    injected(f"chunk file {'with ' * (damage is one_bit_flipped)}{words}")
    first, _, stop = kept[1].stem.partition("-")[2].partition("-")
    code, output = call("run", study, *MODEL[:-1])
    assert code == 0
    assert output.startswith(sentence("damaged", rows=ROWS, count=int(stop) - int(first)))
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_missing_chunk_file_is_computed_again(study, undisturbed, kept, call, injected):
    kept[1].unlink()
    injected("chunk file missing")
    assert call("run", study, *MODEL)[0] == 0
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_rows_may_be_computed_in_any_order(study, undisturbed, under_way, call, injected):
    for chunk_rows in (5, 3, 11):  # each time holes are left, and filled with other chunks
        under_way(study, "--chunk-rows", chunk_rows, chunks=4).kill()
        for file in RANDOM.sample(sorted(ROWS.glob("*.rows")), 3):
            file.unlink()
        injected("rows in another order, in other chunks")
    assert call("run", study, *MODEL)[0] == 0
    assert OUT.read_bytes() == undisturbed


@pytest.mark.parametrize("bytes_cut", [pytest.param(1, marks=pytest.mark.slow), 30])
def test_a_journal_that_was_cut_loses_its_last_record_only(
    study, undisturbed, kept, call, injected, bytes_cut
):
    journal = ROWS / "journal"
    content = journal.read_bytes()
    journal.write_bytes(content[:-bytes_cut])
    injected("journal cut")
    records = [json.loads(line[9:]) for line in content.splitlines()]
    last = len(records) - (bytes_cut > 1)
    blocks = [block for record in records[1:last] for block in record["blocks"]]
    rows = sum(stop - start for start, stop in blocks)
    code, output = call("run", study, *MODEL[:-1])
    assert code == 0
    assert output.startswith(sentence("done", output=OUT, done=rows, rows=1500))
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_record_that_was_changed_does_not_count(study, undisturbed, kept, call, injected):
    journal = ROWS / "journal"
    lines = journal.read_bytes().split(b"\n")
    lines[2] = one_bit_flipped(lines[2])
    journal.write_bytes(b"\n".join(lines))
    injected("journal record changed")
    assert call("run", study, *MODEL)[0] == 0
    assert OUT.read_bytes() == undisturbed


def test_a_file_size_limit_stops_a_run_with_a_sentence(study, undisturbed, call, injected):
    code, output = call("run", study, *MODEL, "--chunk-rows", "40", UQ_TEST_FILE_SIZE="9000")
    assert code == 1
    assert output.count("\n") == 1
    assert output.startswith(sentence("unwritten", place=ROWS, why="File too large; "))
    assert output.endswith(" of 1500 rows are kept, and " + sentence("resumes"))
    assert not OUT.exists()
    assert not list(ROWS.glob("*.part")) and not list(ROWS.glob(".*"))
    injected("file-size limit", 2)
    almost = str(len(undisturbed) - 5000)  # more than all chunk files take together
    code, output = call("run", study, *MODEL, "--chunk-rows", "40", UQ_TEST_FILE_SIZE=almost)
    assert code == 1
    assert output.count("\n") == 1
    assert output.startswith(sentence("unwritten", place=OUT, why=""))  # in the merge this time
    assert output.endswith("; the rows are kept, and " + sentence("resumes"))
    assert not OUT.exists()
    assert not list(ROWS.glob("*.part")) and not list(ROWS.glob(".*"))
    code, output = call("run", study, *MODEL[:-1])
    assert code == 0
    assert output.startswith(sentence("done", output=OUT, done=1500, rows=1500))
    assert OUT.read_bytes() == undisturbed


@pytest.fixture
def disk(folder):
    """Return a disk of one megabyte; where none can be made, a file size limit has to do."""
    place = folder / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "none", str(place)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("mounting a small disk needs root and a kernel that permits it")
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.slow
def test_a_full_disk_stops_a_run_with_a_sentence(study, undisturbed, start, call, disk, injected):
    out, rows, filler = (disk / name for name in ("out.nc", "out.nc.rows", "filler"))
    filler.write_bytes(bytes(900_000))
    code, output = call("run", study, *MODEL, "-o", out)
    assert (code, list(disk.iterdir())) == (2, [filler])  # nothing was computed
    assert output.startswith(f"{out}: the result takes about 0 MB, and {disk} has 0 MB left")
    filler.unlink()
    run = start("run", study, *MODEL, "-o", out, "--chunk-rows", "40", UQ_TEST_SECONDS="0.002")
    until(lambda: list(rows.glob("*.rows")))
    with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
        while True:  # meanwhile somebody else needs the disk
            file.write(bytes(1000))
    code, message = run.wait()
    injected("full disk", 2)  # with the refusal above
    assert code == 1
    assert message.count("\n") == 1
    assert message.startswith(sentence("unwritten", place=rows, why="No space left on device; "))
    assert message.endswith(" of 1500 rows are kept, and " + sentence("resumes"))
    assert not out.exists()
    assert {path.suffix for path in rows.iterdir()} == {"", ".rows"}
    filler.unlink()
    assert call("run", study, *MODEL, "-o", out)[0] == 0
    assert out.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_read_only_folder_is_refused(study, undisturbed, call, injected):
    as_nobody = {"UQ_TEST_USER": "65534"} if os.geteuid() == 0 else {}
    with tempfile.TemporaryDirectory() as name:
        closed = Path(name)
        (closed / study.name).write_bytes(study.read_bytes())
        there = closed / "there.nc"
        there.write_bytes(undisturbed)
        closed.chmod(0o555)
        for output in (closed / "out.nc", closed / "new" / "out.nc"):
            code, message = call("run", closed / study.name, *MODEL, "-o", output, **as_nobody)
            assert code == 2, message
            injected("read-only folder")
            why = "Permission denied; choose another place with -o"
            assert message == f"{output}: cannot write in {closed}: {why}\n"
        model = (*MODEL[:2], "--quiet")
        refused = call("extend", there, "--samples", "1600", *model, **as_nobody)
        assert refused == (
            2,
            f"{there}: cannot write in {closed}: Permission denied; copy it elsewhere\n",
        )
        assert call("status", there, **as_nobody)[0] == 0
        assert sorted(path.name for path in closed.iterdir()) == sorted([study.name, there.name])
        closed.chmod(0o700)


@pytest.mark.slow
def test_paths_with_blanks_and_accents(study, undisturbed, start, call, folder, injected):
    place = folder / "étude nº 1" / "mes résultats" / "durée de vie.nc"
    run = start("run", study, *MODEL, "-o", place, "--chunk-rows", "9", UQ_TEST_SECONDS="0.002")
    rows = place.with_name("durée de vie.nc.rows")
    until(lambda: list(rows.glob("*.rows")))
    run.kill()
    injected("path with blanks and accents")
    assert call("run", study, *MODEL, "-o", place)[0] == 0
    assert place.read_bytes() == undisturbed
    assert call("verify", place, *MODEL[:2])[0] == 0
    assert uq.open_result(place).sizes["row"] == 1500
