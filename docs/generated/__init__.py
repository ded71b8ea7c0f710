"""The tables of the documentation, made from the declarations in the code.

A directive of a page names one of these functions: every public name of the modules below.
"""

from .machine_tables import *  # noqa: F403
from .reference import *  # noqa: F403
from .study_tables import *  # noqa: F403
