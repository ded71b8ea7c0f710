"""Test processes that start together compile each kernel once, not once each."""

from pathlib import Path
from typing import Any

from filelock import FileLock
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher


def compile_once_for_all_processes():
    """Make whoever wants a kernel that another process compiles wait, and load it from the disk."""
    patched: Any = Dispatcher
    compile_kernel = patched.compile

    def compile_or_load(self, signature):
        folder = self._cache.cache_path
        if folder is None:  # not kept on disk
            return compile_kernel(self, signature)
        name = f"{self.py_func.__qualname__}-{self.py_func.__code__.co_firstlineno}.lock"
        # Kernels call each other in one direction, so nobody waits for somebody who waits. Two of
        # one factory share a name, and one may call the other: a lock may be taken again.
        with global_compiler_lock, FileLock(Path(folder) / name, is_singleton=True):
            return compile_kernel(self, signature)

    patched.compile = compile_or_load
