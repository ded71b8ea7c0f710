"""Run, read or compare: see the package."""

import gc
import importlib
import json
import os
import pkgutil
import re
import sys
from pathlib import Path

import uq
from benchmarks.record.command import reported
from benchmarks.record.comparing import compare
from benchmarks.record.entries import groups_of, recorded
from benchmarks.record.studies import ANY, LEARNT, SAMPLES, SHIPPED, files, small_studies

QUICK = r"^(lives|ishigami-saltelli|levels|failed|posterior)-small$|^refusals$|^compare never"
"""Groups that cover most of the code, in two minutes."""


def run(folder: Path, only: str) -> None:
    """Run the studies into a folder, without those that are there."""
    _load()
    folder.mkdir(parents=True, exist_ok=True)
    work = {path.stem: (path, SAMPLES.get(path.stem, ANY)) for path in SHIPPED.glob("*.toml")}
    texts = {f"{name}.toml": text for name, text in small_studies().items()}
    for name, text in (files() | texts).items():
        (folder / name).write_text(text)
    work |= {Path(name).stem: (folder / name, 0) for name in texts}
    for name, (study, samples) in sorted(work.items()):
        target = folder / f"{name}.nc"
        size = ("--samples", str(samples)) if samples else ()
        command = ("run", str(study), "-o", str(target), "--quiet", "--workers", "0", *size)
        if re.search(only, name) and not target.exists():
            _show(name, command)
    for name, (before, inspections) in LEARNT.items():
        target = folder / f"{name}.nc"
        sources = (str(folder / f"{before}.nc"), str(folder / inspections))
        if re.search(only, name) and not target.exists():
            _show(name, ("update", *sources, "-o", str(target), "--quiet"))


def _load() -> None:
    """Load every module once, for all forks."""
    for module in pkgutil.walk_packages(uq.__path__, "uq."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    gc.freeze()  # a fork then leaves their memory alone


def _show(name: str, command: tuple[str, ...]) -> None:
    began = _processor_time()
    end = reported(*command)
    print(name, end["code"], f"{_processor_time() - began:.1f} s", end["err"], flush=True)


def _processor_time() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def read(folder: Path, target: Path, only: str) -> None:
    """Record the bits of every variable and what every verb reports."""
    _load()
    entries: dict[str, object] = {}
    for group, make in groups_of(folder).items():
        if re.search(only, group):
            began = _processor_time()
            made = recorded(folder, make)
            entries |= {f"{group}: {name}": entry for name, entry in made.items()}
            target.write_text(json.dumps(entries, indent=1))
            print(group, len(made), f"{_processor_time() - began:.1f} s", flush=True)


def main() -> int:
    """Carry out one of the three commands."""
    os.environ |= {"COLUMNS": "80", "NO_COLOR": "1", "MPLBACKEND": "agg"}
    command, *arguments = sys.argv[1:]
    paths = [Path(path) for path in arguments[: 1 if command == "run" else 2]]
    only = "".join(arguments[len(paths) :]).replace("quick", QUICK)
    if command == "compare":
        return min(compare(paths[0], paths[1], only), 1)
    if command == "run":
        run(paths[0], only)
    else:
        read(paths[0], paths[1], only)
    return 0


if __name__ == "__main__":
    sys.exit(main())
