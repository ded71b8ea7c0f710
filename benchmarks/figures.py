"""The figures of benchmarks, each against its peer, as data.

Every benchmark keeps its own, and ``python -m benchmarks.table`` shows all of them.
"""

import json
import platform
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numba
from dask.system import CPU_COUNT

FOLDER = Path("results/benchmarks")


class Figure(NamedTuple):
    """One figure.

    Attributes
    ----------
    what : str
        What was measured, under which demand.
    peer : str
        What it is compared with, under the same demand.
    ratio : float
        How many times as fast as the peer, or as long.
    longer : bool
        Whether it takes `ratio` times as long as the peer.
    """

    what: str
    peer: str
    ratio: float
    longer: bool = False


class Kept(NamedTuple):
    """The figures of one benchmark, and the computer that they were measured on."""

    benchmark: str
    machine: str
    figures: list[Figure]


def keep(benchmark: str, figures: Sequence[Figure]) -> None:
    """Keep the figures of a benchmark in place of its earlier ones."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    data = {"machine": machine(), "figures": [figure._asdict() for figure in figures]}
    (FOLDER / f"{benchmark}.json").write_text(json.dumps(data, indent=1))


def kept() -> list[Kept]:
    """Return the figures kept of each benchmark, by its name."""
    records = []
    for path in sorted(FOLDER.glob("*.json")):
        data = json.loads(path.read_text())
        figures = [Figure(**figure) for figure in data["figures"]]
        records.append(Kept(path.stem, data["machine"], figures))
    return records


def machine() -> str:
    """Name this computer as far as times depend on it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return (
        f"{name}, {CPU_COUNT} cores, Python {platform.python_version()}, numba {numba.__version__}"
    )
