"""Probabilistic lifetime and sensitivity studies: from a study file to a result.

What ``__init__.pyi`` lists is imported when it is first used, so that ``import uq`` costs nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
