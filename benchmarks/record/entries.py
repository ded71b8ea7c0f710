"""Entries of the record."""

import json
import re
import shlex
import shutil
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

import uq
from benchmarks.record.command import forked, reported
from benchmarks.record.mistakes import FILES, MISTAKES
from benchmarks.record.plain import digest, embedded, outcome_of, words_of
from benchmarks.record.studies import METHODS, SHIPPED, files, small_studies
from benchmarks.record.verbs import DRAWN, TRACED, commands_of, endings_of, has_page

PAIRS = (
    ("ishigami-monte-carlo-small", "ishigami-sobol-small"),
    ("exponential-wear-monte-carlo-small", "lives-small"),
    ("never-small", "lives-small"),
    ("failed-small", "correlated-small"),
    ("fleet-small", "posterior-small"),
    ("beam-lifetime", "beam-lifetime-561"),
)
Entries = Iterator[tuple[str, object]]


def groups_of(results: Path) -> dict[str, Callable[[Path], Entries]]:
    """Return what makes the entries of each group, from a folder with the results."""
    groups: dict[str, Callable[[Path], Entries]] = {
        path.stem: partial(of_result, path.stem) for path in sorted(results.glob("*.nc"))
    }
    groups |= {f"{name} traces": partial(_traced, name) for name in TRACED if name in groups}
    groups |= {f"{name} figures": partial(_drawn, name) for name in DRAWN if name in groups}
    groups |= {
        f"compare {first} {second}": partial(_compared, first, second)
        for first, second in PAIRS
        if first in groups and second in groups
    }
    return groups | {
        "refusals": _refusals,
        "more rows": _more_rows,
        "commands": _commands,
    }


