"""How deep each site has worn at given instants: the lives read the other way round."""

import numpy as np

from models.numerics.jit import inlined


@inlined
def passed(part, before, after):
    """Return the part of a time in which a part of the growth takes place.

    The inverse of the rate is linear in the growth along the way, from `before` to `after`.
    """
    if before > 0 and after > 0:
        return part * (2 * after + (before - after) * part) / (before + after)
    return part


@inlined
def grown_in(part, before, after):
    """Return the part of the growth in a part of the time: the inverse of `passed`."""
    if before > 0 and after > 0:
        root = np.sqrt(after**2 + (before**2 - after**2) * part)
        return part * (before + after) / (after + root)
    return part


@inlined
def note_depths(i, life, out, time, growth, rate):
    """Record the worn depths of beam i at the instants within a period of gap growth."""
    silent = rate[0] <= 0 and rate[1] <= 0
    for site in range(2):
        if silent and growth[site] > 0:
            life.excess[i, site] = growth[site] - _until_silent(i, life, site, growth)
        for k in range(life.instants.shape[1]):
            since = life.instants[i, k] - life.clock[i]
            if 0 <= since <= time:
                part = since / time if time > 0 else 0.0
                grown = grown_in(part, life.rate[i, site], rate[site]) * growth[site]
                if silent:
                    grown = min(grown, growth[site] - life.excess[i, site])
                out.depth[i, site, k] = life.grown[i, site] + grown


@inlined
def _until_silent(i, life, site, growth):
    """Return the part of a growth after which contact ends.

    A gap grows to the free amplitude. Contact that lasts beyond it ends anywhere.
    """
    room = life.free_reach[i] - life.initial[i, site] - life.grown[i, site]
    return min(room, growth[site]) if room > 0 else growth[site] / 2


def note_later_depths(life, out):
    """Record the worn depths of n beams at the instants after the end of their lives."""
    worn = np.where(out.ended[:, None], life.grown - life.excess, np.nan)
    last = np.maximum(life.grown, life.growths[:, -1:])
    worn = np.where(out.reached[:, :, -1], last, worn)
    out.depth[:] = np.where(np.isnan(out.depth), worn[:, :, None], out.depth)
