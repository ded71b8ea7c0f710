"""Crash-safe storage of arriving rows on disk, merged into one result at the end."""

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Mask
from uq.errors import RunError
from uq.execution.row_folder import JOURNAL, RowsRecord, RunRecord, clear, folder_of, missing
from uq.execution.tally import (
    Block,
    Failures,
    MemoryStore,
    in_order,
    joined_failures,
    load,
    pack,
    save,
    unpack,
)
from uq.files.journal import Journal
from uq.files.netcdf_files import seal
from uq.files.whole_files import reason, whole
from uq.result import result_file
from uq.result.workload import workload_of
from uq.study.definition import Study
from uq.study.evaluate import Chunk
from uq.study.installed_models import made_here
from uq.study.row_sampling import Rows, rows
from uq.text.literals import read_toml, toml


def define(file: Any, ds: xr.Dataset, total: int) -> None:
    """Write the schema of a result without its rows."""
    variables, attributes = xr.conventions.encode_dataset_coordinates(ds)
    file.setncatts(attributes)
    for dim, size in ds.sizes.items():
        file.createDimension(dim, total if dim == "row" else size)
    for name, variable in variables.items():
        kind = str if variable.dtype.kind == "U" else variable.dtype
        made = file.createVariable(
            name, kind, variable.dims, fill_value=None if kind is str else False
        )
        made.setncatts(variable.attrs)
        made.set_auto_maskandscale(False)
        if "row" not in variable.dims:
            made[...] = variable.values.astype(object) if kind is str else variable.values


def place(file: Any, ds: xr.Dataset, blocks: Sequence[Block]) -> None:
    """Write rows to their places."""
    for name, variable in ds.variables.items():
        if "row" in variable.dims:
            done = 0
            for start, stop in blocks:
                file[name][start:stop] = variable.values[done : done + stop - start]
                done += stop - start


def made_by(records: Sequence[RowsRecord]) -> dict[str, str]:
    """Return the processors and versions that computed the rows, as attributes of the result."""
    names = dict.fromkeys(name for record in records for name in record.made)
    return {
        name: "; ".join(sorted({record.made.get(name, "unknown") for record in records}))
        for name in names
    }


def variants_of(records: Sequence[RowsRecord]) -> list[dict[str, Any]]:
    """Return the sets of settings that differ from the study's, ordered by first row."""
    variants: list[dict[str, Any]] = [{}]
    for record in sorted(records, key=lambda record: record.blocks):
        if record.settings not in variants:
            variants.append(record.settings)
    return variants


def rerun(variants: Sequence[Mapping[str, Any]], code: int, count: int) -> xr.Variable:
    """Return the variable that flags the settings variant of rows computed again."""
    labels = ["no", *(f"changed-{i}" for i in range(1, len(variants)))]
    attrs: dict[str, Any] = {
        "role": "rerun",
        "long_name": "whether a failed row was computed again with changed settings",
        "flag_values": np.arange(len(variants), dtype=np.int16),
        "flag_meanings": " ".join(labels),
    }
    attrs |= {f"changed_{i}": toml(variants[i]) for i in range(1, len(variants))}
    return xr.Variable("row", np.full(count, code, np.int16), attrs)


def by_settings(ds: xr.Dataset) -> Iterator[tuple[dict[str, Any], Mask]]:
    """Yield the settings of rows that differ from the study's, and which rows have them."""
    if "rerun" not in ds:
        yield {}, np.ones(ds.sizes["row"], np.bool_)
        return
    codes = ds["rerun"].values
    for code in np.unique(codes):
        text = ds["rerun"].attrs.get(f"changed_{code}", "{}")
        yield read_toml(f"settings = {text}")["settings"], codes == code


_WRITING_SHARE = 1 / 20  # of the time, unless single chunks take longer
_FIRST_COST = 0.01  # of writing [s], before it is known: a very short run writes once
_PENDING_BYTES = 8_000_000  # in memory at most

Origin = tuple[dict[str, str], dict[str, Any]]
"""Provenance of rows: processor and versions, and settings that differ from the study."""


