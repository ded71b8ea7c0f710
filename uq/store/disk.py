"""Rows that are kept on disk as they arrive, whatever happens to the process."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.errors import RunError
from uq.rows import results
from uq.rows.columns import columns_of
from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows, rows
from uq.rows.workload import workload_of
from uq.store.chunk_file import Block, Piece, joined, load, pack, row_type, save, unpack
from uq.store.files import reason
from uq.store.folder import JOURNAL, clear, folder_of
from uq.store.journal import Journal
from uq.store.merge import merge
from uq.store.records import RowsRecord, RunRecord, missing
from uq.store.tally import Failures, Tally, ended, joined_failures
from uq.study.code import made_here

if TYPE_CHECKING:
    from uq.study.definition import Study

_WRITING_SHARE = 1 / 20  # of the time, unless single chunks take longer
_FIRST_COST = 0.01  # of writing [s], before it is known: what is over in a moment is written once
_PENDING_BYTES = 8_000_000  # in memory at most


class DiskStore(Tally):
    """The rows of one run, in the folder beside its result, whose lock is held.

    Parameters
    ----------
    study : Study
    path : Path
        Of the result.

    Attributes
    ----------
    folder : Path
    settings : dict
        Settings that rows to come are computed with, where others than the study's.
    """

    def __init__(self, study: "Study", path: Path) -> None:
        super().__init__(workload_of(study))
        self.folder = folder_of(path)
        self.settings: dict[str, Any] = {}
        self._study = study
        self._path = path
        model = study.model
        self.row_type = row_type(len(model.parameter_names), columns_of(model, study.settings))
        self._journal = Journal(self.folder / JOURNAL)
        self._records: list[RowsRecord] = []
        self._pending: list[Piece] = []
        self._pending_failures: Failures = {}
        self._made = made_here(study.model_reference)
        self._written = time.monotonic()
        self._cost = _FIRST_COST

    @property
    def missing(self) -> list[Block]:
        """Blocks of rows that are not there."""
        return missing(self._records, self.total)

    @property
    def reach(self) -> int:
        """Number behind the last row that is there."""
        return max((record.blocks[-1][1] for record in self._records), default=0)

    @property
    def made(self) -> list[dict[str, str]]:
        """Processors and versions that computed the rows that were found, each once."""
        return [dict(pairs) for pairs in {tuple(record.made.items()) for record in self._records}]

    def find(self, records: list[RowsRecord]) -> int:
        """Take rows that were kept before; return how many are damaged and will not be taken."""
        damaged = 0
        for record in records:
            if self._load(record) is None:
                damaged += record.rows
            else:
                self._take(record)
        self.found = self.done
        return damaged

    def note(self, record: RunRecord) -> None:
        """Write down that a run begins, or where it ends early."""
        with self._told():
            self._journal.append(record.model_dump(mode="json"))
        self._run = record

    def first(self, study: "Study") -> xr.Dataset:
        """Return the rows of a study of fewer samples, which are all that have arrived."""
        self._write()
        whole = np.empty(rows(study), self.row_type)
        for record, data in self._loaded():
            done = 0
            for start, stop in record.blocks:
                whole[start:stop] = data[done : done + stop - start]
                done += stop - start
        return results.build(study, *unpack(whole), self.examples)

    def cut(self, study: "Study") -> None:
        """End with the rows of a study of fewer samples, which are all that have arrived."""
        self._study, self.workload = study, workload_of(study)
        self.total = self.workload.total
        size = {"samples": study.design.samples, "rows": self.total}
        self.note(self._run.model_copy(update=size | {"time": time.time()}))

    def add(self, start: int, rows: Rows, chunk: Chunk) -> None:
        """Count the rows from `start` on; `keep_up` writes them.

        Parameters
        ----------
        start : int
        rows : Rows
        chunk : Chunk
        """
        data = pack(self.row_type, rows, chunk.columns, chunk.status)
        failed, by_status = self.failed_in(chunk), ended(chunk.status)
        # Rows last: should a signal end the process in between, they are not kept without these.
        self._pending_failures = joined_failures(self._pending_failures, chunk.failures)
        self._pending.append(Piece(start, data))
        self.count(len(chunk.status), failed, by_status, chunk.failures)

    def keep_up(self) -> None:
        """Write what has arrived, unless that would take more of the time than is due.

        Raises
        ------
        RunError
            When it cannot be written.
        """
        due = time.monotonic() - self._written >= self._cost / _WRITING_SHARE
        large = sum(piece.data.nbytes for piece in self._pending) > _PENDING_BYTES
        if (due or large) and not self.shapes_all_wrong:
            self._write()

    def adopt(
        self,
        blocks: list[Block],
        rows: Rows,
        chunk: Chunk,
        made: dict[str, str],
        settings: dict[str, Any],
    ) -> None:
        """Write rows that were computed earlier; they count as found."""
        with self._told():
            data = pack(self.row_type, rows, chunk.columns, chunk.status)
            self._take(self._save(blocks, data, chunk.failures, made, settings))
        self.found = self.done

    def dataset(self) -> xr.Dataset:
        """Make the result of rows that are all there, and remove what it was made from.

        Raises
        ------
        RunError
            When it cannot be written; then the rows stay.
        """
        self._write()
        try:
            merge(
                self._study, self._records, self._loaded(), self.examples, self._path, self.folder
            )
        except RunError as error:
            raise RunError(
                f"{error}; the rows are kept, and the same command goes on from there"
            ) from None
        clear(self.folder)
        return results.open_result(self._path)

    def close(self) -> None:
        """Write what has arrived, if that can be done, and remove what is of no use."""
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
        with self._told():
            blocks, data = joined(self._pending)
            failures = self._pending_failures
            record = self._save(blocks, data, failures, self._made, self.settings)
        self._records.append(record)
        self._pending, self._pending_failures = [], {}
        self._written = time.monotonic()
        self._cost = self._written - began

    def _save(
        self,
        blocks: list[Block],
        data: NDArray[Any],
        failures: Failures,
        made: Mapping[str, str],
        settings: Mapping[str, Any],
    ) -> RowsRecord:
        """Write a chunk file, then its line in the journal."""
        _, columns, status = unpack(data)
        record = RowsRecord(
            time=time.time(),
            blocks=tuple(blocks),
            sha256="",
            failed=self.failed_in(Chunk(columns, status, {})),
            status=ended(status),
            failures=failures,
            made=dict(made),
            settings=dict(settings),
        )
        record = record.model_copy(update={"sha256": save(self._file(record), data)})
        self._journal.append(record.model_dump(mode="json"))
        return record

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Tell what a disk that takes no more means for the run."""
        try:
            yield
        except OSError as error:
            kept = sum(record.rows for record in self._records)
            raise RunError(
                f"{self.folder}: could not be written: {reason(error, self.folder)}; {kept} of "
                f"{self.total} rows are kept, and the same command goes on from there"
            ) from None

    def _take(self, record: RowsRecord) -> None:
        self._records.append(record)
        self.count(record.rows, record.failed, record.status, record.failures)

    def _file(self, record: RowsRecord) -> Path:
        return self.folder / f"{self._study.identity[:16]}-{record.file_name}"

    def _load(self, record: RowsRecord) -> NDArray[Any] | None:
        return load(self._file(record), self.row_type, record.rows, record.sha256)

    def _loaded(self) -> Iterator[tuple[RowsRecord, NDArray[Any]]]:
        for record in self._records:
            data = self._load(record)
            if data is None:
                raise RunError(f"{self._file(record)}: was damaged during the run")
            yield record, data
