"""What the documentation names exists, its examples run, and what it quotes is what is printed."""

import ast
import doctest
import importlib
import re
import shutil
import sys
import threading
import tomllib
from inspect import isfunction
from pathlib import Path

import generated
import house
import pages
import pytest
import quoted
import sketches
import yaml
from matplotlib import pyplot

import uq as public
from uq import plots
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.cli.summary_tables import show_summary
from uq.errors import InputError
from uq.render.html.page import page
from uq.result.result import Result
from uq.study.definition import study_from_text
from uq.study.installed_models import find_model, model_names

HOUSE = Path(__file__).parents[2]

SOURCES = {
    str(path.relative_to(HOUSE)): path.read_text(encoding="utf-8")
    for path in (HOUSE / "README.md", HOUSE / "CONTRIBUTING.md", *(HOUSE / "docs").rglob("*.md"))
}
SOURCES["docs/gallery.md"] = pages.expanded(SOURCES["docs/gallery.md"])
every_source = pytest.mark.parametrize("name", SOURCES)

ROOT_OPTIONS = ("--help", "--version", "--install-completion", "--show-completion")
ELSEWHERE = ("docs/clusters.md", "docs/gallery.md", *quoted.PAGES)
"""Pages whose Python needs a cluster, or is run by a test of its own."""
EXAMPLES = sorted(
    {
        public_function.__module__
        for name in public.__all__
        if isfunction(public_function := getattr(public, name))
    }
)


