"""The records of a run's journal."""

from bisect import bisect_left
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from uq.execution.chunk_file import Block
from uq.execution.tally import Failures
from uq.files.journal import Record

Count = Annotated[int, Field(ge=0, lt=2**62)]


class RunRecord(BaseModel):
    """A run that started or resumed.

    Attributes
    ----------
    time : float
        When [s since 1970].
    host, pid
        The process.
    identity, study, model_version, samples
        What is to be computed, as in the attributes of a result.
    rows : int
        Total number of rows.
    row_type : str
        Layout of a row in the chunk files.
    again : bool
        Whether the run recomputes failed rows of a complete result.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["run"] = "run"
    time: float
    host: str
    pid: int
    identity: str
    study: str
    model_version: str
    samples: Count
    rows: Count
    row_type: str
    again: bool


def _ascending(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
    edges = [edge for block in blocks for edge in block]
    if edges != sorted(edges) or any(start == stop for start, stop in blocks):
        raise ValueError("blocks are empty, overlap or do not ascend")
    return blocks


class RowsRecord(BaseModel):
    """Rows in a chunk file.

    Attributes
    ----------
    time : float
        When they were written [s since 1970].
    blocks : tuple of (int, int)
        First row and end of each block (end excluded), in ascending order.
    sha256 : str
        Checksum of the file.
    failed : int
    status : dict of str to int
        Status label -> rows.
    failures : Failures
    made : dict of str to str
        Processor and versions that computed them.
    settings : dict
        Settings that differ from the study's.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["rows"] = "rows"
    time: float
    blocks: Annotated[
        tuple[tuple[Count, Count], ...], Field(min_length=1), AfterValidator(_ascending)
    ]
    sha256: str
    failed: Count
    status: dict[str, Count]
    failures: Failures
    made: dict[str, str]
    settings: dict[str, Any]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return sum(stop - start for start, stop in self.blocks)

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Numbers of the rows, in the order of the file."""
        return np.concatenate([np.arange(*block) for block in self.blocks])


class History(NamedTuple):
    """The records of a journal in which a run has started.

    Attributes
    ----------
    run : RunRecord
        The latest run.
    chunks : list of RowsRecord
        Rows of all runs.
    latest : list of RowsRecord
        Rows of the latest run.
    """

    run: RunRecord
    chunks: list[RowsRecord]
    latest: list[RowsRecord]

    @property
    def kept(self) -> list[RowsRecord]:
        """Records that count, each row once."""
        return without_overlap(self.chunks, self.run.rows)

    @property
    def complete(self) -> bool:
        """Whether all rows are there."""
        return not missing(self.kept, self.run.rows)


_RECORD: TypeAdapter[RunRecord | RowsRecord] = TypeAdapter(
    Annotated[RunRecord | RowsRecord, Field(discriminator="kind")]
)


def understood(records: Sequence[Record]) -> list[RunRecord | RowsRecord]:
    """Return the valid records of a journal."""
    valid = []
    for record in records:
        with suppress(ValidationError):
            valid.append(_RECORD.validate_python(record))
    return valid


def history_of(records: Sequence[Record]) -> History | None:
    """Return what a journal records; None if no run has started."""
    run, chunks, before = None, list[RowsRecord](), 0
    for record in understood(records):
        if isinstance(record, RowsRecord):
            chunks.append(record)
        else:
            run, before = record, len(chunks)
    return History(run, chunks, chunks[before:]) if run else None


def without_overlap(records: Sequence[RowsRecord], total: int) -> list[RowsRecord]:
    """Return the latest records of rows within 0..total that no later record covers."""
    kept: list[RowsRecord] = []
    taken: list[Block] = []
    for record in reversed(records):
        end = record.blocks[-1][1]
        if end <= total and all(_is_free(taken, *block) for block in record.blocks):
            kept.append(record)
            taken = sorted([*taken, *record.blocks])
    return sorted(kept, key=lambda record: record.blocks)


def _is_free(taken: Sequence[Block], start: int, stop: int) -> bool:
    """Return whether a block overlaps none of some ascending blocks."""
    place = bisect_left(taken, (stop, 0))
    return not place or taken[place - 1][1] <= start


def missing(records: Sequence[RowsRecord], total: int) -> list[Block]:
    """Return the blocks of rows that are in none of some records without overlap."""
    blocks = sorted(block for record in records for block in record.blocks)
    edges = [0, *(edge for block in blocks for edge in block), total]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
