"""What stands in the journal of a run."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from uq.store.chunk_file import Block
from uq.store.journal import Record
from uq.store.tally import Failures

Count = Annotated[int, Field(ge=0, lt=2**62)]


class RunRecord(BaseModel):
    """A run that began, or went on.

    Attributes
    ----------
    time : float
        When [s since 1970].
    host, pid
        Which process it was.
    identity, study, model_version, samples
        As in the attributes of a result: what is to be computed.
    rows : int
        Rows in all.
    row_type : str
        How rows lie in the chunk files.
    again : bool
        Whether it is about failed rows of a result that is complete.
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


class RowsRecord(BaseModel):
    """Rows that are in a chunk file.

    Attributes
    ----------
    time : float
        When they were written [s since 1970].
    blocks : tuple of (int, int)
        First row and the one behind the last of each block, in ascending order.
    sha256 : str
        Of the file.
    failed : int
    status : dict of str to int
        Status label -> rows.
    failures : Failures
    made : dict of str to str
        Processor and versions that computed them.
    settings : dict
        Settings that were others than the study's.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["rows"] = "rows"
    time: float
    blocks: Annotated[tuple[tuple[Count, Count], ...], Field(min_length=1)]
    sha256: str
    failed: Count
    status: dict[str, Count]
    failures: Failures
    made: dict[str, str]
    settings: dict[str, Any]

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return sum(stop - start for start, stop in self.blocks)

    @property
    def file_name(self) -> str:
        """Name of the chunk file, behind the study's hash: no record can name another file."""
        return f"{self.blocks[0][0]}-{self.blocks[-1][1]}.rows"

    @property
    def in_order(self) -> bool:
        """Whether the blocks are what they should be."""
        edges = [edge for block in self.blocks for edge in block]
        return edges == sorted(edges) and all(start < stop for start, stop in self.blocks)


_RECORD: TypeAdapter[RunRecord | RowsRecord] = TypeAdapter(
    Annotated[RunRecord | RowsRecord, Field(discriminator="kind")]
)


def understood(records: Sequence[Record]) -> list[RunRecord | RowsRecord]:
    """Return those records of a journal that mean something."""
    found = []
    for record in records:
        try:
            known = _RECORD.validate_python(record)
        except ValidationError:
            continue
        if isinstance(known, RunRecord) or known.in_order:
            found.append(known)
    return found


def without_overlap(records: Sequence[RowsRecord], total: int) -> list[RowsRecord]:
    """Return the latest records of rows within 0..total that no later record holds too."""
    kept: list[RowsRecord] = []
    free: list[Block] = [(0, total)]
    for record in reversed(records):
        rest = _without(free, record.blocks)
        if _size(free) - _size(rest) == record.rows:
            kept.append(record)
            free = rest
    return sorted(kept, key=lambda record: record.blocks)


def missing(records: Sequence[RowsRecord], total: int) -> list[Block]:
    """Return the blocks of rows that no record holds."""
    return _without([(0, total)], sorted(block for record in records for block in record.blocks))


def _without(free: Sequence[Block], taken: Sequence[Block]) -> list[Block]:
    """Return what is left of some blocks when others are taken away; both in ascending order."""
    left: list[Block] = []
    rest = list(taken)[::-1]
    for start, stop in free:
        while rest and rest[-1][0] < stop:
            first, last = rest[-1]
            if start < first:
                left.append((start, first))
            start = max(start, last)
            if last > stop:
                break
            rest.pop()
        if start < stop:
            left.append((start, stop))
    return left


def _size(blocks: Sequence[Block]) -> int:
    return sum(stop - start for start, stop in blocks)
