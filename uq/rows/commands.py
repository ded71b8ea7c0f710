"""What a command that computes rows of a result again must be given besides the result."""

import xarray as xr

from uq.study.registry import model_names


def model_option(ds: xr.Dataset) -> str:
    """Return `` --model FILE`` for rows of a model that is not installed here, else ""."""
    return "" if ds.attrs["model"] in model_names() else " --model FILE"
