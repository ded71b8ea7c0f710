"""Probabilistic lifetime and sensitivity studies: from a study file to a result.

Its packages, from the ground up; each imports only those before it:

- `contract`, what a model declares, and the other modules of `uq` itself: errors, estimates, words;
- `designs`, `inputs`, `methods`, `study`: what is to be computed, and what it can answer;
- `rows`, `store`: rows drawn, evaluated, and kept;
- `running`, `upkeep`, `exploring`: what runs models;
- `indices`, `population`, `analysis`, `conclusions`, `drawing`, `tracing`, `report`: what reads
  results;
- `cli`: the command.

The picture is in docs/architecture.md. What ``__init__.pyi`` lists is imported when it is first
used, so that ``import uq`` costs nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
