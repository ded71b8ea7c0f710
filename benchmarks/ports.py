"""What the processor allows the hot loops, and what they reach: ``python -m benchmarks.ports``.

The operations of each loop are counted, not estimated: the source runs uncompiled on numbers that
count their operations. The counts over those that the processor can start in a cycle are limits,
one for each kind of unit; the largest binds. Loads are those of the source; a compiler keeps some
of them in registers. The loop itself is timed in cycles of this computer, whose length a chain of
dependent fused operations tells: each waits four cycles for the one before.
"""

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.figures import Figure, keep

COUNTING = os.environ.get("NUMBA_DISABLE_JIT") == "1"
LATENCY = 4  # cycles of a fused operation, AMD since 2020 and Intel since 2015
CHAIN = 4_000_000
TURNS = 5


class Processor(NamedTuple):
    """What a processor starts in a cycle, in doubles.

    Attributes
    ----------
    fused : float
        Products, and products with sums.
    sums : float
        Sums, comparisons and choices; 0 where they share the units of products.
    loads, stores, quotients : float
    """

    fused: float
    sums: float
    loads: float
    stores: float
    quotients: float


PROCESSORS = {"AMD": Processor(8, 8, 8, 4, 0.8), "Intel": Processor(16, 0, 16, 8, 0.5)}
"""AMD since Zen 3, 256 bits wide; Intel with AVX-512 and two units for it (A. Fog's tables)."""


NAMES = {
    "fused": "products", "sums": "sums", "quotients": "quotients",
    "loads": "loads", "stores": "stores",
}  # fmt: skip


class Loop(NamedTuple):
    """A hot loop: a call that takes some steps of all lanes of a block.

    Attributes
    ----------
    call : callable
    arguments : tuple
        Of the call that is timed, of all `steps`.
    lanes, steps : int
    single : sequence of tuple
        Of calls of one step each, which are counted. Compiled code works out both sides of a
        choice, the source one of them: each kind of operation is counted where it is most.
    """

    call: Callable[..., Any]
    arguments: tuple[Any, ...]
    lanes: int
    steps: int
    single: Sequence[tuple[Any, ...]]


class Number:
    """A number that counts the operations on it."""

    __slots__ = ("value",)
    done: Counter[str] = Counter()

    def __init__(self, value: Any) -> None:
        self.value = float(value)

    def __float__(self) -> float:
        return self.value

    def __int__(self) -> int:
        return int(self.value)

    def __neg__(self) -> "Number":
        return Number(-self.value)

    def __abs__(self) -> "Number":
        return Number(abs(self.value))


def _count_operator(name: str, kind: str) -> None:
    def operate(self: Number, other: Any) -> Any:
        Number.done[kind] += 1
        result = getattr(self.value, name)(float(other))
        return Number(result) if isinstance(result, float) else result

    setattr(Number, name, operate)


for _name in ("add", "sub", "radd", "rsub"):
    _count_operator(f"__{_name}__", "sums")
for _name in ("mul", "rmul"):
    _count_operator(f"__{_name}__", "fused")
for _name in ("truediv", "rtruediv"):
    _count_operator(f"__{_name}__", "quotients")
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    _count_operator(f"__{_name}__", "sums")


class Memory:
    """An array that counts loads and stores."""

    def __init__(self, array: Any) -> None:
        self.array, self.size, self.shape = array, array.size, array.shape

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, place: Any) -> Any:
        part = self.array[place]
        if isinstance(part, np.ndarray):
            return Memory(part)
        Number.done["loads"] += 1
        return Number(part)

    def __setitem__(self, place: Any, value: Any) -> None:
        Number.done["stores"] += 1
        self.array[place] = float(value)


def counted_fma(a: Any, b: Any, c: Any) -> Number:
    """Return a b + c, counted; its rounding does not matter here."""
    Number.done["fused"] += 1
    return Number(float(a) * float(b) + float(c))


if COUNTING:
    import models.numerics.fma as _fma

    _fma.fma = _fma.exact_fma = counted_fma


def _vibrator(order: int) -> Loop:
    from models.numerics.blocks import LANES, aligned
    from models.vibrator.lanes import machines, steps
    from models.vibrator.lanes.packed import CONSTANTS, STATE, load
    from models.vibrator.parameters import Params

    fields = {name: np.full(LANES, float(v)) for name, v in Params._field_defaults.items()}
    prepared = machines.prepared(Params(**fields))
    c, w = aligned(CONSTANTS * LANES), aligned(steps.SIZE)
    load(prepared.constants, 0, c)
    load(machines.start(prepared), 0, w[steps.AT.position : steps.AT.position + STATE * LANES])
    steps.prepare(c, np.full(LANES, 0.005), w)
    return Loop(steps.step_8 if order == 8 else steps.step_5, (w,), LANES, 1, [(w,)])


