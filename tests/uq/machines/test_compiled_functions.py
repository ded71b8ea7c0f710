"""A function compiled by numba as a machine: its rows are those of a loop in Python."""

import numpy as np
import pytest

import uq as package
from uq.contract import Status
from uq.machines.function import Compiled
from uq.machines.row_by_row import RowByRow
from uq.study.installed_models import model_at


def test_a_compiled_function_returns_a_tuple(uq, write_function):
    file = write_function(
        "from math import inf\nimport numba\nimport uq\n"
        '@uq.machine(returns={"life": uq.Returned("s", life=True), "energy": "J"})\n'
        "@numba.njit\ndef wear(load=1.0, depth=3.0):\n"
        "    return (depth / load if load > 0.1 else inf), load**2\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    load = ds["load"].values
    assert (ds["energy"].values == load**2).all()
    assert (ds["life"].values == np.where(load > 0.1, 3.0 / load, np.inf)).all()


HARD = """
from math import inf, nan
import numba
import numpy as np
import uq

@uq.machine(returns={
    "life": uq.Returned("s", life=True), "curve": uq.Returned(shape=(3,)), "noise": "1"
})
@numba.njit
def wear(seed, load=1.0):
    if load > 1.6:
        raise ValueError("too heavy")
    many = np.exp(load * np.arange(2 if 1.5 < load else 3))
    life = nan if 1.4 < load < 1.5 else 3.0 / load if load > 0.1 else inf
    return life, many, inf if 1.3 < load < 1.4 else load + seed % 7
"""


@pytest.mark.slow
def test_a_compiled_loop_over_rows_returns_what_each_row_returns(write_function):
    batch = model_at(write_function(HARD)).batch
    assert isinstance(batch, Compiled)
    chance = np.random.default_rng(1)
    x, seed = 2 * chance.random((500, 1)), chance.integers(0, 2**64 - 1, 500, dtype=np.uint64)
    returned = batch(x, seed, None)
    again = batch(x[123:], seed[123:], None)
    one_by_one = RowByRow.__call__(batch, x, seed, None)
    for name, values in returned[0].items():
        assert values.tobytes() == one_by_one[0][name].tobytes()
        assert values[123:].tobytes() == again[0][name].tobytes()
    assert (returned[1] == one_by_one[1]).all() and returned[2] == one_by_one[2]
    kinds = {Status.OK, Status.RAISED, Status.NON_FINITE, Status.BAD_SHAPE}
    assert set(returned[1].tolist()) == kinds
    assert "ValueError: too heavy" in returned[2].values()
