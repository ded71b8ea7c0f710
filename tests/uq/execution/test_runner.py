"""The same study gives the same bits however it is cut, and a finished one is not run again."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sample_models
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from in_memory import compute
from own_machines import WEAR
from wordings import sentence

import uq
from uq.contract import Status
from uq.errors import InputError
from uq.execution import executor, runner
from uq.execution.options import RunOptions
from uq.execution.tally import MemoryStore
from uq.result import result_file
from uq.result.workload import workload_of
from uq.study.definition import load_study
from uq.study.evaluate import KernelError, evaluate
from uq.study.row_sampling import row_block


@pytest.mark.parametrize(
    "design",
    [
        {"method": "monte-carlo", "samples": 101, "replicates": 2},
        {"method": "latin-hypercube", "samples": 50, "replicates": 3},
        {"method": "sobol", "samples": 64},
        {"method": "halton", "samples": 77},
        {"method": "saltelli", "samples": 16, "replicates": 2, "second_order": True},
    ],
    ids=lambda design: design["method"],
)
def test_every_design_gives_the_same_bits_for_any_chunk_size(write_study, design):
    study = load_study(write_study(**design))
    whole = compute(study, workers=0)
    for chunk_rows in (1, 7, 1000):
        assert whole.identical(compute(study, workers=0, chunk_rows=chunk_rows))


@pytest.mark.parametrize(("seconds", "rows"), [(1e-3, 1024), (0.004, 1024), (0.1, 50), (20.0, 1)])
def test_a_chunk_is_a_whole_block_of_the_kernel_unless_that_takes_long(write_study, seconds, rows):
    assert executor.good_chunk(workload_of(load_study(write_study())), row_seconds=seconds) == rows


@pytest.mark.parametrize(("block", "rows"), [(1, 1), (1024, 16)])
def test_the_first_chunk_of_rows_computed_one_by_one_is_one_row(write_study, block, rows):
    workload = workload_of(load_study(write_study()))
    workload = workload._replace(model=replace(workload.model, block=block))
    assert executor.first_chunk(workload) == rows


@pytest.mark.parametrize("row_seconds", [2e-3, 0.5])
@pytest.mark.parametrize("threads", [100, 1000])
def test_many_workers_get_chunks_that_the_scheduler_can_follow(write_study, threads, row_seconds):
    workload = workload_of(load_study(write_study()))
    workload = workload._replace(model=replace(workload.model, block=1))
    size = executor.good_chunk(workload, row_seconds=row_seconds, threads=threads)
    chunks_per_second = threads / (size * row_seconds)
    assert chunks_per_second == pytest.approx(50)


def test_the_inputs_of_all_chunks_sent_take_bounded_memory(write_study):
    workload = workload_of(load_study(write_study()))
    threads, row_bytes = 100_000, 3 * 8
    size = executor.good_chunk(workload, row_seconds=1e-3, threads=threads)
    assert 1e9 < 2 * threads * size * row_bytes < 2e9


DECLARED = (
    "@uq.machine(returns={'life': uq.Returned('s', life=True), 'profile': uq.Returned(shape=(2,))})"
)


class OneGivenUp(list):
    """Chunks on workers that compute at once, at 3 s each; the cost of the last one is unknown."""

    dashboard = ""

    def __init__(self, workload, threads):
        self.workload, self.threads = workload, threads

    def send(self, start, some):
        model, given = self.workload.model, self.workload.settings
        seconds = 0.0 if start + len(some.x) == self.workload.total else 3.0
        self.append((start, some, evaluate(model, given, some.x, some.seed, start), seconds))

    def begun(self, threads):
        return [len(rows.x) for _, rows, *_ in self[:threads]]

    def returned(self):
        back = self[:]
        self.clear()
        return back


def test_a_row_that_was_given_up_leaves_the_cost_of_a_row_as_it_was(write_study):
    workload = workload_of(load_study(write_study(samples=16)))
    options = RunOptions(chunk_rows=1, row_limit=60.0)
    dispatcher = executor.Dispatcher(workload, options, MemoryStore(workload), evaluate)
    dispatcher.finish_on(OneGivenUp(workload, threads=1))
    assert (dispatcher.left, dispatcher.row_seconds) == (0, 3.0)


def test_a_few_rows_at_the_end_are_no_chunk_of_their_own(write_study):
    sizes = []

    class Noted(OneGivenUp):
        def send(self, start, some):
            sizes.append(len(some.x))
            super().send(start, some)

    workload = workload_of(load_study(write_study(samples=105)))
    options = RunOptions(chunk_rows=100)
    dispatcher = executor.Dispatcher(workload, options, MemoryStore(workload), evaluate)
    dispatcher.finish_on(Noted(workload, threads=2))
    assert dispatcher.left == 0
    assert min(sizes) >= 100 // 8


def test_progress_says_how_many_rows_are_under_way_before_the_first_returns(write_study):
    workload = workload_of(load_study(write_study(samples=40)))
    seen = []
    options = RunOptions(chunk_rows=10, progress=seen.append)
    dispatcher = executor.Dispatcher(workload, options, MemoryStore(workload), evaluate)
    dispatcher.finish_on(OneGivenUp(workload, threads=2))
    assert (seen[0].done, seen[0].under_way) == (0, 20)
    assert (seen[-1].done, seen[-1].under_way) == (40, 0)


@pytest.mark.parametrize("threads", [1, 2])
def test_each_worker_of_a_function_has_one_row_under_way(write_function, threads):
    file = write_function(WEAR.replace("@uq.machine", DECLARED))
    workload = workload_of(load_study("own.toml", file))
    seen = []
    options = RunOptions(chunk_rows=10, progress=seen.append)
    dispatcher = executor.Dispatcher(workload, options, MemoryStore(workload), evaluate)
    dispatcher.finish_on(OneGivenUp(workload, threads))
    assert (seen[0].done, seen[0].under_way) == (0, threads)


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(chunk_rows=st.integers(1, 200))
def test_failures_do_not_depend_on_chunks(write_study, chunk_rows):
    path = write_study(
        model="linear",
        uncertain=("x1", "x2"),
        more='[settings]\nfail_above = 0.7\nfail_how = "raise"',
    )
    study = load_study(path)
    whole = compute(study, workers=0)
    assert compute(study, workers=0, chunk_rows=chunk_rows).identical(whole)


def test_chunks_may_arrive_in_any_order(write_study):
    path = write_study(
        model="linear",
        samples=100,
        uncertain=("x1", "x2"),
        more='[settings]\nfail_above = 0.7\nfail_how = "raise"',
    )
    study = load_study(path)
    store = MemoryStore(workload_of(study))
    for start in (60, 0, 80, 20, 40):
        some = row_block(study, start, start + 20)
        chunk = evaluate(study.model, study.settings, some.x, some.seed, start)
        store.add(start, some, chunk)
    assert store.dataset().identical(compute(study, workers=0))


def test_chunks_are_whole_groups_and_full_blocks(write_study):
    seen = []
    study = load_study(write_study(method="saltelli", samples=64, replicates=2))
    compute(study, workers=0, chunk_rows=11, progress=seen.append)
    done = np.array([progress.done for progress in seen])
    assert np.all(np.diff(done)[:-1] == 15)
    last = seen[-1]
    assert (last.done, last.total, last.failed, last.status) == (640, 640, 0, {"ok": 640})


def test_chunks_fill_the_blocks_of_a_kernel_unless_a_size_is_asked_for(write_study):
    path = write_study(uncertain=("x1",), samples=2000, more="[settings]\nseconds = 0.001")
    study = load_study(path, "process_models:SLEEPING")
    blocked = replace(study, model=replace(study.model, block=96))
    seen = []
    compute(blocked, workers=0, progress=seen.append)
    sizes = np.diff([0, *(progress.done for progress in seen)])
    full = sizes[-3:-1]  # long after the first, small ones that tell the cost of a row
    assert np.all(full >= 96)
    assert np.all(full % 96 == 0)
    seen.clear()
    compute(blocked, workers=0, chunk_rows=20, progress=seen.append)
    assert np.all(np.diff([progress.done for progress in seen]) == 20)


def test_progress_counts_rows_and_failures(write_study):
    path = write_study(model="linear", more="[settings]\nfail_above = 0.5", samples=200)
    seen = []
    ds = compute(load_study(path), workers=0, chunk_rows=20, progress=seen.append)
    assert [progress.done for progress in seen] == list(range(0, 201, 20))
    assert seen[-1].failed == int((ds["status"] != 0).sum()) > 0


def test_progress_counts_failures_as_the_tables_do(write_study):
    def lacking_work(x, seed, settings):
        outputs, status = sample_models.kinds(x, seed, settings)
        outputs["work"][(status == Status.OUT_OF_BUDGET) & (x[:, 1] > 0.5)] = np.nan
        return outputs, status

    law = 'distribution = "uniform", lower = 0.01, upper = 0.99'
    path = write_study(uncertain=("x1", "x2"), law=law, samples=500)
    study = load_study(path, "sample_models:KINDS")
    study = replace(study, model=replace(study.model, batch=lacking_work))
    seen = []
    ds = compute(study, workers=0, chunk_rows=10, progress=seen.append)
    failed = int(result_file.failed(ds).sum())
    assert seen[-1].failed == failed
    assert 0 < failed < (ds["status"] == Status.OUT_OF_BUDGET).sum()


def test_run_writes_what_it_returns_and_shows_it_the_second_time(write_study, folder):
    path = write_study()
    ds = uq.run(path)
    file = folder / "results" / "small.nc"
    assert uq.open_result(file).identical(ds)
    before = file.stat()
    computed = []
    again = runner.run(load_study(path), progress=computed.append)
    assert again.identical(ds)
    assert not computed
    assert file.stat().st_mtime_ns == before.st_mtime_ns
    assert file.stat().st_ino == before.st_ino
    assert runner.run(path, fresh=True, progress=computed.append).identical(ds)
    assert computed


def test_the_result_of_something_else_is_kept(write_study, folder):
    path = write_study()
    ds = runner.run(path, "out.nc")
    for change, value, words in [
        ("seed", 128, r"has the result of another study \(\[design\] seed = 5, now 128\)"),
        ("samples", 32, "has this study with samples = 64, not 32"),
    ]:
        other = write_study(**{change: value})
        with pytest.raises(InputError, match=f"^out.nc: {words}.*--fresh"):
            runner.run(other, "out.nc")
    Path("text.nc").write_text("my notes")
    with pytest.raises(InputError, match=r"text\.nc: not a readable netCDF file; .*--fresh"):
        runner.run(path, "text.nc")
    assert Path("text.nc").read_text() == "my notes"
    assert uq.open_result("out.nc").identical(ds)
    assert runner.run(other, "out.nc", fresh=True).attrs["samples"] == 32


def test_an_entry_that_one_study_lacks_is_named(write_study, folder):
    path = write_study(method="sobol")
    first = path.read_text()
    second, neither = (first.replace("replicates = 1", line) for line in ("replicates = 2", ""))
    for before, now, words in (
        (first, second, "= 1, now 2"),
        (neither, second, "= 2, not given before"),
        (second, neither, "= 2, no longer given"),
    ):
        path.write_text(before)
        runner.run(path, "out.nc", workers=0, fresh=True)
        path.write_text(now)
        with pytest.raises(InputError, match=rf"\(\[design\] replicates {words}\);"):
            runner.run(path, "out.nc")


def test_the_output_is_checked_before_anything_is_computed(write_study, folder):
    computed = []
    with pytest.raises(InputError, match="is a folder"):
        runner.run(write_study(), folder, workers=0, progress=computed.append)
    assert not computed


def test_a_model_wrong_for_every_row_is_refused(write_study):
    study = load_study(write_study(model="x", uncertain=("x1",)), "wrong_models:WRONG_SHAPE")
    with pytest.raises(KernelError) as refused:
        compute(study, workers=0)
    assert refused.value.lines == (
        "model 'wrong-shape': every row is wrong: 'y' has shape (1, 2), expected (1,)",
    )


def test_a_first_row_of_a_wrong_shape_does_not_blame_the_model(write_study):
    study = load_study(write_study(model="linear", more="[settings]\nfail_above = 0.5"))
    first = row_block(study, 0, 1).x[0, 0]
    path = write_study(
        model="linear",
        more=f'[settings]\nfail_above = {first - 1e-9}\nfail_how = "shape"',
    )
    study = load_study(path)
    study = replace(study, model=replace(study.model, block=1))
    ds = compute(study, workers=0, chunk_rows=1)
    assert ds["status"].values[0] == Status.BAD_SHAPE
    assert np.array_equal(ds["status"] == Status.BAD_SHAPE, ds["x1"] >= first)
    assert (ds["status"] == Status.OK).any()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"workers": -1}, "workers must not be negative: -1"),
        ({"chunk_rows": 0}, "chunk_rows must be at least 1: 0"),
        ({"workers": 1, "scheduler": "tcp://x:1"}, "workers and scheduler exclude each other"),
    ],
)
def test_impossible_options_are_refused(write_study, options, words):
    with pytest.raises(InputError, match=words):
        compute(load_study(write_study()), **options)


def test_a_result_keeps_no_file_open(write_study):
    ds = runner.run(write_study(), "out.nc")
    Path("out.nc").unlink()
    assert isinstance(ds["y"].values.sum(), np.float64)
    assert isinstance(ds, xr.Dataset)


def test_a_complete_result_of_other_code_comes_with_a_warning(write_study, monkeypatch):
    study = write_study(samples=8)
    uq.run(study, workers=0)
    uq.run(study, workers=0)
    monkeypatch.setattr("uq.study.installed_models.code_of", lambda reference: "0" * 16)
    with pytest.warns(UserWarning, match=sentence("other code", model="ishigami")):
        uq.run(study, workers=0)
    uq.run(study, workers=0, mixed=True)