def blocks(name, language):
    """Return the fenced blocks of one language in a page."""
    return re.findall(rf"^```{language}\n(.*?)^```", SOURCES[name], re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("module", ["generated.markdown", "uq.contract", *EXAMPLES])
def test_examples_in_docstrings_run(module, folder):
    shutil.copytree(HOUSE / "studies", "studies")
    results = doctest.testmod(importlib.import_module(module), extraglobs={"uq": public})
    assert results.failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder()
    shown = {
        module
        for module in EXAMPLES
        if any(test.examples for test in finder.find(importlib.import_module(module)))
    }
    assert len(shown) >= len(EXAMPLES) / 2


@every_source
def test_links_to_headings_lead_to_one(name):
    here = (HOUSE / name).parent
    for link, heading in re.findall(r"\]\(([\w./-]*\.md)?#([\w-]+)\)", SOURCES[name]):
        page = str((here / link).resolve().relative_to(HOUSE)) if link else name
        assert heading in slugs(pages.expanded(SOURCES[page])), f"{link}#{heading}"


def slugs(text):
    """Return the anchors of the headings of a page, as GitHub and myst-parser make them."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@every_source
def test_directives_stand_for_something(name):
    assert "{{ " not in pages.expanded(SOURCES[name])


@every_source
def test_commands_and_their_options_exist(name):
    verbs = generated.commands()
    code = re.findall(r"`(uq [^`\n]+)`", SOURCES[name])
    lines = [line for block in blocks(name, "sh") for line in block.splitlines()]
    for command in (*code, *(line for line in lines if line.startswith("uq "))):
        verb, *rest = command.partition("#")[0].split()[1:]
        if verb == "VERB" or verb in ROOT_OPTIONS:
            continue
        assert verb in verbs, command
        options = {text for option in verbs[verb].params for text in option.opts} | {"--help"}
        assert {word for word in rest if word.startswith("--")} <= options, command


@every_source
def test_studies_shown_are_accepted(name):
    for block in blocks(name, "toml"):
        if "machine" in tomllib.loads(block):
            continue  # a machine file
        refusals = {model: refusal(block, model) for model in models_of(block)}
        assert not all(refusals.values()), (block, refusals)


def models_of(block):
    model = tomllib.loads(block).get("study", {}).get("model")
    return [model] if model else model_names()


def refusal(block, model):
    """Return why a part of a study is refused, completed by the least that a study needs."""
    data = tomllib.loads(block)
    text = block
    if "study" not in data:
        text += f'\n[study]\nname = "shown"\nmodel = "{model}"\n'
    if "design" not in data:
        text += '\n[design]\nmethod = "monte-carlo"\nsamples = 64\n'
    if "uncertain" not in data:
        name, nominal = next(iter(find_model(model).nominal.items()))
        upper = 0.999 * nominal + 0.001 * find_model(model).parameter(name).bounds[1]
        law = f'{{distribution = "uniform", lower = {nominal!r}, upper = {upper!r}}}'
        text += f"\n[uncertain]\n{name} = {law}\n"
    try:
        study_from_text(text, folder=HOUSE)
    except InputError as error:
        return error.lines
    return None


@every_source
def test_python_shown_compiles_and_names_what_there_is(name):
    for block in blocks(name, "python"):
        compile(block, name, "exec")
        assert set(re.findall(r"\buq\.(\w+)\(", block)) <= set(public.__all__)
        for module, names in re.findall(r"^from ((?:uq|models)\.\S+) import (.*)$", block, re.M):
            members = vars(importlib.import_module(module))
            assert set(re.split(r", *", names)) <= members.keys()


RUN = [name for name in SOURCES if blocks(name, "python") and name not in ELSEWHERE]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", RUN)
def test_python_shown_runs(name, folder):
    (folder / "studies").mkdir()
    for path in (HOUSE / "studies").glob("*.toml"):
        fewer = re.sub(r"^samples = \d+", "samples = 128", path.read_text(), flags=re.MULTILINE)
        (folder / "studies" / path.name).write_text(fewer)
    names = {"__name__": "shown"}
    for block in blocks(name, "python"):
        for result in re.findall(r'open_result\("(.+?)"\)', block):
            public.run("studies/beam-lifetime.toml", result)
        exec(compile(block.replace(", 200)", ", 5)"), name, "exec"), names)
    pyplot.close("all")


@every_source
def test_files_modules_and_targets_named_exist(name):
    text = SOURCES[name]
    for study in re.findall(r"\bstudies/([\w-]+)\.toml", text):
        assert study == "mine" or (HOUSE / f"studies/{study}.toml").is_file(), study
    for module in re.findall(r"python -m ((?:models|benchmarks|uq)[.\w]*)", text):
        assert importlib.util.find_spec(module), module
    for path in re.findall(r"`((?:uq|models|tests|docs|studies|benchmarks)/[\w./-]*)`", text):
        assert (HOUSE / path).exists(), path
    for link in re.findall(r"\]\(((?:docs/)?[\w./-]+\.(?:md|png|svg|ipynb))[#)]", text):
        inside = (HOUSE / name).parent / link
        assert inside.is_file(), link
    targets = re.findall(r"^(\w+):", (HOUSE / "Makefile").read_text(), re.M)
    assert set(re.findall(r"(?:^|`)make (\w+)", text, re.M)) <= set(targets)


FUNCTION = re.compile(r"`((?:uq|models|docs)/[\w/]+\.py):([\w.]+)`")


@every_source
def test_functions_named_exist(name):
    for path, function in FUNCTION.findall(SOURCES[name]):
        assert (HOUSE / path).is_file(), path
        names = definitions(ast.parse((HOUSE / path).read_text()))
        assert function in names, f"{path} has no {function}"


def definitions(tree, before=""):
    """Return the names of the functions and classes of a module, those within classes too."""
    kinds = (ast.FunctionDef, ast.ClassDef)
    nodes = {before + node.name: node for node in tree.body if isinstance(node, kinds)}
    for name, node in list(nodes.items()):
        nodes |= definitions(node, f"{name}.") if isinstance(node, ast.ClassDef) else {}
    return nodes


TWO_SCREENS = 120
"""Lines of text."""


def test_the_architecture_fits_on_two_screens_with_one_picture():
    text = SOURCES["docs/architecture.md"]
    assert len(text.splitlines()) <= TWO_SCREENS
    assert text.count("![") == 1


def test_a_row_and_a_number_take_the_path_that_is_described(folder, monkeypatch, write_study):
    path = write_study("exponential-wear", uncertain=("rate",))
    monkeypatch.setattr(plots, "FIGURES", {})

    def row():
        public.run(path, "out.nc", workers=0)

    def number():
        ds = public.open_result("out.nc")
        public.summary(ds)
        assert summary_facts(summarise(Result(ds))).json
        show_summary(Result(ds), summarise(Result(ds)))
        public.survival(ds, "life")
        public.compare(ds, ds)
        page(Result(ds), "out.nc")

    _, first, second = SOURCES["docs/architecture.md"].split("## The path of a ")
    for text, action in ((first, row), (second, number)):
        named = {(path, f) for path, f in FUNCTION.findall(text) if path.startswith("uq/")}
        passed = functions_called(action)
        elsewhere = {"isolation", "workers", "dask_task"}  # in other processes
        lacking = {(file, f) for file, f in named - passed if Path(file).stem not in elsewhere}
        assert {f for _, f in lacking if f[0].islower()} == set()  # classes are not called


def functions_called(action):
    """Return the functions of the house that an action calls."""
    codes = set()

    def note(frame, event, argument):
        codes.add(frame.f_code)

    threading.setprofile(note)
    sys.setprofile(note)
    try:
        action()
    finally:
        sys.setprofile(None)
        threading.setprofile(None)
    return {(code.co_filename.removeprefix(f"{HOUSE}/"), code.co_qualname) for code in codes}


def test_the_picture_of_the_house_is_what_its_script_draws():
    assert house.PICTURE.read_text() == house.picture(), "run: python docs/house.py"


@pytest.mark.parametrize("machine", generated.machines())
def test_the_picture_of_a_machine_is_what_its_script_draws_and_shown_where_it_is_explained(machine):
    file = f"pictures/{machine}.svg"
    drawn, static = sketches.SKETCHES[machine](), HOUSE / "docs" / "_static"
    assert (HOUSE / "docs" / file).read_text() == drawn.svg(), "run: cd docs; python -m sketches"
    narrow = (static / f"{machine}-narrow.svg").read_text()
    assert narrow == drawn.narrow(), "run: cd docs; python -m sketches"
    assert f"](docs/{file})" in SOURCES["README.md"]
    assert f"](../{file})" in SOURCES[f"docs/machines/{machine}.md"]


def test_the_study_that_the_readme_shows_is_the_one_that_it_runs():
    shown = tomllib.loads(blocks("README.md", "toml")[0])
    study = tomllib.loads((HOUSE / "studies/exponential-wear.toml").read_text())
    for law in study["uncertain"].values():
        del law["source"]
    for key in ("description", "seed"):
        study["study"].pop(key, None), study["design"].pop(key, None)
    assert shown == study


def test_every_key_and_every_law_is_described():
    described = "".join(pages.expanded(text) for text in SOURCES.values())
    keys = [
        f"| `{key}` |" for table in generated.STUDY_TABLES.values() for key in table.model_fields
    ]
    laws = [f'| `"{law}"` |' for law in generated.LAWS]
    assert [line for line in keys + laws if line not in described] == []


def test_the_citation_is_that_of_this_version():
    citation = yaml.safe_load((HOUSE / "CITATION.cff").read_text())
    project = tomllib.loads((HOUSE / "pyproject.toml").read_text())["project"]
    assert citation["version"] == project["version"]
    assert citation["license"] == project["license"]
    cited = " ".join(text for name in generated.machines() for text in find_model(name).references)
    assert [
        reference["title"]
        for reference in citation["references"]
        if reference["title"] not in cited
    ] == []
    assert len(citation["references"]) == len(generated.machines())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "kept"),
    [
        ("models.vibrator.paper.table1", "docs/outputs/vibrator-table1.txt"),
        ("models.mole.paper.table", "docs/outputs/mole-claims.txt"),
    ],
)
def test_what_is_quoted_is_what_is_printed(module, kept, capsys):
    importlib.import_module(module).main()
    printed = capsys.readouterr().out
    assert comparable(printed) == comparable((HOUSE / kept).read_text())


@pytest.mark.slow
def test_the_facts_of_the_beam_are_those_that_are_printed(capsys):
    importlib.import_module("models.beam.paper.facts").main()
    assert capsys.readouterr().out in SOURCES["docs/beam-facts.md"]


def comparable(text):
    """Return what does not depend on the processor: no chaos, no rounding errors."""
    lines = [line for line in text.splitlines() if "chaotic" not in line]
    return [re.sub(r" +-?(0\.0+|\S+e-1[5-9])(?!\S)", " 0", line) for line in lines]
