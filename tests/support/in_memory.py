"""Studies carried out in memory, for tests of how rows are carried out."""

from uq.execution.options import RunOptions
from uq.execution.runner import carry_out
from uq.result.workload import workload_of


def compute(study, **options):
    """Run a study without writing anything; options as those of `RunOptions`."""
    return carry_out(workload_of(study), RunOptions(**options))
