"""Paths checked before writing, and files written completely or not at all."""

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import ENAMETOOLONG
from pathlib import Path
from typing import TYPE_CHECKING

from uq.errors import InputError, RunError, nearest_file
from uq.files.interrupts import undone
from uq.files.netcdf_files import seal

if TYPE_CHECKING:
    import xarray as xr


_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}

_TOO_LONG = "too long a name"
_LONGEST = 225  # bytes in a name: the folder of rows beside a result appends an ending


def node(path: Path) -> str:
    """Return the kind of a path that is not a file, such as "a device"; "" if nothing is wrong."""
    try:
        kind = stat.S_IFMT(path.stat().st_mode)
    except OSError as error:
        if error.errno == ENAMETOOLONG:
            return _TOO_LONG
        # a circular link does not exist when followed
        return "a link that leads nowhere" if Path(os.path.realpath(path)).is_symlink() else ""
    return "" if kind == stat.S_IFREG else _KINDS[kind]


def file_there(path: Path) -> None:
    """Refuse a path without a file.

    Raises
    ------
    InputError
        With the nearest name of a file of its kind.
    """
    if kind := node(path):
        raise InputError(f"{path}: is {kind}, not a file")
    if not path.is_file():
        others = path.parent.glob(f"*{path.suffix}") if path.parent.is_dir() else []
        raise InputError(
            f"{path}: no such file{nearest_file(path.name, [other.name for other in others])}"
        )


def file_behind(path: Path, option: str = "-o") -> Path:
    """Return the file to write for a path: the target of a link.

    Parameters
    ----------
    path : Path
    option : str
        Of the command, to choose another.

    Returns
    -------
    Path
        A regular file, or a path that does not exist yet.

    Raises
    ------
    InputError
        When it is anything else.
    """
    refuse_standard_output(path)
    match node(path):
        case "":
            file = Path(os.path.realpath(path)) if path.is_symlink() else path
            if len(os.fsencode(file.name)) > _LONGEST:
                raise InputError(f"{path}: is {_TOO_LONG}; at most {_LONGEST} bytes")
            return file
        case "a folder":
            raise InputError(f"{path}: is a folder; give the name of a file in it")
        case kind:
            raise InputError(f"{path}: is {kind}, not a file; choose another place with {option}")


def cache_path(name: str) -> Path:
    """Return the user's cache folder of a program; an unwritable path if there is none.

    Without HOME and an entry among the users, the home folder is unknown, or a relative ``~``.
    """
    from platformdirs import user_cache_path

    with suppress(RuntimeError):  # which versions of platformdirs raise without a home
        path = user_cache_path(name, appauthor=False)
        if path.is_absolute():
            return path
    return Path(os.devnull) / name


def refuse_standard_output(path: Path) -> None:
    """Refuse "-": a result must be a file with random access."""
    if str(path) == "-":
        raise InputError("-: output goes to a file, not to standard output; give its name")


def check_target(path: Path, size: int, option: str = "-o") -> None:
    """Refuse a path that cannot be written, before anything is computed.

    Parameters
    ----------
    path : Path
    size : int
        Expected size of what will be written [bytes].
    option : str
        Of the command, to choose another.

    Raises
    ------
    InputError
    """
    folder = nearest_folder(file_behind(path, option))
    elsewhere = f"choose another place with {option}"
    remedy = "copy it elsewhere" if path.is_file() else elsewhere
    if not folder.is_dir():
        raise InputError(f"{path}: {folder} is a file, not a folder; {remedy}")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{path}: cannot write in {folder}: {error.strerror}; {remedy}") from None
    free = shutil.disk_usage(folder).free
    if free < size:
        raise InputError(
            f"{path}: the result takes about {size / 1e6:.0f} MB, "
            f"and {folder} has {free / 1e6:.0f} MB left; {remedy}"
        )


def write(ds: "xr.Dataset", path: Path) -> None:
    """Write a Dataset as netCDF4 under a temporary name, then rename it.

    Parameters
    ----------
    ds : xarray.Dataset
    path : Path
        Missing folders are created.

    Raises
    ------
    RunError
        When it cannot be written; nothing is left behind then.
    """
    with whole(path) as temporary:
        ds.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")


def write_result(ds: "xr.Dataset", path: Path) -> None:
    """Write a result as `write` does, with its checksum."""
    with whole(path) as temporary:
        ds.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
        seal(temporary)


@contextmanager
def whole(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """Yield a temporary name; the file written under it becomes `path` when the block ends.

    Parameters
    ----------
    path : Path
        Missing folders are created; a link is followed.
    folder : Path, optional
        Of the temporary file, on the same disk; by default the folder of the file.

    Yields
    ------
    Path

    Raises
    ------
    InputError
        When there is something other than a file.
    RunError
        When the file cannot be written; nothing is left behind then.
    """
    file = file_behind(path)
    made = [parent for parent in file.absolute().parents if not parent.exists()]
    temporary = (folder or file.parent) / f".{file.name}.{os.getpid()}.part"

    def clear() -> None:
        temporary.unlink(missing_ok=True)
        remove_empty(made)

    with undone(clear):
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            flush(temporary)
            os.replace(temporary, file)
            flush(file.parent)
        except (OSError, RuntimeError) as error:
            raise RunError(f"{path}: could not be written: {reason(error, path)}") from None


def remove_empty(folders: list[Path]) -> None:
    """Remove empty folders, the innermost first."""
    for folder in folders:
        if folder.exists() and not any(folder.iterdir()):
            folder.rmdir()


def flush(path: Path) -> None:
    """Wait until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def nearest_folder(path: Path) -> Path:
    """Return the innermost folder above `path` that exists."""
    return next(parent for parent in path.absolute().parents if os.path.exists(parent))


def reason(error: Exception, path: Path) -> str:
    """Return why a write failed: HDF5 reports a full disk or a quota as "HDF error"."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    free = shutil.disk_usage(nearest_folder(path)).free
    return f"{error} ({free / 1e6:.0f} MB left on the disk, unless there is a quota)"