def _beam() -> Loop:
    from models.beam.lanes import layout, steps
    from models.numerics.blocks import LANES

    modes, count = 22, 64
    w, head, drive = steps.room(modes, count)
    for k in range(0, w.size, steps._MODE * LANES):
        for slot, value in ((2, 1.9), (3, 0.95), (4, 1e-3), (5, -1e-3)):
            w[k + slot * LANES : k + (slot + 1) * LANES] = value
    for slot, value in ((steps._RIGHT, 0.5), (steps._LEFT, 0.7), (steps._STIFF, 0.9)):
        head[slot * LANES : (slot + 1) * LANES] = value
    drive[:] = np.repeat(np.sin(2 * np.pi * np.arange(count) / count), LANES)
    groups = w.size // (layout.UNROLL * steps._MODE * LANES)
    block, path = (w, head, groups, drive), np.empty((0, count))
    single = [(*block, s, s + 1, path) for s in range(count)]
    return Loop(steps._take_steps, (*block, 0, count, path), LANES, count, single)


def _mole() -> Loop:
    from models.mole.lanes.block import LANES, Block
    from models.mole.lanes.expand import expansions

    y, w, m, _ = Block.made(0, False)
    y[:], m[:] = 0.3, 0.1
    return Loop(expansions(False).motion, (m, y, w), LANES, 1, [(m, y, w)])


LOOPS = {
    "a step of a beam with 22 modes": _beam,
    "a step of order 8 of a vibrator": lambda: _vibrator(8),
    "a step of order 5 of a vibrator": lambda: _vibrator(5),
    "a series of order 12 of a mole": _mole,
}


def count() -> dict[str, dict[str, float]]:
    """Return the operations of a lane in a step, by loop and unit: in a process of its own."""
    command = [sys.executable, "-c", "from benchmarks import ports; ports.write_counts()"]
    run = subprocess.run(
        command, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, check=True, capture_output=True
    )
    return dict(json.loads(run.stdout))


def write_counts() -> None:
    """Print the counts as JSON, where nothing is compiled."""
    counts = {}
    for name, build in LOOPS.items():
        loop = build()
        most: Counter[str] = Counter()
        for arguments in loop.single:
            Number.done.clear()
            loop.call(*(Memory(a) if isinstance(a, np.ndarray) else a for a in arguments))
            most |= Number.done
        counts[name] = {kind: times / loop.lanes for kind, times in most.items()}
    print(json.dumps(counts))


def limits(counts: dict[str, float], processor: Processor) -> dict[str, float]:
    """Return the cycles that each kind of unit needs for a lane and a step."""
    work = dict(counts)
    if not processor.sums:
        work["fused"] += work.pop("sums")
    return {kind: times / getattr(processor, kind) for kind, times in work.items()}


def cycles(loop: Loop) -> float:
    """Return the measured cycles of a lane and a step."""
    from models.numerics.fma import fma
    from models.numerics.jit import kernel

    call = loop.call

    @kernel
    def chain(x, times):
        for _ in range(times):
            x = fma(x, 0.999, 1e-3)
        return x

    @kernel
    def again(times, *arguments):
        for _ in range(times):
            call(*arguments)

    times = max(1, round(2e6 / (loop.lanes * loop.steps * 100)))
    chain(0.5, 10)
    again(1, *loop.arguments)
    best = {"chain": np.inf, "loop": np.inf}
    for _ in range(TURNS):  # by turns: the clock of a busy computer varies
        for name, run in (
            ("chain", lambda: chain(0.5, CHAIN)),
            ("loop", lambda: again(times, *loop.arguments)),
        ):
            began = time.process_time()
            run()
            best[name] = min(best[name], time.process_time() - began)
    cycle = best["chain"] / (CHAIN * LATENCY)
    return float(best["loop"] / (times * loop.lanes * loop.steps) / cycle)


def main() -> None:
    """Print the table, and keep how far the loops are from their limits."""
    vendor = "AMD" if "AMD" in Path("/proc/cpuinfo").read_text() else "Intel"
    print(f"{vendor}: operations of a lane and a step, and cycles\n")
    print("| loop | products | sums, choices | quotients | loads | stores | limit | measured |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | --- | --- |")
    figures = []
    for name, counts in count().items():
        limit = limits(counts, PROCESSORS[vendor])
        by = max(limit, key=lambda kind: limit[kind])
        taken = cycles(LOOPS[name]())
        kinds = ("fused", "sums", "quotients", "loads", "stores")
        numbers = " | ".join(f"{counts.get(kind, 0):.0f}" for kind in kinds)
        share = f"{taken:.0f} cycles, {limit[by] / taken:.0%} of the limit"
        print(f"| {name} | {numbers} | {limit[by]:.0f}, {NAMES[by]} | {share} |", flush=True)
        least = f"the {limit[by]:.0f} that its {NAMES[by]} take at least"
        figures.append(Figure(f"{name}, {taken:.0f} cycles", least, taken / limit[by], True))
    keep("ports", figures)


if __name__ == "__main__":
    main()
