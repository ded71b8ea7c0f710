"""A name in a file that somebody sent is looked up among installed models, and nowhere else."""

import socket
import sys
from inspect import getsource, signature

import netCDF4
import pytest

import uq as package
from uq.cli.app import VERBS
from uq.errors import InputError
from uq.execution import runner
from uq.render.html.dossier.chapters import dossier
from uq.render.html.page import write_report

MARKER = "executed"
CODE = f"open({MARKER!r}, 'w').close()\nfrom models.analytic import EXPONENTIAL_WEAR as MODEL\n"
MACHINE = f"""
[machine]
name = "hostile"
command = ["touch", "{{machine_folder}}/{MARKER}", "{{rate}}"]
template = "pipe"
[parameters.rate]
nominal = 1.0
[outputs.life]
pattern = '(.*)'
"""

ON_A_RESULT = {
    "status": [()],
    "extend": [("--samples", "40", "--workers", "0")],
    "rerun": [("--failed",)],
    "verify": [()],
    "row": [("3",), ("--lowest", "life", "--json"), ("3", "--plot", "row.png")],
    "summary": [(), ("--json",), ("--fits",)],
    "sensitivity": [()],
    "levels": [()],
    "fleet": [("--size", "5")],
    "convergence": [()],
    "compare": [("good.nc",)],
    "what_if": [("--set", "uncertain.rate.sigma=0.4")],
    "update": [("inspections.csv", "-o", "posterior.nc", "--rows", "8")],
    "next_inspection": [("--inspect", "life")],
    "twin": [()],
    "emulate": [("-o", "x.emulator")],
    "next_rows": [("-n", "5"), ("-n", "5", "--output", "life")],
    "trace": [("outputs/life/mean",)],
    "export": [("--csv", "rows.csv")],
    "plot": [()],
    "report": [(), ("--dossier", "-o", "dossier.html")],
}
"""Verb -> what follows the result."""


@pytest.fixture
def telephone():
    """Return a server that should never be called."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.setblocking(False)
        yield server


@pytest.fixture
def result(folder, write_study, no_other_figures, monkeypatch):
    law = 'distribution = "lognormal", median = 2.5e-10, sigma = 0.5'
    study = write_study("exponential-wear", samples=32, uncertain=["rate"], law=law)
    for name in ("x.nc", "good.nc"):
        runner.run(study, name, workers=0)
    monkeypatch.delitem(sys.modules, "hostile", raising=False)  # of another test
    monkeypatch.setattr(sys, "path", list(sys.path))
    (folder / "hostile.py").write_text(CODE)
    (folder / "hostile.toml").write_text(MACHINE)
    (folder / "pipe").write_text("{rate}")
    lines = ("unit,time,output,kind,value,sd", "a,3600,life,survived,,")
    (folder / "inspections.csv").write_text("\n".join(lines))
    return folder / "x.nc"


def renamed(result, name, in_study=False):
    """Let a result name another model, in its attributes or in its study as well."""
    with netCDF4.Dataset(result, "a") as file:
        file.model, file.source = name, f"{name} 1"
        if in_study:
            file.study = file.study.replace('"exponential-wear"', f'"{name}"')


NAMES = ("hostile.py", "./hostile.py:MODEL", "hostile:MODEL", "hostile.toml", "http://{}/MODEL")


TAKE_A_MODEL = ("extend", "verify")
"""A verb that computes new rows, and one that computes some rows again."""


@pytest.mark.parametrize(
    ("name", "in_study", "verbs"),
    [
        (NAMES[0], False, ON_A_RESULT),
        *((name, False, TAKE_A_MODEL) for name in NAMES[1:]),
        (NAMES[0], True, TAKE_A_MODEL),
        *(pytest.param(name, False, ON_A_RESULT, marks=pytest.mark.slow) for name in NAMES[1:]),
        pytest.param(NAMES[0], True, ON_A_RESULT, marks=pytest.mark.slow),
    ],
)
def test_no_verb_runs_what_a_result_names(uq, result, folder, telephone, name, in_study, verbs):
    renamed(result, name.format(f"127.0.0.1:{telephone.getsockname()[1]}"), in_study)
    sent = result.read_bytes()
    for verb in verbs:
        for more in ON_A_RESULT[verb]:
            result.write_bytes(sent)  # 'uq extend' writes it anew
            ended = uq(verb.replace("_", "-"), result, *more)
            assert ended.code in (0, 1, 2) and "Traceback" not in ended.err, (verb, ended)
            assert not (folder / MARKER).exists(), (verb, more)
            with pytest.raises(BlockingIOError):
                telephone.accept()


@pytest.mark.parametrize("name", ["hostile.py", "hostile:MODEL", "hostile.toml"])
def test_nothing_in_python_runs_what_a_result_names(result, folder, name):
    renamed(result, name)
    ds = package.open_result(result)
    calls = [
        lambda: package.summary(ds),
        lambda: package.answer(ds),
        lambda: package.sensitivity(ds),
        lambda: package.what_if(ds, {"uncertain.rate.sigma": 0.4}),
        lambda: package.update(ds, "inspections.csv"),
        lambda: package.fleet(ds, size=5),
        lambda: package.row(ds, 3),
        lambda: package.trace(ds, "outputs/life/mean"),
        lambda: package.compare(ds, package.open_result("good.nc")),
        lambda: package.enough(ds),
        lambda: package.two_fidelities(ds),
        lambda: package.emulate(ds),
        lambda: package.next_rows(ds, 5),
        lambda: write_report(result, "x.html"),
        lambda: write_report(result, "dossier.html", dossier),
        lambda: package.plots.lifetime(ds, "life"),
    ]
    for call in calls:
        try:
            call()
        except InputError:
            pass
        assert not (folder / MARKER).exists(), getsource(call)


@pytest.mark.parametrize("name", NAMES)
def test_a_study_names_no_code(uq, result, folder, name):
    study = folder / "small.toml"
    study.write_text(study.read_text().replace('"exponential-wear"', f'"{name}"'))
    for verb in ("check", "plan", "run", "update", "rare-event"):
        more = {"update": ["inspections.csv", "-o", "posterior.nc"]}.get(verb, [])
        more = ["--output", "life", "--below", "1 h"] if verb == "rare-event" else more
        ended = uq(verb, study, *more)
        assert ended.code == 2 and f'model = "{name}"' in ended.err
        assert not (folder / MARKER).exists()


def test_every_verb_that_takes_a_result_is_held_to_it():
    takes_one = {"result", "first", "source"}
    verbs = {verb.__name__ for verb in VERBS if takes_one & set(signature(verb).parameters)}
    assert verbs == set(ON_A_RESULT)


def test_the_code_that_no_file_reaches_would_run(uq, result, folder):
    ended = uq("row", result, "3", "--model", "hostile.py", "--json")
    assert ended.code == 0 and (folder / MARKER).exists()
