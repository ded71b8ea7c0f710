"""What numba reads from the environment, once, when it is first imported."""

import os
import sys
from typing import Any


def prepare() -> None:
    """Set the instruction set for which every kernel is compiled.

    LLVM prefers 256-bit vectors on CPUs that have both; with 512 bits our kernels are up to 1.8
    times as fast. The target is kept in the environment, so that worker processes compile alike.
    """
    os.environ.setdefault("NUMBA_DISABLE_INTEL_SVML", "1")  # where installed, its last bits differ
    if "NUMBA_CPU_FEATURES" in os.environ or "NUMBA_CPU_NAME" in os.environ:
        return
    from llvmlite import binding

    features: Any = binding.get_host_cpu_features()
    flat = features.flatten()
    if features.get("avx512f") and "numba" not in sys.modules:
        flat += ",-prefer-256-bit"
    os.environ["NUMBA_CPU_NAME"] = binding.get_host_cpu_name()
    os.environ["NUMBA_CPU_FEATURES"] = flat
