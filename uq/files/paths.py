"""Checks of paths before reading or writing: only regular files are ever replaced."""

import os
import stat
from contextlib import suppress
from errno import ENAMETOOLONG
from pathlib import Path

from uq.errors import InputError, nearest

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
        # a circular link does not exist for whoever follows it
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
            f"{path}: no such file{nearest(path.name, [other.name for other in others])}"
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
    """Return the user's cache folder of a program; where there is none, a place never writable.

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
