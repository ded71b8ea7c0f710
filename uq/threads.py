"""One thread per process for linear algebra: the rows are what runs in parallel."""

SINGLE_THREADED = {
    f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")
}
"""Environment that these libraries read when they are loaded.

Several processes with a thread per core each would get in each other's way, and another number of
threads may give other last bits.
"""
