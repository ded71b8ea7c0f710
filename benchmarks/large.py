"""CPU time and memory of what reads large results; each command runs in a process of its own.

``python -m benchmarks.large``: analyses of a million rows of ten inputs and twenty outputs.
``python -m benchmarks.large verbs [ROWS]``: every verb that reads a result, of ten million rows of
three inputs and one output; it prints the table of `docs/scaling.md`.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np

from benchmarks.coverage.problems import Settings, computed, study_of
from uq.contract import Model, Output, Parameter

INPUTS, OUTPUTS = 10, 20


def _input(i):
    return Annotated[float, Parameter(f"x_{i}", "1", "a number", (0.0, 1.0), "none")]


Ten = NamedTuple("Ten", [(f"x{i}", _input(i)) for i in range(INPUTS)])  # noqa: UP014
Ten._field_defaults.update(dict.fromkeys(Ten._fields, 0.5))


LAWS = dict.fromkeys(Ten._fields, {"distribution": "uniform", "lower": 0.0, "upper": 1.0})


def machine(name, title, batch):
    """Return a model of ten inputs and twenty outputs."""
    outputs = {f"y{k}": Output("1", f"output {k}") for k in range(OUTPUTS)}
    return Model(name, title, "1", Ten, Settings, outputs, batch)


def _batch(x, seed, settings):
    weights = np.random.default_rng(0).random((OUTPUTS, INPUTS)) ** 4
    outputs = {
        f"y{k}": np.sin(3 * x @ w) + x @ w + x[:, 0] * x[:, 1] for k, w in enumerate(weights)
    }
    return outputs, np.zeros(len(x), np.int8)


LARGE = machine("large", "ten inputs and twenty outputs", _batch)
ANALYSIS = {
    "quantiles": [0.01, 0.05, 0.5, 0.95, 0.99],
    "thresholds": {f"y{k}": [1.0] for k in range(OUTPUTS)},
}
DESIGNS = {
    "plain": ("monte-carlo", 1_000_000, 1),
    "replicates": ("sobol", 2**17, 8),
    "crossed": ("saltelli", 2**13, 11),
}
COMMANDS = {
    "summary": ("plain", ("summary",), 15),
    "summary of 8 replicates": ("replicates", ("summary",), 20),
    "Sobol' indices with intervals": ("crossed", ("sensitivity",), 60),
    "RBD-FAST": ("plain", ("sensitivity", "--method", "rbd-fast"), None),
    "delta": ("plain", ("sensitivity", "--method", "delta"), None),
    "PAWN": ("plain", ("sensitivity", "--method", "pawn"), None),
    "quantile-oriented": ("plain", ("sensitivity", "--method", "quantile"), 6),
    "HDMR, one output": ("plain", ("sensitivity", "--method", "hdmr", "--output", "y0"), None),
}
MOST_MEMORY = 3.0  # GB

MANY = """
study = {{name = "many", model = "ishigami"}}
design = {{method = "monte-carlo", samples = {rows}, seed = 2026}}
analysis = {{thresholds = {{y = 10.0}}}}
[uncertain]
x1 = {{distribution = "uniform", lower = -3.14159, upper = 3.14159}}
x2 = {{distribution = "uniform", lower = -3.14159, upper = 3.14159}}
x3 = {{distribution = "uniform", lower = -3.14159, upper = 3.14159}}
"""
ROWS = 10_000_000
VERBS = (
    "summary {result}",
    "summary {result} --full",
    "sensitivity {result}",
    "sensitivity {result} --method quantile",
    "convergence {result}",
    "compare {result} {other}",
    "what-if {result} --set uncertain.x1.upper=3.0",
    "trace {result} outputs/y/mean",
    "row {result} 5",
    "row {result} --highest y",
    "status {result}",
    "verify {result}",
    "emulate {result} -o {folder}/y.emulator",
    "export {result} --csv {folder}/rows.csv",
    "plot {result} -o {folder}/plots",
    "report {result} -o {folder}/page.html",
)


def verbs(rows=ROWS):
    """Print a table of the verbs that read a result: CPU time and memory of each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = folder / "many.toml"
        study.write_text(MANY.format(rows=rows))
        places = {"folder": name, "result": folder / "many.nc", "other": folder / "other.nc"}
        run = ["run", str(study), "--quiet", "--workers", "0", "-o"]
        print("| verb | CPU time | memory |\n| --- | ---: | ---: |")
        _print_line("uq run --workers 0", _taken([*run, str(places["result"])]))
        _taken([*run, str(places["other"]), "--samples", str(rows // 10)])
        for verb in VERBS:
            taken = _taken([word.format(**places) for word in verb.split()])
            options = [word for word in verb.split() if "{" not in word and word != "-o"]
            _print_line(f"uq {' '.join(options)}", taken)


def _print_line(name, taken):
    seconds, memory = taken
    print(f"| `{name}` | {seconds:.0f} s | {memory:.1f} GB |", flush=True)


def main(chosen):
    """Time the chosen commands, or all."""
    if chosen[:1] == ["verbs"]:
        return verbs(*map(int, chosen[1:]))
    late = []
    with tempfile.TemporaryDirectory() as folder:
        files = {}
        for title, (name, arguments, most) in COMMANDS.items():
            if chosen and not any(title.startswith(prefix) for prefix in chosen):
                continue
            if name not in files:
                files[name] = _written(Path(folder), name)
            seconds, memory = _taken([arguments[0], str(files[name]), *arguments[1:], "--json"])
            asked = "" if most is None else f" (at most {most} s and {MOST_MEMORY:g} GB)"
            print(f"{title:32} {seconds:6.1f} s, {memory:.2f} GB{asked}", flush=True)
            if most is not None and (seconds > most or memory > MOST_MEMORY):
                late.append(title)
    return f"too slow or too large: {', '.join(late)}" if late else 0


def _written(folder, name):
    method, samples, replicates = DESIGNS[name]
    path = folder / f"{name}.nc"
    study = study_of(method, samples, replicates, "benchmarks.large:LARGE", LAWS, analysis=ANALYSIS)
    ds = computed(study)
    ds.to_netcdf(path)
    print(f"{name}: {ds.sizes['row']:,} rows, {path.stat().st_size / 1e6:.0f} MB", flush=True)
    return path


def _taken(arguments):
    """Return the CPU time of a command [s] and the most memory that it held [GB]."""
    code = (
        "import resource, sys\n"
        "from uq.cli import main\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    used = resource.getrusage(resource.RUSAGE_SELF)\n"
        "    print(used.ru_utime + used.ru_stime, used.ru_maxrss, file=sys.stderr)\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False
    )
    if ended.returncode:
        raise RuntimeError(ended.stderr)
    seconds, memory = ended.stderr.split()[-2:]
    return float(seconds), int(memory) * 1024 / 1e9


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
