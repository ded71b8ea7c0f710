"""Files of ``uq init --machine NAME``: a machine, its test, a study and a guide to them."""

import keyword
from importlib.util import find_spec
from pathlib import Path
from string import Template

from uq.cli.printing import console
from uq.errors import InputError

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
