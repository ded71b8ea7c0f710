"""A warning where a result has changed since it was written."""

from pathlib import Path

from uq.cli import streams
from uq.files.seal import is_intact
from uq.result.result_file import UNREADABLE

_LARGEST = 20_000_000  # bytes: their checksum takes a small part of the time of a summary


def warn_if_altered(path: Path) -> None:
    """Print a line if the checksum of a result is wrong; larger ones are left to `uq verify`."""
    if path.stat().st_size > _LARGEST:
        return
    try:
        altered = is_intact(path) is False
    except UNREADABLE as error:
        of_the_system = isinstance(error, OSError) and (error.errno or 0) > 0
        altered = not of_the_system
    if altered:
        streams.complain(f"{path}: has changed since it was written: its checksum is wrong")
