"""Studies carried out in memory, for tests of how rows are carried out."""

from uq.rows.workload import workload_of
from uq.running.options import RunOptions
from uq.running.runner import carry_out


def compute(study, **options):
    """Run a study without writing anything; options as those of `RunOptions`."""
    return carry_out(workload_of(study), RunOptions(**options))
