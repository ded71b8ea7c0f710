"""What is where a file is to be read or written: only regular files are ever replaced."""

import os
import stat
from errno import ENAMETOOLONG
from pathlib import Path

from uq.errors import InputError

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}

_TOO_LONG = "too long a name"
_LONGEST = 225  # bytes in a name: rows are kept beside a result under it with an ending


def node(path: Path) -> str:
    """Return what stands in the place of a file, such as "a device"; nothing where all is well."""
    try:
        kind = stat.S_IFMT(path.stat().st_mode)
    except OSError as error:
        if error.errno == ENAMETOOLONG:
            return _TOO_LONG
        # a link that leads in a circle exists for nobody who follows it
        return "a link that leads nowhere" if Path(os.path.realpath(path)).is_symlink() else ""
    return "" if kind == stat.S_IFREG else _KINDS[kind]


def file_behind(path: Path) -> Path:
    """Return the file that is written where a path is given: that to which a link leads.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Path
        A regular file, or nothing yet.

    Raises
    ------
    InputError
        When it is anything else: only regular files are ever replaced.
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
        case what:
            raise InputError(f"{path}: is {what}, not a file; choose another place with -o")


def refuse_standard_output(path: Path) -> None:
    """Refuse "-": a result is a file that can be read in any order."""
    if str(path) == "-":
        raise InputError("-: output goes to a file, not to standard output; give its name")
