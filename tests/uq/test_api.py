"""What ``import uq`` offers, and what it does not cost."""

import os
import subprocess
import sys

import pytest

import uq

HEAVY = {"numpy", "pandas", "xarray", "scipy", "numba", "distributed", "pydantic", "matplotlib"}


def test_everything_promised_is_there():
    assert (
        set(uq.__all__)
        == set(dir(uq))
        == {
            "basins",
            "labels",
            "life_fits",
            "load_study",
            "regimes",
            "run",
            "open_result",
            "simulate",
            "summary",
            "sensitivity",
            "survival",
            "rare_event",
            "two_fidelities",
            "running_estimates",
            "enough",
            "compare",
            "plot_basins",
            "plot_bifurcation",
            "plot_curve",
            "plot_history",
            "plot_phase_portrait",
            "plot_section",
        }
    )
    for name in uq.__all__:
        assert callable(getattr(uq, name))


def test_no_module_bears_the_name_of_a_function():
    files = {path.split(".")[0] for path in os.listdir(uq.__path__[0])}
    assert not files & set(uq.__all__)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'uq' has no attribute 'runn'"):
        _ = uq.runn


@pytest.mark.parametrize(
    "program",
    [
        "import uq",
        "import uq.cli, uq.cli.app",
        "import sys; sys.argv[1:] = ['--help']\n"
        "from uq.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code",
    ],
    ids=["import uq", "import uq.cli", "uq --help"],
)
def test_heavy_modules_stay_unloaded(program):
    check = f"\nimport sys\nprint('loaded:', *{HEAVY!r} & set(sys.modules), file=sys.stderr)"
    ended = subprocess.run(
        [sys.executable, "-c", program + check], capture_output=True, text=True, timeout=60
    )
    assert ended.stderr == "loaded:\n"
