"""Files and packages of users that bear the names of ours, `uq` and `models`."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import models
import uq
from uq.errors import InputError
from uq.study.installed_models import model_at

HOUSE = Path(uq.__file__).parents[1]
OURS = Path(models.__file__).parent


@pytest.fixture
def first(monkeypatch, folder):
    """The current folder comes first where Python looks, and nothing of ours is imported yet."""
    monkeypatch.delitem(sys.modules, "models")
    monkeypatch.syspath_prepend(folder)
    return folder


@pytest.mark.parametrize("file", ["models.py", "models/__init__.py"])
@pytest.mark.parametrize("text", ["", "import not_there"], ids=["empty", "broken"])
def test_models_of_a_user_that_are_found_first_are_named_beside_ours(first, file, text):
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).write_text(text)
    theirs = first / file.partition("/")[0]
    with pytest.raises(InputError) as refused:
        uq.simulate("ishigami")
    (line,) = refused.value.lines
    assert re.search(rf"{theirs} is another 'models' than .* {OURS}.*; rename", line)


def test_installed_models_that_are_found_first_are_to_be_uninstalled(monkeypatch, folder):
    package = folder / "site-packages" / "models"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    monkeypatch.delitem(sys.modules, "models")
    monkeypatch.syspath_prepend(package.parent)
    with pytest.raises(InputError, match=f"{package} is .*{OURS}.*; uninstall it"):
        uq.simulate("ishigami")


def test_a_folder_without_code_hides_no_model(first):
    Path("models").mkdir()
    Path("models/trained.bin").touch()
    assert model_at("ishigami").name == "ishigami"


MACHINE = """
import uq
{imports}

@uq.machine
def {name}(a: float = 1.0):
    return {{"y": 2 * a}}
"""


@pytest.mark.parametrize(
    ("file", "imports"),
    [("models.py", "import models"), ("models/pads.py", "from models.pads import wear")],
)
def test_a_machine_that_means_the_models_beside_it_gets_no_others(folder, file, imports):
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).write_text("def wear(a): return 2 * a")
    name = f"beside_{Path(file).stem}"
    Path(f"{name}.py").write_text(MACHINE.format(imports=imports, name=name))
    with pytest.raises(InputError) as refused:
        model_at(f"{name}.py")
    (line,) = refused.value.lines
    assert str(OURS) in line and f"{folder / file.partition('/')[0]}; rename" in line


def test_a_machine_may_use_ours_where_others_lie_beside_it(folder):
    Path("models.py").touch()
    imports = "from models.numerics.jit import kernel"
    Path("with_kernel.py").write_text(MACHINE.format(imports=imports, name="with_kernel"))
    assert model_at("with_kernel.py").name == "with_kernel"


def test_the_command_names_both_places(folder):
    Path("models.py").write_text("import not_there")
    done = subprocess.run(
        [sys.executable, "-m", "uq", "simulate", "ishigami"],
        env=os.environ | {"PYTHONPATH": str(HOUSE)},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert f"{folder / 'models.py'} is" in done.stderr and str(OURS) in done.stderr
