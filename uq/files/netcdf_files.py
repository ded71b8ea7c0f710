"""NetCDF files from untrusted sources: validated before opening, sealed with a checksum.

An HDF5 file can store data in other files, link to them and to itself, and declare more data than
it contains. Opening it follows all links. Here its objects are listed with the low-level functions
of the HDF5 library that netCDF4 has loaded; nothing is followed and no value is read.
"""

import ctypes
import hashlib
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

_HDF5, _CLASSIC = b"\x89HDF\r\n\x1a\n", b"CDF"
SIGNATURES = (_HDF5, _CLASSIC)
"""Bytes with which a netCDF file begins, one of these."""

_SLACK, _INFLATION = 100_000_000, 20  # bytes claimed, beyond a multiple of those on the disk
_MOST_OBJECTS, _MOST_ATTRIBUTES = 20_000, 1_000
_LARGEST_CHUNK = 200_000_000  # bytes; each is read as a whole

_ID, _SIZE, _INT = ctypes.c_int64, ctypes.c_size_t, ctypes.c_int
_HARD_LINK, _DATASET, _CHUNKED, _VIRTUAL = 0, 1, 2, 3
_KINDS = {0: "a group", 2: "a type of its own"}
_NUMBERS = {0: (1, 2, 4, 8), 1: (4, 8)}  # classes of integers and floats: their sizes [bytes]
_TEXT = 3
_BUILT_IN_FILTERS = range(1, 7)  # any other is loaded from a library
_OF_DIMENSIONS = ("DIMENSION_LIST", "REFERENCE_LIST")  # netCDF's own references
_INFO_BYTES, _TYPE_AT, _COUNT_AT = 128, 24, 64  # of H5O_info2_t
_BASIC_AND_COUNT = 5


def most_bytes(path: Path) -> int:
    """Return the largest size allowed for the values of a file [bytes], from its space on the disk.

    A sparse file occupies less space than its size. If the file system reports no space, the size
    is used.
    """
    status = path.stat()
    allocated = min(status.st_blocks * 512 or status.st_size, status.st_size)
    return _SLACK + _INFLATION * allocated


