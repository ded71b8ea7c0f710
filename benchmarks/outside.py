"""What a row of a machine from outside costs beside the least that it could cost.

``python -m benchmarks.outside``: a plain function, a program beside a bare loop of subprocesses
that write and read the same files, and a UM-Bridge server beside the package's own client. One
row after the other in one process, by turns, the median of several.
"""

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure, keep
from tests.support.machines.their_server import TheirServer
from uq.machines.function import machine, model_of
from uq.machines.program import program_of
from uq.machines.server import server_model

ROWS, TURNS = 250, 5

MACHINE = """
[machine]
name = "trivial"
command = ["./trivial"]
template = "deck"
[parameters.x]
nominal = 1.0
[outputs.y]
file = "out.txt"
pattern = 'y = (\\S+)'
"""
PROGRAM = "#!/bin/sh\nread x < input.txt\necho y = $x > out.txt\n"


@machine(returns={"y": "1"})
def _trivial(x: float = 1.0):
    return {"y": x}


def ours(model):
    """Return the time of a row of ours, and how many rows that is worth measuring."""
    x, seed = np.random.default_rng(0).random((ROWS, 1)), np.zeros(ROWS, np.uint64)
    began = time.perf_counter()
    outputs, status, _ = model.batch(x, seed, model.settings())
    assert not status.any() and len(outputs) == 1
    return (time.perf_counter() - began) / ROWS


def bare(folder):
    """Return the time of a row of subprocesses that write and read the same files."""
    began = time.perf_counter()
    for value in np.random.default_rng(0).random(ROWS).tolist():
        with tempfile.TemporaryDirectory(dir=folder) as row_folder:
            Path(row_folder, "input.txt").write_text(f"{value!r}\n")
            with (
                Path(row_folder, "stdout.txt").open("wb") as out,
                Path(row_folder, "stderr.txt").open("wb") as e,
            ):
                subprocess.run(
                    [folder / "trivial"], cwd=row_folder, stdout=out, stderr=e, check=True
                )
            float(Path(row_folder, "out.txt").read_text().split()[-1])
    return (time.perf_counter() - began) / ROWS


def theirs(client):
    """Return the time of a row of the other client."""
    began = time.perf_counter()
    for value in np.random.default_rng(0).random(ROWS).tolist():
        assert client([[value]]) == [[value]]
    return (time.perf_counter() - began) / ROWS


def by_turns(first, second):
    """Return the medians of two times."""
    both = np.array([(first(), second()) for _ in range(TURNS)])
    return np.median(both, axis=0)


def main():
    """Print and keep the ratios."""
    import umbridge

    model = model_of(_trivial)
    ours(model)
    each = np.median([ours(model) for _ in range(TURNS)])
    print(f"plain function     {each * 1e6:8.1f} us a row")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in {"m.toml": MACHINE, "deck": "{x}\n", "trivial": PROGRAM}.items():
            (folder / file).write_text(text)
        (folder / "trivial").chmod(0o755)
        model = program_of(folder / "m.toml")
        our_seconds, least = by_turns(lambda: ours(model), lambda: bare(folder))
        program = our_seconds / least
        print(
            f"program            {our_seconds * 1e3:8.2f} ms a row"
            f" {least * 1e3:8.2f} ms {program:6.2f}"
        )
        with TheirServer(folder, "return [[parameters[0][0]]]", "trivial") as other:
            model = server_model(other.address)
            client = umbridge.HTTPModel(other.base, "trivial")
            our_seconds, least = by_turns(lambda: ours(model), lambda: theirs(client))
        server = our_seconds / least
        print(
            f"UM-Bridge server   {our_seconds * 1e3:8.2f} ms a row"
            f" {least * 1e3:8.2f} ms {server:6.2f}"
        )
    keep(
        "outside",
        [
            Figure("a row of a program", "a bare loop of subprocesses", program, True),
            Figure("a row of a server", "the client of UM-Bridge", server, True),
        ],
    )


if __name__ == "__main__":
    main()
