"""A netCDF file that reaches beyond itself, or claims more than it holds, is refused unopened."""

import ctypes
import os
import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from uq.execution import runner
from uq.files.netcdf_files import refuse_tricks
from uq.machines.machine_file import OutputTable
from uq.machines.program_outputs import value_in
from uq.machines.returned import RowError

ROWS = 24
ID = ctypes.c_int64
HDF5 = ctypes.CDLL(netCDF4._netCDF4.__file__)
for function in ("H5Fopen", "H5Tcopy", "H5Screate_simple", "H5Pcreate", "H5Dcreate2"):
    getattr(HDF5, function).restype = ID


@pytest.fixture
def result(folder, write_study):
    runner.run(write_study(samples=ROWS), "x.nc", workers=0)
    return folder / "x.nc"


def stored_outside(file, how):
    """Replace the output by one whose values are elsewhere."""
    classes = ID.in_dll(HDF5, "H5P_CLS_DATASET_CREATE_ID_g")
    properties = ID(HDF5.H5Pcreate(classes))
    space = ID(HDF5.H5Screate_simple(1, (ctypes.c_uint64 * 1)(ROWS), None))
    if how == "external":
        beyond = ctypes.c_uint64(8 * ROWS)
        assert not HDF5.H5Pset_external(properties, b"secret", ctypes.c_long(0), beyond)
    else:
        assert not HDF5.H5Pset_virtual(properties, space, b"secret", b"/y", space)
    number = ID.in_dll(HDF5, "H5T_NATIVE_DOUBLE_g")
    made = HDF5.H5Dcreate2(file, b"w", number, space, ID(0), properties, ID(0))
    assert made > 0
    HDF5.H5Dclose(ID(made))


def half_precision(file):
    """Add numbers of two bytes, which netCDF takes for pointers to text."""
    kind = ID(HDF5.H5Tcopy(ID.in_dll(HDF5, "H5T_IEEE_F32LE_g")))
    assert HDF5.H5Tset_fields(kind, *map(ctypes.c_size_t, (15, 10, 5, 0, 10))) >= 0
    assert HDF5.H5Tset_size(kind, ctypes.c_size_t(2)) >= 0
    space = ID(HDF5.H5Screate_simple(1, (ctypes.c_uint64 * 1)(ROWS), None))
    made = HDF5.H5Dcreate2(file, b"w", kind, space, ID(0), ID(0), ID(0))
    assert made > 0
    HDF5.H5Dclose(ID(made))


TRICKS = {
    "half precision": (half_precision, "'w' has numbers of 2 bytes"),
    "external storage": (lambda file: stored_outside(file, "external"), "in another file"),
    "virtual": (lambda file: stored_outside(file, "virtual"), "in another file"),
    "soft link": (lambda f: HDF5.H5Lcreate_soft(b"/", f, b"w", ID(0), ID(0)), "is a link"),
    "external link": (
        lambda file: HDF5.H5Lcreate_external(b"good.nc", b"/y", file, b"w", ID(0), ID(0)),
        "is a link",
    ),
    "root in itself": (
        lambda file: HDF5.H5Lcreate_hard(file, b"/", file, b"w", ID(0), ID(0)),
        "is a group",
    ),
}


@pytest.mark.parametrize("trick", TRICKS)
def test_a_file_that_reaches_beyond_itself_is_refused(uq, result, folder, write_study, trick):
    act, words = TRICKS[trick]
    shutil.copy(result, "good.nc")
    file = ID(HDF5.H5Fopen(os.fsencode(result), 1, ID(0)))
    act(file)
    HDF5.H5Fclose(file)
    os.mkfifo("secret")  # reading it would never end
    for verb in (("summary",), ("plot",), ("verify",), ("row", "3"), ("compare", "good.nc")):
        ended = uq(verb[0], result, *verb[1:])
        assert (ended.code, ended.err.count("\n")) == (2, 1) and words in ended.err
    study = write_study(method="imported", name="imported")
    study.write_text(study.read_text().replace("replicates = 1", 'file = "x.nc"'))
    ended = uq("check", study)
    assert ended.code == 2 and words in ended.err
    wanted = OutputTable(file="x.nc", netcdf="w")
    with pytest.raises(RowError, match=words):
        value_in(folder, "w", wanted)


def test_a_file_that_claims_more_than_its_disk_holds_is_refused(uq, result):
    with netCDF4.Dataset("sparse.nc", "w") as file:
        file.createDimension("row", 80_000_000)
        for name in ("y", "x1", "x2"):
            file.createVariable(name, "f8", ("row",), fill_value=False)[-1] = 1.0
    assert Path("sparse.nc").stat().st_size > 1e9
    with pytest.raises(ValueError, match="MB claim to be"):
        refuse_tricks(Path("sparse.nc"))
    with netCDF4.Dataset(result, "a") as file:
        file.createDimension("much", None)
        file.createVariable("z", "f8", ("much",), chunksizes=(10**8,))
    ended = uq("summary", result)
    assert ended.code == 2 and "in pieces of 0.8 GB" in ended.err


def test_types_and_filters_of_their_own_are_refused(folder):
    with netCDF4.Dataset("type.nc", "w") as file:
        file.createCompoundType(np.dtype([("a", "f8")]), "pair")
    with netCDF4.Dataset("filter.nc", "w") as file:
        file.createDimension("x", 4)
        file.createVariable("y", "f8", ("x",), compression="zstd")[:] = 1.0
    with netCDF4.Dataset("group.nc", "w") as file:
        file.createGroup("inner")
    for name, words in (("type", "a type"), ("filter", "needs a plugin"), ("group", "a group")):
        with pytest.raises(ValueError, match=words):
            refuse_tricks(Path(f"{name}.nc"))


def test_ordinary_files_pass(result):
    with netCDF4.Dataset("packed.nc", "w") as file:
        file.createDimension("x", 4)
        file.createVariable("y", "f8", ("x",), compression="zlib", fletcher32=True)[:] = 1.0
        file.createVariable("name", str, ("x",))[0] = "a"
        file.words = ["one", "two"]
    with netCDF4.Dataset("classic.nc", "w", format="NETCDF3_CLASSIC") as file:
        file.createDimension("x", 4)
    for path in (result, Path("packed.nc"), Path("classic.nc")):
        refuse_tricks(path)
