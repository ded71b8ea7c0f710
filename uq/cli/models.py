"""Terminal output of ``uq models``, and the files of ``uq init --machine NAME``."""

import keyword
import shlex
import tomllib
from contextlib import suppress
from dataclasses import asdict
from importlib.util import find_spec
from math import inf
from pathlib import Path
from string import Template
from typing import Any

from uq.cli.printing import console, grid, heading, number, paragraph
from uq.contract import Model, Parameter, Setting
from uq.errors import InputError
from uq.study.installed_models import find_model, model_names
from uq.text.numbers import listed
from uq.text.units import powers, readable


def list_models() -> list[dict[str, str]]:
    """Return name, version and title of every installed model, or why it cannot be imported."""
    listed = []
    for name in model_names():
        try:
            model = find_model(name)
            listed.append({"name": name, "version": model.version, "title": model.title})
        except InputError as error:
            listed.append({"name": name, "version": "", "title": str(error)})
    return listed


def as_json(model: Model) -> dict[str, Any]:
    """Return everything that a model declares, as plain data."""
    defaults = model.settings()
    return {
        "name": model.name,
        "version": model.version,
        "title": model.title,
        "parameters": {
            name: {"nominal": nominal} | _declared(model.parameter(name))
            for name, nominal in model.nominal.items()
        },
        "settings": {
            name: {"default": getattr(defaults, name)} | asdict(model.setting(name))
            for name in model.setting_names
        },
        "outputs": {
            name: asdict(output.given(defaults, model.nominal))
            for name, output in model.outputs.items()
        },
        "coordinates": {dim: list(values) for dim, values in model.coordinates(defaults).items()},
        "references": list(model.references),
    }


def _declared(parameter: Parameter) -> dict[str, Any]:
    """Return the declaration of a parameter; the initial-condition flag only if set."""
    declared = asdict(parameter)
    return {name: value for name, value in declared.items() if name != "initial" or value}


def show_list(listed: list[dict[str, str]]) -> None:
    """Print the models."""
    grid([list(entry.values()) for entry in listed], header=("model", "version", "title"), indent=0)
    console.print("\nuq models NAME shows one of them in full.")


def show(model: Model) -> None:
    """Print one model."""
    heading(model.name, f"{model.title} (version {model.version})")
    heading("\nParameters", "with meaning and source")
    lines = [("name", "symbol", "nominal", "admissible")]
    lines += [_line(model, name) for name in model.parameter_names]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded = [[*map(str.ljust, line, widths)] for line in lines]
    fits = sum(widths) + 2 * (len(widths) - 1) <= console.width
    if fits:
        paragraph("  ".join(padded[0]).rstrip(), indent=0)
    for (name, symbol, nominal, bounds), cells in zip(lines[1:], padded[1:], strict=True):
        if fits:
            heading(cells[0], "  ".join(cells[1:]).rstrip())
        else:
            heading(name, symbol)
            paragraph(f"{nominal}, admissible: {bounds}")
        paragraph(readable(model.parameter(name).meaning))
        paragraph(model.parameter(name).source)
    if model.setting_names:
        heading("\nSettings")
    defaults = model.settings()
    for name in model.setting_names:
        setting = model.setting(name)
        unit = "" if setting.unit == "1" else f" {powers(setting.unit)}"
        heading(f"  {name}", f"{getattr(defaults, name)}{unit}{_allowed(setting)}")
        paragraph(setting.meaning)
    heading("\nOutputs")
    for name, output in model.outputs.items():
        dims = f"({', '.join(output.dims)})" if output.dims else ""
        unit = "" if output.unit == "1" else f" [{powers(output.unit)}]"
        heading(f"  {name}{dims}", f"{output.kind}{unit}")
        paragraph(readable(output.meaning))
        if output.categories:
            paragraph(listed(output.categories))
    if model.references:
        heading("\nReferences")
    for reference in model.references:
        paragraph(reference)


def _line(model: Model, name: str) -> tuple[str, str, str, str]:
    parameter = model.parameter(name)
    unit = "" if parameter.unit == "1" else f" {powers(parameter.unit)}"
    bounds = " to ".join(map(number, parameter.bounds))
    return name, parameter.symbol, f"{model.nominal[name]:.6g}{unit}", bounds


def _allowed(setting: Setting) -> str:
    if setting.choices:
        return f", one of {', '.join(setting.choices)}"
    if setting.bounds:
        return ", " + " to ".join(map(number, setting.bounds))
    return ""


