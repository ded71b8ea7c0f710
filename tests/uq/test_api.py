"""What ``import uq`` offers, and what it does not cost."""

import ast
import importlib.metadata
import os
import subprocess
import sys
from pathlib import Path

import pytest

import uq

HEAVY = {"numpy", "pandas", "xarray", "scipy", "numba", "distributed", "pydantic", "matplotlib"}


def test_everything_promised_is_there():
    assert (
        set(uq.__all__)
        == set(dir(uq))
        == {
            "Study",
            "answer",
            "basins",
            "card",
            "labels",
            "fleet",
            "levels",
            "copula_fits",
            "life_fits",
            "load_study",
            "regimes",
            "row",
            "run",
            "open_result",
            "simulate",
            "summary",
            "trace",
            "sensitivity",
            "survival",
            "what_if",
            "rare_event",
            "as_unit",
            "learnt",
            "update",
            "worth",
            "machine",
            "Returned",
            "censored",
            "between",
            "import_lives",
            "two_fidelities",
            "emulate",
            "next_rows",
            "running_estimates",
            "enough",
            "compare",
            "recompute",
            "plots",
            "InputError",
            "RunError",
            "__version__",
        }
    )
    for name in set(uq.__all__) - {"plots", "__version__"}:
        assert callable(getattr(uq, name))


def test_the_version_and_the_errors_are_those_of_the_package():
    assert uq.__version__ == importlib.metadata.version("vibrolife")
    with pytest.raises(uq.InputError, match="no such model"):
        uq.simulate("bean")
    assert issubclass(uq.RunError, Exception)


def test_what_an_editor_reads_is_what_is_there():
    """The stub of the package names each thing once, where it is defined."""
    stub = ast.parse(Path(uq.__file__).with_suffix(".pyi").read_text())
    named = [
        alias for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names
    ]
    assert [imported.name for imported in named] == [imported.asname for imported in named]
    assert sorted(imported.name for imported in named) == uq.__all__


def test_no_module_bears_the_name_of_a_function():
    files = {path.split(".")[0] for path in os.listdir(uq.__path__[0])}
    assert files & set(uq.__all__) == {"plots"}


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="uq attribute runn"):
        _ = uq.runn


def test_a_command_computes_with_a_single_thread(folder):
    """numpy reads the number of threads when it is imported: other threads wait, and cost CPU."""
    program = (
        "import os, sys, uq.cli as cli\n"
        "load = cli._load_when_used\n"
        "def loads(*names):\n"
        "    print('numpy' in sys.modules, os.environ['OPENBLAS_NUM_THREADS'])\n"
        "    load(*names)\n"
        "cli._load_when_used = loads\n"
        "sys.argv[1:] = ['summary', 'absent.nc']\n"
        "cli.main()\n"
    )
    plain = {name: value for name, value in os.environ.items() if "_NUM_THREADS" not in name}
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=plain, timeout=60
    )
    assert ended.stdout == "False 1\n"
    assert "absent.nc" in ended.stderr


@pytest.mark.parametrize(
    "program",
    [
        "import uq",
        "import sys; sys.argv[1:] = ['--help']\n"
        "from uq.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code",
    ],
    ids=["import uq", "uq --help"],
)
def test_heavy_modules_stay_unloaded(program):
    check = f"\nimport sys\nprint('loaded:', *{HEAVY!r} & set(sys.modules), file=sys.stderr)"
    ended = subprocess.run(
        [sys.executable, "-c", program + check], capture_output=True, text=True, timeout=60
    )
    assert ended.stderr == "loaded:\n"


DEAR = {
    *("SALib", "dask", "distributed", "jinja2", "matplotlib", "netCDF4", "numba", "pandas"),
    *("numpy.f2py.f2py2e", "numpy.testing._private.utils"),
    *("scipy.linalg", "scipy.optimize", "scipy.stats", "sympy", "xarray"),
}
READING = {"netCDF4", "pandas", "xarray"}
IMPORTED_BY = """
import sys
from uq.cli import main
for command in sys.argv[1].split(","):
    sys.argv[1:] = command.split()
    try:
        main()
    except SystemExit as end:
        assert not end.code
    print("loaded:", *(name for name, module in sys.modules.items() if module), file=sys.stderr)
"""


WEAR = """
study = {name = "wear", model = "exponential-wear"}
design = {method = "monte-carlo", samples = 64, seed = 7}
uncertain.rate = {distribution = "lognormal", median = 2.5e-10, sigma = 0.5}
uncertain.depth = {distribution = "normal", mean = 2.5e-4, sd = 1e-5}
"""  # lives, whose inputs are integrated


@pytest.mark.parametrize(
    ("verbs", "allowed"),
    [
        ("simulate linear", set()),
        pytest.param("simulate beam", {"numba"}, marks=pytest.mark.slow),
        pytest.param("simulate mole", {"numba"}, marks=pytest.mark.slow),
        pytest.param("simulate vibrator", {"numba"}, marks=pytest.mark.slow),
        ("summary small.nc,sensitivity small.nc", READING),
        ("summary wear.nc,sensitivity wear.nc", READING),
        ("run wear.toml -o other.nc --workers 0", READING),
    ],
    ids=["simulate", "beam", "mole", "vibrator", "summary and sensitivity", "lives", "run"],
)
def test_a_verb_imports_only_what_it_needs(verbs, allowed, write_study, folder):
    """Those who wait for an answer do not wait for modules that have no part in it."""
    (folder / "wear.toml").write_text(WEAR)
    if "small" in verbs:
        uq.run(write_study(), "small.nc", workers=0)
    elif allowed == READING:
        uq.run("wear.toml", "wear.nc", workers=0)
    command = [sys.executable, "-c", IMPORTED_BY, verbs]
    if allowed == {"numba"}:  # compiled once, as on every computer
        subprocess.run(command, capture_output=True, timeout=600)
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    loaded_lines = [line for line in ended.stderr.splitlines() if line.startswith("loaded:")]
    for line in loaded_lines:
        assert DEAR & set(line.removeprefix("loaded: ").split()) == allowed
    assert len(loaded_lines) == len(verbs.split(","))


def test_a_function_takes_a_path_a_dataset_or_refuses_in_a_line(write_study, folder):
    ds = uq.run(write_study(), "small.nc", workers=0)
    assert uq.summary("small.nc").equals(uq.summary(ds))
    with pytest.raises(
        uq.InputError, match="not a result: int .allowed: a path, an xarray.Dataset"
    ):
        uq.summary(3)
