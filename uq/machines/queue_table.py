"""The table ``[queue]`` of a machine file: the job that computes a row on a cluster."""

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator

from uq.sampling.input_faults import unknown

SYSTEMS = ("slurm", "pbs", "lsf")
"""Queueing systems."""

_MEMORY = re.compile(r"\d+(\.\d+)? ?[kMGT]i?B")
_WALLTIME = re.compile(r"(?!0+:00:00)\d{1,4}:[0-5]\d:[0-5]\d")


def _one_line(text: str) -> str:
    if not text.isprintable():
        raise ValueError("must be one line of printed characters")
    return text


_Line = Annotated[str, AfterValidator(_one_line)]
Count = Annotated[int, Field(ge=1)]


class QueueTable(BaseModel):
    """``[queue]``: the job that computes one row, or a few."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    system: Literal["slurm", "pbs", "lsf"]
    memory: Annotated[str, Field(description="of a job on each node, such as 16GB")]
    walltime: Annotated[str, Field(description="limit of a job, HH:MM:SS")]
    cores: Annotated[Count, Field(description="of a job on each node")] = 1
    nodes: Annotated[Count, Field(description="of a job")] = 1
    jobs: Annotated[Count, Field(description="at the same time, unless --workers says")] = 10
    rows_per_job: Annotated[Count, Field(description="after which a job ends")] = 1
    arrays: Annotated[bool, Field(description="submit jobs as job arrays")] = False
    partition: Annotated[_Line, Field(description="partition or queue that takes the jobs")] = ""
    account: Annotated[_Line, Field(description="account or project that pays")] = ""
    interface: Annotated[_Line, Field(description="network of the nodes, such as ib0")] = ""
    directives: Annotated[list[_Line], Field(description="further options of a job")] = []
    prologue: Annotated[list[_Line], Field(description="shell commands before the rows")] = []

    @field_validator("system", mode="before")
    @classmethod
    def _is_system(cls, value: Any) -> Any:
        if value not in SYSTEMS:
            raise ValueError(unknown("queueing system", str(value), SYSTEMS))
        return value

    @field_validator("memory", mode="before")
    @classmethod
    def _has_unit(cls, value: Any) -> Any:
        if not (isinstance(value, str) and _MEMORY.fullmatch(value)):
            raise ValueError('must be a number with kB, MB, GB or TB, in quotes: "16GB"')
        return value

    @field_validator("walltime", mode="before")
    @classmethod
    def _is_time(cls, value: Any) -> Any:
        if not (isinstance(value, str) and _WALLTIME.fullmatch(value)):
            raise ValueError('must be hours, minutes and seconds, in quotes: "02:00:00"')
        return value
