"""The normal scores of the inputs along the paths of a design."""

from dataclasses import replace

import numpy as np
import xarray as xr

from uq.contract import Floats
from uq.inputs.conditional import conditional_paths
from uq.inputs.dependence import normal_correlations
from uq.methods.sample import Sample
from uq.rows.elements import study_file_of
from uq.study.input_checks import laws_of


def with_scores(sample: Sample, ds: xr.Dataset, unit: Floats) -> Sample:
    """Return a sample of paths with the normal scores of its inputs.

    Parameters
    ----------
    sample : Sample
        Without scores.
    ds : xarray.Dataset
        The result that it is of.
    unit : ndarray, shape (R, N, k, d)
        The points of its design, independent.

    Returns
    -------
    Sample
    """
    from scipy.special import ndtri

    names, laws = list(sample.inputs), laws_of(ds.attrs["study"])
    unit, matrix = unit.copy(), np.eye(len(names))
    stated = study_file_of(ds).dependence
    discrete = {name for name, law in laws.items() if law.discrete}
    if stated is not None:
        places = [names.index(name) for name in stated.parameters]
        if discrete & set(stated.parameters):  # scores behind their values are not known
            discrete |= set(stated.parameters)
        else:
            paths = unit[..., places].reshape(-1, unit.shape[2], len(places))
            none = [None] * len(places)
            paths = conditional_paths(paths, stated.rank_correlation, none)
            unit[..., places] = paths.reshape(*unit.shape[:-1], len(places))
            matrix[np.ix_(places, places)] = normal_correlations(stated.rank_correlation)
    scores = ndtri(unit)
    scores[..., [names.index(name) for name in discrete]] = np.nan
    return replace(sample, scores=scores, matrix=matrix)
