"""Run, read or compare: see the package."""

import difflib
import hashlib
import importlib
import json
import os
import pkgutil
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import xarray as xr

import uq
from benchmarks.record.command import reported
from benchmarks.record.studies import ANY, SAMPLES, SHIPPED, small_studies
from uq.indices.methods import fed_by
from uq.sampling.designs import DESIGNS
from uq.study.installed_models import model_names

PAIRS = (
    ("ishigami-monte-carlo-small", "ishigami-sobol-small"),
    ("exponential-wear", "exponential-wear-monte-carlo-small"),
    ("never-small", "exponential-wear"),
    ("beam-lifetime", "beam-lifetime-561"),
    ("failed-small", "correlated-small"),
)


def run(folder: Path, only: str) -> None:
    """Run the studies into a folder, without those that are there."""
    folder.mkdir(parents=True, exist_ok=True)
    work = {path.stem: (path, SAMPLES.get(path.stem, ANY)) for path in SHIPPED.glob("*.toml")}
    for name, text in small_studies().items():
        path = folder / f"{name}.toml"
        path.write_text(text)
        work[name] = (path, 0)
    for name, (study, samples) in sorted(work.items()):
        target = folder / f"{name}.nc"
        if re.search(only, name) and not target.exists():
            size = ("--samples", str(samples)) if samples else ()
            end = reported("run", str(study), "-o", str(target), "--quiet", "--workers", "0", *size)
            print(name, end["code"], str(end["err"]).strip(), flush=True)


def read(folder: Path, only: str) -> dict[str, object]:
    """Return the bits of every variable and what every verb reports."""
    for module in pkgutil.walk_packages(uq.__path__, "uq."):  # loaded once, for all forks
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    entries: dict[str, object] = {}
    for path in sorted(folder.glob("*.nc")):
        if re.search(only, path.stem):
            entries |= {f"{path.stem}: {entry}": value for entry, value in _of_result(path)}
            print(path.stem, flush=True)
    for pair in PAIRS:
        files = [str(folder / f"{name}.nc") for name in pair]
        if re.search(only, "compare") and all(map(os.path.exists, files)):
            entries |= _reported("compare", *files)
    if re.search(only, "commands"):
        entries |= _commands()
    return entries


def _of_result(path: Path) -> Iterator[tuple[str, object]]:
    with xr.open_dataset(path, decode_times=False) as ds:
        yield (
            "variables",
            {
                str(key): hashlib.sha256(ds[key].values.tobytes()).hexdigest()[:16]
                + json.dumps({k: str(v) for k, v in sorted(ds[key].attrs.items())})
                for key in sorted(map(str, ds.variables))
                if ds[key].dtype.kind not in "OU"
            },
        )
        yield "identity", ds.attrs["study_identity"]
        methods = fed_by(DESIGNS[ds.attrs["design"]])
    commands = [["status"], ["summary", "--fits"], ["convergence"], ["sensitivity"]]
    commands += [["sensitivity", "--method", method] for method in methods[1:]]
    commands += [["twin"]] if "tolerances" in path.stem else []
    for verb, *options in commands:
        yield from _reported(verb, str(path), *options).items()
    with tempfile.TemporaryDirectory() as scratch:
        page = Path(scratch, "report.html")
        yield "report", _without_paths(reported("report", str(path), "-o", str(page)))
        text = page.read_text() if page.exists() else ""
        yield "report page", re.sub(r"base64,[^\"')]*", "base64,...", text)
        yield "plot", _without_paths(reported("plot", str(path), "-o", f"{scratch}/plots"))
        yield (
            "figures",
            {
                file.name: hashlib.sha256(file.read_bytes()).hexdigest()[:16]
                for file in sorted(Path(scratch, "plots").glob("*"))
            },
        )


def _commands() -> dict[str, object]:
    entries = _reported("models") | {command: reported(command) for command in ("schema", "--help")}
    for model in model_names():
        entries |= _reported("models", model) | _reported("simulate", model)
        entries[f"init {model}"] = reported("init", model)
    for study in sorted(SHIPPED.glob("*.toml")):
        entries[f"check {study}"] = reported("check", str(study))
    rare = ["rare-event", str(SHIPPED / "exponential-wear.toml"), "--output", "life"]
    rare += ["--below", "3e4", "--samples", "200", "--workers", "0"]
    return entries | _reported(*rare) | _reported(*rare, "--method", "importance")


def _reported(*command: str) -> dict[str, object]:
    words = [re.sub(r".*/", "", word) for word in command]
    return {
        " ".join([*words, *ending]): reported(*command, *ending) for ending in ((), ("--json",))
    }


def _without_paths(outcome: dict[str, object]) -> dict[str, object]:
    return outcome | {"out": re.sub(r"\S*/(\S+)", r"\1", re.sub(r"\s+", " ", str(outcome["out"])))}


def compare(first: Path, second: Path, only: str) -> int:
    """Print what differs, and return how many entries do."""
    a, b = (json.loads(path.read_text()) for path in (first, second))
    keys = [key for key in {**a, **b} if re.search(only, key)]
    absent = [key for key in keys if (key in a) != (key in b)]
    different = [key for key in keys if key not in absent and a[key] != b[key]]
    for key in different:
        print(f"=== {key}")
        sides = [json.dumps(side[key], indent=1).replace("\\n", "\n") for side in (a, b)]
        lines = difflib.unified_diff(*map(str.splitlines, sides), lineterm="", n=0)
        print(*list(lines)[2:42], sep="\n")
    for key in absent:
        print(f"=== {key}: on one side only")
    print(f"{len(keys)} entries, {len(different)} differ, {len(absent)} on one side only")
    return len(different) + len(absent)


def main() -> int:
    """Carry out one of the three commands."""
    os.environ |= {"COLUMNS": "80", "NO_COLOR": "1", "MPLBACKEND": "agg"}
    command, *arguments = sys.argv[1:]
    paths = [Path(path) for path in arguments[: 1 if command == "run" else 2]]
    only = "".join(arguments[len(paths) :])
    if command == "compare":
        return min(compare(*paths, only), 1)
    if command == "run":
        run(*paths, only)
    else:
        paths[1].write_text(json.dumps(read(paths[0], only), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
