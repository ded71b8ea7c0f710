"""Probabilistic lifetime and sensitivity studies: from a study file to a result.

Reading order of its packages; each part imports only those above it:

    contract     what a model declares
    errors       errors for the user: plain lines, never a traceback
    text         numbers, quantities with units, symbols and names as text
    files        checked paths, whole writes, journals, checksums, netCDF files from anyone
    stats        statistics of plain arrays
    sampling     laws of inputs, their dependence, and designs
    indices      sensitivity indices: estimators, and what each requires
    machines     functions, programs, servers and FMUs as models
    study        a study: its file, checked and bound to its model, and its rows
    result       the schema of a result, its elements, weights, and rows that belong together
    assess       statistics, lives, sensitivities, comparison, the answer: what reads results
    execution    processes, dask workers, rows kept on disk
    learning     learning from inspections
    explore      analyses that run a model themselves
    render       figures, HTML pages, traces of numbers
    plots        the public face of the figures
    cli          the command

The picture is in docs/architecture.md. What ``__init__.pyi`` lists is imported when it is first
used, so that ``import uq`` costs nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