def recorded(results: Path, group: Callable[[Path], Entries]) -> dict[str, object]:
    """Return the entries of a group: commands are carried out in a folder of their own."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, text in files().items():
            (folder / name).write_text(text)
        folder.joinpath("results").symlink_to(results.absolute())
        return dict(group(folder))


def of_result(name: str, folder: Path) -> Entries:
    """Yield the bits of the variables of a result, and what the verbs report of it."""
    file = _copied(folder, name)
    yield from _variables(folder / file)
    with xr.open_dataset(folder / file, decode_times=False) as ds:
        design, weighted = ds.attrs["design"], "weight" in ds
    methods = () if weighted else METHODS[design][1:]
    for verb, *options in commands_of(name, methods):
        yield from _reported(folder, verb, file, *options)
    if not has_page(name):
        return
    report = reported("report", file, "-o", "report.html", folder=folder)
    yield "report", outcome_of(report)
    page = folder / "report.html"
    text = page.read_text() if page.exists() else ""
    yield "report page", words_of(text).splitlines()
    yield "report data", embedded(text)


def _drawn(name: str, folder: Path) -> Entries:
    """Yield the figures of a result."""
    file = _copied(folder, name)
    yield "plot", outcome_of(reported("plot", file, "-o", "plots", folder=folder))
    for path in sorted(folder.glob("plots/*")):
        yield path.name, digest(path.read_bytes())


def _variables(file: Path) -> Entries:
    with xr.open_dataset(file, decode_times=False) as ds:
        for key in sorted(map(str, ds.variables)):
            values = ds[key].values
            if values.dtype.kind not in "OU":
                yield f"variable {key}", digest(values.tobytes())
        yield (
            "attributes",
            {
                str(key): {name: str(value) for name, value in sorted(ds[key].attrs.items())}
                for key in sorted(map(str, ds.variables))
            },
        )
        yield "identity", ds.attrs["study_identity"]


def _traced(name: str, folder: Path) -> Entries:
    file = _copied(folder, name)
    keys: list[str] = []
    for begin, command in TRACED[name].items():
        verb, *options = shlex.split(command)
        outcome = outcome_of(reported(verb, file, *options, "--json", folder=folder))
        if outcome["code"] == 0:
            keys += ["/".join(filter(None, (begin, path))) for path in _numbers_of(outcome["out"])]
        else:
            yield f"numbers of {command}", outcome
    reported("report", file, "-o", "report.html", folder=folder)
    page = (folder / "report.html").read_text()
    keys += sorted({*re.findall(r'data-trace="(inputs/[^"\n]*)', page)})
    outcome = forked(partial(_print_traces, file, keys), folder)
    yield from zip(keys, map(outcome_of, json.loads(str(outcome["out"]))), strict=True)


def _print_traces(file: str, keys: list[str]) -> None:
    ds = uq.open_result(file)
    outcomes = []
    for key in keys:
        try:
            outcome = {"code": 0, "out": json.dumps(uq.trace(ds, key).to_dict()), "err": ""}
        except uq.InputError as error:
            outcome = {"code": 2, "out": "", "err": str(error)}
        outcomes.append(outcome)
    print(json.dumps(outcomes))


def _numbers_of(entry: Any, path: str = "") -> Iterator[str]:
    """Yield the path of every number in JSON, of an estimate as a whole."""
    if isinstance(entry, dict) and "value" in entry:
        yield path
    elif isinstance(entry, dict | list):
        for name, inner in entry.items() if isinstance(entry, dict) else enumerate(entry):
            part = str(name).replace("~", "~0").replace("/", "~1")
            yield from _numbers_of(inner, f"{path}/{part}" if path else part)
    elif isinstance(entry, int | float) and not isinstance(entry, bool):
        yield path


def _compared(first: str, second: str, folder: Path) -> Entries:
    yield from _reported(folder, "compare", _copied(folder, first), _copied(folder, second))


def _refusals(folder: Path) -> Entries:
    for name in FILES:
        _copied(folder, name)
    for name, text in small_studies().items():
        (folder / f"{name}.toml").write_text(text)
    for command in MISTAKES:
        yield command, outcome_of(reported(*shlex.split(command), folder=folder))


def _more_rows(folder: Path) -> Entries:
    """Yield what runs of small studies print, and their rows after `extend` and `rerun`."""
    commands = (
        "run lives-small.toml -o lives-small.nc --workers 0",
        "run lives-small.toml -o lives-small.nc --workers 0",
        "extend lives-small.nc --samples 250 --workers 0",
        "run failed-small.toml -o failed-small.nc --workers 0",
        "rerun failed-small.nc --failed --setting fail_above=2.0 --workers 0",
        "run until-small.toml -o until-small.nc --workers 0",
        "update lives-small.toml single.csv -o posterior.nc --rows 150 --workers 0",
        "update levels-small.nc more.csv -o new.nc --rows 150 --workers 0",
        "init --machine pad",
    )
    for name, text in small_studies().items():
        (folder / f"{name}.toml").write_text(text)
    for number, command in enumerate(commands):
        outcome = outcome_of(reported(*shlex.split(command), folder=folder))
        yield f"{number} {command}", outcome
    for file in sorted(folder.glob("*.nc")):
        yield from ((f"{file.stem} {name}", entry) for name, entry in _variables(file))


def _commands(folder: Path) -> Entries:
    yield from _reported(folder, "models")
    for command in ("schema", "--help"):
        yield command, outcome_of(reported(command, folder=folder))
    models = outcome_of(reported("models", "--json", folder=folder))["out"]
    assert isinstance(models, list | dict)
    for model in map(_name, models):
        yield from _reported(folder, "models", model)
        yield from _reported(folder, "simulate", model)
        yield f"init {model}", outcome_of(reported("init", model, folder=folder))
    for study in sorted(SHIPPED.glob("*.toml")):
        shutil.copy(study, folder)
        yield f"check {study.name}", outcome_of(reported("check", study.name, folder=folder))
    rare = ["rare-event", "exponential-wear.toml", "--output", "life"]
    rare += ["--below", "3e4", "--samples", "200", "--workers", "0"]
    yield from _reported(folder, *rare)
    yield from _reported(folder, *rare, "--method", "importance")


def _name(model: Any) -> str:
    return str(model["name"] if isinstance(model, dict) else model)


def _reported(folder: Path, verb: str, *arguments: str) -> Entries:
    options = [word for word in arguments if not word.endswith(".nc")]
    for ending in endings_of(Path(arguments[0] if arguments else "").stem, verb):
        outcome = outcome_of(reported(verb, *arguments, *ending, folder=folder))
        yield " ".join([verb, *options, *ending]), outcome
        for made in folder.glob("posterior.nc"):
            made.unlink()


def _copied(folder: Path, name: str) -> str:
    shutil.copy(folder / "results" / f"{name}.nc", folder)
    return f"{name}.nc"
