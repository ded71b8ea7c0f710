"""Rows of a model whose sources were edited are not mixed with those of before."""

import shutil
import sys

import pytest

from uq.errors import InputError
from uq.study.installed_models import code_of, model_at
from uq.study.sources import fingerprint


def anew(reference):
    """Return what the code of a model is in a new process."""
    fingerprint.cache_clear()
    return code_of(reference)


FILES = {
    "__init__.py": "",
    "model.py": "from plant.parts import (\n    pump,\n    valve,\n)\nimport plant.tank\n",
    "parts/__init__.py": "from ..laws import law\n",
    "parts/pump.py": "def work():\n    from plant import late\n",
    "parts/valve.py": "import numpy\n",
    "laws.py": "law = 1\n",
    "late.py": "when = 2\n",
    "tank.py": "from .laws import law\n",
    "other.py": "import plant.model\n",
}


@pytest.fixture
def plant(folder, monkeypatch):
    """Write a package, and return a function that tells the code of its model."""
    monkeypatch.syspath_prepend(folder)
    for name, text in FILES.items():
        (folder / "plant" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "plant" / name).write_text(text)
    return lambda: anew("plant.model:MODEL")


@pytest.mark.parametrize("name", FILES)
def test_code_is_what_a_model_imports_of_its_package(plant, folder, name):
    before = plant()
    file = folder / "plant" / name
    file.write_text(file.read_text() + "# edited\n")
    assert (plant() == before) == (name == "other.py")


def test_code_is_the_same_wherever_it_lies(plant, folder, monkeypatch):
    before = plant()
    shutil.move(folder / "plant", folder / "elsewhere" / "plant")
    monkeypatch.syspath_prepend(folder / "elsewhere")
    assert plant() == before


def test_a_module_of_one_file_is_a_model_too(folder, monkeypatch):
    monkeypatch.syspath_prepend(folder)
    (folder / "alone.py").write_text("a = 1\n")
    before = anew("alone:MODEL")
    (folder / "alone.py").write_text("a = 2\n")
    assert anew("alone:MODEL") != before


def test_installed_machines_have_codes_of_their_own():
    assert len({code_of(name) for name in ("beam", "vibrator", "mole", "linear")}) == 4
    assert code_of("linear") == code_of("models.analytic:LINEAR")


def test_files_beside_a_model_count_where_they_are_imported(folder, monkeypatch):
    monkeypatch.syspath_prepend(folder)
    (folder / "alone.py").write_text("from helper import a\n")
    (folder / "helper.py").write_text("a = 1\n")
    (folder / "bystander.py").write_text("a = 1\n")
    before = anew("alone:MODEL")
    (folder / "bystander.py").write_text("a = 2\n")
    assert anew("alone:MODEL") == before
    (folder / "helper.py").write_text("a = 2\n")
    assert anew("alone:MODEL") != before


@pytest.mark.parametrize(
    "line",
    [
        "f = importlib.import_module('plant.hidden')",
        "f = importlib.import_module('.hidden', __package__)",
        "f = import_module(name)",
        "f = __import__('plant.hidden')",
    ],
)
def test_a_module_imported_by_a_call_counts(plant, folder, line):
    (folder / "plant" / "laws.py").write_text(f"{line}\n")
    (folder / "plant" / "hidden.py").write_text("a = 1\n")
    before = plant()
    (folder / "plant" / "hidden.py").write_text("a = 2\n")
    assert plant() != before


@pytest.mark.parametrize("name", ["tools.py", "tools/__init__.py", "tools/deep/one.py"])
def test_sources_in_another_folder_count_unless_installed(folder, monkeypatch, name):
    def counts(where):
        monkeypatch.syspath_prepend(where)
        (where / name).parent.mkdir(parents=True, exist_ok=True)
        (where / name).write_text("a = 1\n")
        before = anew("alone:MODEL")
        (where / name).write_text("a = 2\n")
        return before != anew("alone:MODEL")

    monkeypatch.syspath_prepend(folder / "project")
    (folder / "project").mkdir()
    (folder / "project" / "alone.py").write_text("import tools\nfrom tools.deep import one\n")
    assert counts(folder / "elsewhere")
    assert not counts(folder / "site-packages")


def test_a_model_in_the_working_folder_has_a_code_at_once(folder, monkeypatch):
    """As in ``uq verify``, which asks for it before the model is imported."""
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry])
    (folder / "fresh_model.py").write_text("a = 1\n")
    first = anew("fresh_model:MODEL")
    (folder / "fresh_model.py").write_text("a = 2\n")
    assert anew("fresh_model:MODEL") != first


def test_a_package_without_init_has_a_code(folder, monkeypatch):
    monkeypatch.syspath_prepend(folder)
    (folder / "open_package").mkdir()
    (folder / "open_package" / "model.py").write_text("a = 1\n")
    before = anew("open_package.model:MODEL")
    (folder / "open_package" / "model.py").write_text("a = 2\n")
    assert anew("open_package.model:MODEL") != before


@pytest.mark.parametrize("reference", ["nowhere.to.be:FOUND", "..:x", ":x", "builtins:MODEL"])
def test_no_source_is_no_code(reference):
    with pytest.raises(InputError, match=f"model '{reference}': no source file of module"):
        code_of(reference)
    with pytest.raises(InputError, match="no such model 'nothing'"):
        code_of("nothing")


def test_the_code_is_that_which_was_imported(folder, monkeypatch):
    """In a notebook a file may be edited before a study is run."""
    monkeypatch.syspath_prepend(folder)
    text = "from models.analytic import LINEAR as MODEL\n"
    (folder / "edited_later.py").write_text(text)
    model_at("edited_later:MODEL")
    (folder / "edited_later.py").write_text(f"{text}# edited\n")
    imported = code_of("edited_later:MODEL")
    assert anew("edited_later:MODEL") != imported
    (folder / "edited_later.py").write_text(text)
    assert anew("edited_later:MODEL") == imported