def refuse_tricks(path: Path) -> None:
    """Refuse a netCDF file with anything other than variables at its root.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        With the fault: data in other files, links, groups, types or filters of its own, more
        values than its space on the disk can hold.
    OSError
        When it is no netCDF file, or cannot be read.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # a pipe would wait for its writer
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise ValueError("it is not a regular file")
        start = os.read(descriptor, len(_HDF5))
    finally:
        os.close(descriptor)
    if start[:3] == _CLASSIC:  # knows neither links nor other files
        return
    if start != _HDF5:
        raise OSError("not a netCDF file")
    library = _library()
    with _closing(library.H5Fopen(os.fsencode(path), 0, 0), library.H5Fclose) as file:
        _walk(library, file, most_bytes(path))


@cache
def _library() -> Any:
    """Return the HDF5 library of netCDF4."""
    extension: Any = import_module("netCDF4._netCDF4")
    library: Any = ctypes.CDLL(extension.__file__)  # finds what it depends on, too
    for name in (
        "H5Fopen H5Dopen2 H5Dget_create_plist H5Dget_space H5Dget_type H5Aopen_by_idx"
        " H5Aget_space H5Aget_type H5Sget_simple_extent_npoints"
    ).split():
        getattr(library, name).restype = _ID
    library.H5Tget_size.restype = _SIZE
    library.H5Aget_name.restype = ctypes.c_ssize_t
    for name in (
        "H5Fclose H5Dclose H5Pclose H5Sclose H5Tclose H5Aclose H5Dget_create_plist H5Dget_space"
        " H5Dget_type H5Aget_space H5Aget_type H5Sget_simple_extent_npoints H5Tget_class"
        " H5Tget_size H5Tis_variable_str H5Pget_layout H5Pget_external_count H5Pget_nfilters"
    ).split():
        getattr(library, name).argtypes = [_ID]
    library.H5Fopen.argtypes = [ctypes.c_char_p, ctypes.c_uint, _ID]
    library.H5Dopen2.argtypes = [_ID, ctypes.c_char_p, _ID]
    library.H5Oget_info_by_name3.argtypes = [_ID, ctypes.c_char_p, _INFO, ctypes.c_uint, _ID]
    library.H5Literate2.argtypes = [_ID, _INT, _INT, ctypes.c_void_p, _VISIT, ctypes.c_void_p]
    library.H5Pget_chunk.argtypes = [_ID, _INT, ctypes.POINTER(ctypes.c_uint64)]
    library.H5Pget_filter2.argtypes = [_ID, ctypes.c_uint, *[ctypes.c_void_p] * 3, _SIZE] + [
        ctypes.c_void_p
    ] * 2
    library.H5Aopen_by_idx.argtypes = [_ID, ctypes.c_char_p, _INT, _INT, ctypes.c_uint64, _ID, _ID]
    library.H5Aget_name.argtypes = [_ID, _SIZE, ctypes.c_char_p]
    library.H5Eset_auto2.argtypes = [_ID, ctypes.c_void_p, ctypes.c_void_p]
    library.H5Eset_auto2(0, None, None)  # its errors are ours to report
    return library


_INFO = ctypes.c_char * _INFO_BYTES
_VISIT = ctypes.CFUNCTYPE(_INT, _ID, ctypes.c_char_p, ctypes.POINTER(_INT), ctypes.c_void_p)


@contextmanager
def _closing(identifier: int, close: Callable[[int], object]) -> Iterator[int]:
    """Yield an object of the library, and close it."""
    try:
        yield _done(identifier)
    finally:
        if identifier >= 0:
            close(identifier)


def _done(answer: int) -> int:
    if answer < 0:
        raise OSError("not a readable HDF5 file")
    return answer


def _walk(library: Any, file: int, most: int) -> None:
    """Refuse an open file for one of its objects, or for their size together."""
    names: list[bytes] = []
    links: list[int] = []

    def visit(group: int, name: bytes, link: Any, data: Any) -> int:
        names.append(name)
        links.append(link[0])  # its kind
        return int(len(names) > _MOST_OBJECTS)

    _done(library.H5Literate2(file, 0, 0, None, _VISIT(visit), None))
    if len(names) > _MOST_OBJECTS:
        raise ValueError(f"it contains more than {_MOST_OBJECTS} variables")
    _attributes(library, file, b".", most)
    claimed = 0
    for name, link in zip(names, links, strict=True):
        label = f"'{name.decode(errors='replace')}'"
        if link != _HARD_LINK:
            raise ValueError(f"{label} is a link")
        kind = _attributes(library, file, name, most)
        if kind != _DATASET:
            raise ValueError(f"{label} is {_KINDS.get(kind, 'no variable')}")
        with _closing(library.H5Dopen2(file, name, 0), library.H5Dclose) as dataset:
            claimed += _size_of(library, dataset, label, most)
    _refuse_size(claimed, most)


def _refuse_size(claimed: int, most: int) -> None:
    if claimed > most:
        held = (most - _SLACK) / _INFLATION / 1e6
        raise ValueError(f"its {held:.3g} MB claim to be {claimed / 1e9:.3g} GB")


def _attributes(library: Any, file: int, name: bytes, most: int) -> int:
    """Refuse the attributes of an object; return its kind."""
    info = _INFO()
    _done(library.H5Oget_info_by_name3(file, name, info, _BASIC_AND_COUNT, 0))
    kind = int.from_bytes(info.raw[_TYPE_AT : _TYPE_AT + 4], "little")
    count = int.from_bytes(info.raw[_COUNT_AT : _COUNT_AT + 8], "little")
    if count > _MOST_ATTRIBUTES:
        raise ValueError(f"it contains more than {_MOST_ATTRIBUTES} attributes of one variable")
    for number in range(count):
        opened = library.H5Aopen_by_idx(file, name, 0, 0, number, 0, 0)
        with _closing(opened, library.H5Aclose) as attribute:
            called = ctypes.create_string_buffer(256)
            library.H5Aget_name(attribute, len(called), called)
            label = called.value.decode(errors="replace")
            if label not in _OF_DIMENSIONS:
                _values(library, attribute, "H5A", label, most)
    return kind


def _values(library: Any, owner: int, prefix: str, label: str, most: int) -> tuple[int, int]:
    """Refuse values that are neither numbers nor text; return their number and size [bytes].

    `prefix` begins the names of the library's functions for the owner: of an attribute "H5A", of a
    dataset "H5D".
    """
    with _closing(getattr(library, f"{prefix}get_space")(owner), library.H5Sclose) as space:
        count = _done(library.H5Sget_simple_extent_npoints(space))
    with _closing(getattr(library, f"{prefix}get_type")(owner), library.H5Tclose) as kind:
        size, type_class = library.H5Tget_size(kind), library.H5Tget_class(kind)
        if type_class not in _NUMBERS and type_class != _TEXT:
            raise ValueError(f"{label} has neither numbers nor text")
        if type_class != _TEXT and size not in _NUMBERS[type_class]:
            raise ValueError(f"{label} has numbers of {size} bytes, which netCDF has not")
        if type_class == _TEXT and library.H5Tis_variable_str(kind) > 0:
            size = max((most - _SLACK) // _INFLATION, 1)  # all may be one and the same long text
    _refuse_size(count * size, most)
    return count, size


def _size_of(library: Any, dataset: int, label: str, most: int) -> int:
    """Return the declared size of a variable [bytes]; refuse data outside the file."""
    with _closing(library.H5Dget_create_plist(dataset), library.H5Pclose) as how:
        layout = library.H5Pget_layout(how)
        if layout == _VIRTUAL or library.H5Pget_external_count(how) != 0:
            raise ValueError(f"the values of {label} are in another file")
        for number in range(_done(library.H5Pget_nfilters(how))):
            length = _SIZE(0)
            more = (None, ctypes.byref(length), None, 0, None, None)
            if library.H5Pget_filter2(how, number, *more) not in _BUILT_IN_FILTERS:
                raise ValueError(f"{label} is packed in a way that needs a plugin")
        sides = (ctypes.c_uint64 * 32)()
        rank = _done(library.H5Pget_chunk(how, 32, sides)) if layout == _CHUNKED else 0
    count, size = _values(library, dataset, "H5D", label, most)
    chunk = size
    for side in sides[:rank]:
        chunk *= side
    if rank and chunk > _LARGEST_CHUNK and chunk > 2 * count * size:
        raise ValueError(f"{label} is stored in pieces of {chunk / 1e9:.3g} GB")
    return count * size


CHECKSUM = "checksum"
"""Attribute of the file."""

_ROWS = 1_000_000  # read at a time


def seal(path: Path) -> None:
    """Store the checksum of a file as an attribute."""
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file.setncattr(CHECKSUM, _checksum(file))


def is_intact(path: Path) -> bool | None:
    """Return whether a file is unchanged since it was sealed; None if it never was.

    Raises
    ------
    Any of `uq.result.result_file.UNREADABLE`
        When it cannot be read at all.
    """
    import netCDF4

    with netCDF4.Dataset(path, "r") as file:
        return file.getncattr(CHECKSUM) == _checksum(file) if CHECKSUM in file.ncattrs() else None


def _checksum(file: Any) -> str:
    """Return the SHA-256 of all variables and attributes but the checksum itself."""
    whole = hashlib.sha256()
    _add_attributes(whole, file)
    for name in sorted(file.variables):
        variable = file[name]
        variable.set_auto_maskandscale(False)
        whole.update(repr((name, variable.dimensions, variable.shape)).encode())
        _add_attributes(whole, variable)
        if variable.shape:
            for start in range(0, variable.shape[0], _ROWS):
                _add_values(whole, variable[start : start + _ROWS])
        else:
            _add_values(whole, variable[...])
    return whole.hexdigest()


def _add_attributes(whole: Any, owner: Any) -> None:
    for name in sorted(owner.ncattrs()):
        if name != CHECKSUM:
            whole.update(name.encode())
            _add_values(whole, owner.getncattr(name))


def _add_values(whole: Any, values: Any) -> None:
    array = np.asarray(values)
    if array.dtype.kind in "OU":
        whole.update(repr(array.tolist()).encode())
    else:
        whole.update(array.dtype.str.encode())
        whole.update(np.ascontiguousarray(array).data)