_FILES = {
    "$name.py": '''"""$name: what it models, in one line."""

from math import inf
from typing import Annotated

import uq


@uq.machine(returns={"life": uq.Returned("s", "time until the pad is worn", life=True)})
def $name(
    load: Annotated[float, "N", (0.0, 1e4), "force on the pad"] = 100.0,
    speed: Annotated[float, "m s-1", (0.0, 10.0), "sliding speed"] = 0.5,
    depth: Annotated[float, "m", (1e-6, 1e-2), "depth that may be worn"] = 1e-3,
):
    """Wear of a pad by Archard's law."""
    rate = 1e-12 * load * speed  # [m s-1]
    return {"life": depth / rate if rate > 0 else inf}
''',
    "test_$name.py": '''"""Tests of $name."""

from math import inf
from importlib.util import find_spec
from pathlib import Path

import uq
from $name import $name

HERE = Path(__file__).parent


def test_a_known_life():
    assert $name(load=100.0, speed=0.5, depth=1e-3)["life"] == 1e-3 / (1e-12 * 100.0 * 0.5)


def test_without_load_it_never_ends():
    assert $name(load=0.0)["life"] == inf


def test_the_study_runs(tmp_path):
    study = uq.load_study(HERE / "$name.toml", str(HERE / "$name.py"))
    ds = uq.run(study.with_samples(20), tmp_path / "result.nc", workers=0)
    assert (ds["status"] == 0).all()
''',
    "$name.toml": """[study]
name = "$name"
model = "$name"
description = "How long does the pad last?"

[design]
method = "monte-carlo"
samples = 1000
seed = 1

[uncertain.load]
distribution = "lognormal"
mean = 100.0
cv = 0.2
source = "assumed: replace with your own"

[uncertain.speed]
distribution = "uniform"
lower = 0.3
upper = 0.7
source = "assumed: replace with your own"

[analysis]
thresholds = { life = "150 days" }
""",
    "README.md": """# $name

    uq simulate $name.py                       # one row, at the nominal values
    uq run $name.toml --model $name.py         # 1,000 rows, and the answer
    uq report results/$name.nc --open          # figures and tables
    python -m pytest                           # the machine's own tests, with pytest installed

`$name.py` is the machine: replace its arguments and what it returns by yours. `$name.toml` is the
study: which arguments are uncertain, and how many rows.
""",
}


def write_machine(name: str) -> None:
    """Write the files of a machine into a new folder of its name.

    Raises
    ------
    InputError
        When it cannot be the name of a module, or is that of another one, a file or a folder.
    """
    if not name.isidentifier() or keyword.iskeyword(name) or not name.islower():
        raise InputError(f"uq: --machine {name}: must be a name such as 'pad' or 'worn_pad'")
    folder = Path(name)
    if folder.exists():
        raise InputError(f"uq: {folder}: exists already; choose another name")
    if find_spec(name) is not None:
        raise InputError(f"uq: --machine {name}: is the name of another module; choose another")
    try:
        folder.mkdir()
    except OSError as error:
        raise InputError(f"uq: {folder}: {error.strerror or error}") from None
    for file, text in _FILES.items():
        file_name = Template(file).substitute(name=name)
        (folder / file_name).write_text(Template(text).substitute(name=name), encoding="utf-8")
    console.print(
        f"{folder}: {', '.join(Template(template).substitute(name=name) for template in _FILES)}"
    )
    console.print(f"Next: cd {name} && uq run {name}.toml --model {name}.py", soft_wrap=True)


_STEPS = (
    ("uq models", "list the models"),
    ("uq init beam > mine.toml", "write a commented study to edit"),
    ("uq check mine.toml", "check it, and show what would run"),
    ("uq run mine.toml", "compute it, into results/NAME.nc"),
    ("uq report results/NAME.nc --open", "show everything on one page, in the browser"),
)

_MINUTE = 60.0  # [s]


def guide() -> None:
    """Print the steps to a report, and possible commands for the files in this folder."""
    heading("uq", "lifetime and sensitivity studies of vibro-impact machines")
    grid(_STEPS)
    if here := _with_what_is_here():
        heading("\nIn this folder")
        for command, words in here:
            console.print(f"  {command}", soft_wrap=True)
            paragraph(words, indent=6)
    console.print("\nuq --help lists all commands; uq COMMAND --help explains one.")


def _with_what_is_here() -> list[tuple[str, str]]:
    lines = []
    for folder, ending, verb, words in (
        ("studies", "toml", "run {}", "run this study"),
        ("results", "nc", "report {} --open", "read this result"),
    ):
        files = sorted(Path(folder).glob(f"*.{ending}"), key=_latest_and_shortest)
        if files:
            others = f"one of {len(files) - 1} others" if files[2:] else "1 other"
            more = f", or {others} in {folder}/" if files[1:] else ""
            name = shlex.quote(str(files[0]))
            model = _model_option(files[0]) if ending == "toml" else ""
            lines.append((f"uq {verb.format(name)}{model}", words + more))
    return lines


def _latest_and_shortest(file: Path) -> tuple[float, int, str]:
    """Return the key that puts the last edited file first, the shortest of a fresh checkout."""
    try:
        status = file.stat()
    except OSError:
        return inf, 0, file.name
    return -(status.st_mtime // _MINUTE), status.st_size, file.name


def _model_option(study: Path) -> str:
    """Return ``--model`` and a file, after a blank, for a study of a model in a file here."""
    from uq.study.installed_models import model_names
    from uq.study.model_files import file_with

    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        model = tomllib.loads(study.read_text("utf-8-sig"))["study"]["model"]
        if model not in model_names() and (file := file_with(model, (Path(), study.parent))):
            return f" --model {file}"
    return ""
