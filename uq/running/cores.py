"""How many cores this process may use."""

import os
from math import ceil
from pathlib import Path

_GROUPS = Path("/sys/fs/cgroup")
_OWN_GROUP = Path("/proc/self/cgroup")


def cores() -> int:
    """Return the cores within the affinity of this process and the limits of its container."""
    if hasattr(os, "sched_getaffinity"):
        count = len(os.sched_getaffinity(0))
    else:
        count = os.cpu_count() or 1
    return min([count, *_quota()])


def _quota() -> list[int]:
    """Return the cores that the control group of this process may use, if it is limited."""
    try:
        own = _OWN_GROUP.read_text().splitlines()[-1].split(":")[-1].strip("/")
        quota, period = (_GROUPS / own / "cpu.max").read_text().split()
    except (OSError, IndexError, ValueError):  # no such file: the first version has others
        try:
            files = ("cpu.cfs_quota_us", "cpu.cfs_period_us")
            quota, period = ((_GROUPS / "cpu" / file).read_text() for file in files)
        except OSError:
            return []
    return [max(1, ceil(int(quota) / int(period)))] if quota.strip() not in ("max", "-1") else []