class DiskStore(MemoryStore):
    """The rows of one run, in the folder beside its result; the caller holds its lock.

    Parameters
    ----------
    study : Study
    path : Path
        Of the result.

    Attributes
    ----------
    folder : Path
    settings : dict
        Settings of the rows to come that differ from the study's.
    """

    def __init__(self, study: Study, path: Path) -> None:
        super().__init__(workload_of(study))
        self.folder = folder_of(path)
        self.settings: dict[str, Any] = {}
        self._study = study
        self._path = path
        self._journal = Journal(self.folder / JOURNAL)
        self._records: list[RowsRecord] = []
        self._pending_failures: Failures = {}
        self._made = made_here(study.model_reference)
        self._written = time.monotonic()
        self._cost = _FIRST_COST

    @property
    def missing(self) -> list[Block]:
        """Blocks of missing rows."""
        return missing(self._records, self.total)

    @property
    def end(self) -> int:
        """Number of the last stored row plus one."""
        return max((record.blocks[-1][1] for record in self._records), default=0)

    @property
    def made(self) -> list[dict[str, str]]:
        """Distinct processors and versions that computed the stored rows."""
        return [dict(pairs) for pairs in {tuple(record.made.items()) for record in self._records}]

    def find(self, records: list[RowsRecord]) -> int:
        """Load the rows stored earlier; return the number of damaged ones, which are missing."""
        damaged = 0
        for record in records:
            if self._load(record) is None:
                damaged += record.rows
            else:
                self._take(record)
        self.reused = self.done
        return damaged

    def note(self, record: RunRecord) -> None:
        """Record that a run starts, or where it ends early."""
        with self._explained():
            self._journal.append(record.model_dump(mode="json"))
        self._run = record

    def first(self, study: Study) -> xr.Dataset:
        """Return the result of a study with fewer samples, whose rows have all arrived."""
        self._write()
        data = np.empty(rows(study), self.row_type)
        for record, part in self._loaded():
            data[record.numbers] = part
        return result_file.build(study, *unpack(data), self.examples)

    def cut(self, study: Study) -> None:
        """End the run with the rows of a study with fewer samples, which have all arrived."""
        self._study, self.workload = study, workload_of(study)
        self.total = self.workload.total
        size = {"samples": study.design.samples, "rows": self.total}
        self.note(self._run.model_copy(update=size | {"time": time.time()}))

    def add(self, start: int, rows: Rows, chunk: Chunk) -> None:
        """Count and keep the rows from `start` on; `keep_up` writes them."""
        # Rows last: if a signal ends the process in between, they are not kept without these.
        self._pending_failures = joined_failures(self._pending_failures, chunk.failures)
        super().add(start, rows, chunk)

    def keep_up(self) -> None:
        """Write the arrived rows, unless that would exceed the share of time for writing.

        Raises
        ------
        RunError
            When it cannot be written.
        """
        due = time.monotonic() - self._written >= self._cost / _WRITING_SHARE
        large = sum(data.nbytes for _, data in self._pending) > _PENDING_BYTES
        if (due or large) and not self.shapes_all_wrong:
            self._write()

    def adopt(self, blocks: list[Block], rows: Rows, chunk: Chunk, origin: Origin) -> None:
        """Write rows that were computed earlier; they count as reused."""
        with self._explained():
            data = pack(self.row_type, rows, chunk.columns, chunk.status)
            self._take(self._save(blocks, [data], chunk.failures, origin))
        self.reused = self.done

    def dataset(self) -> xr.Dataset:
        """Write the result of a complete run and remove its chunk files.

        The result does not depend on the split into chunk files. They are read one at a time, so
        memory use does not grow with the number of rows.

        Raises
        ------
        RunError
            When it cannot be written; the rows stay then.
        """
        self._write()
        try:
            with whole(self._path, self.folder) as temporary:
                self._merge(temporary)
                seal(temporary)
        except RunError as error:
            raise RunError(
                f"{error}; the rows are kept, and the same command resumes the run"
            ) from None
        clear(self.folder)
        return result_file.open_result(self._path)

    def _merge(self, path: Path) -> None:
        import netCDF4

        attributes, variants = made_by(self._records), variants_of(self._records)
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            for record, data in self._loaded():
                ds = result_file.build(self._study, *unpack(data), self.examples, record.numbers)
                ds = ds.assign_attrs(attributes)
                if len(variants) > 1:
                    ds["rerun"] = rerun(variants, variants.index(record.settings), record.rows)
                if not file.variables:
                    define(file, ds, self.total)
                place(file, ds, record.blocks)

    def close(self) -> None:
        """Write the arrived rows, if possible, and remove useless files."""
        if not self.shapes_all_wrong:
            with suppress(RunError):
                self._write()
        self._journal.close()
        if not self._records:
            clear(self.folder)
        for file in self.folder.glob("*.part"):
            file.unlink()

    def _write(self) -> None:
        if not self._pending:
            return
        began = time.monotonic()
        with self._explained():
            blocks, pieces = in_order(self._pending)
            origin = self._made, self.settings
            self._records.append(self._save(blocks, pieces, self._pending_failures, origin))
        self._pending, self._pending_failures = [], {}
        self._written = time.monotonic()
        self._cost = self._written - began

    def _save(
        self, blocks: list[Block], pieces: list[NDArray[Any]], failures: Failures, origin: Origin
    ) -> RowsRecord:
        """Write a chunk file, then its line in the journal."""
        failed, status = 0, Counter[str]()
        for data in pieces:
            _, failed_rows, by_label = self.counts(data)
            failed += failed_rows
            status.update(by_label)
        record = RowsRecord(
            time=time.time(),
            blocks=tuple(blocks),
            sha256="",
            failed=failed,
            status=dict(status),
            failures=failures,
            made=origin[0],
            settings=origin[1],
        )
        record = record.model_copy(update={"sha256": save(self._file(record), *pieces)})
        self._journal.append(record.model_dump(mode="json"))
        return record

    @contextmanager
    def _explained(self) -> Iterator[None]:
        """Convert a disk error into a message with its consequence for the run."""
        try:
            yield
        except OSError as error:
            kept = sum(record.rows for record in self._records)
            raise RunError(
                f"{self.folder}: could not be written: {reason(error, self.folder)}; {kept} of "
                f"{self.total} rows are kept, and the same command resumes the run"
            ) from None

    def _take(self, record: RowsRecord) -> None:
        self._records.append(record)
        self.count(record.rows, record.failed, record.status, record.failures)

    def _file(self, record: RowsRecord) -> Path:
        """Return the path of a chunk file: no record can name another file."""
        first, last = record.blocks[0][0], record.blocks[-1][1]
        return self.folder / f"{self._study.identity[:16]}-{first}-{last}.rows"

    def _load(self, record: RowsRecord) -> NDArray[Any] | None:
        return load(self._file(record), self.row_type, record.rows, record.sha256)

    def _loaded(self) -> Iterator[tuple[RowsRecord, NDArray[Any]]]:
        for record in self._records:
            if (data := self._load(record)) is None:
                raise RunError(f"{self._file(record)}: was damaged during the run")
            yield record, data
