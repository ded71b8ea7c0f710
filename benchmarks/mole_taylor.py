"""The mole by heyoka's Taylor series, several machines at a time: the best alternative.

One integrator serves all modes, whose constants are its parameters, and which may differ among
machines side by side. heyoka finds the events; what follows them is compiled.
"""

import heyoka as hy
import numpy as np

from benchmarks import mole_modes as modes
from models.mole.lanes.modes import mole_of
from models.mole.theory.system import Mole


class Taylor:
    """Series to one tolerance, compiled for it and for so many machines side by side."""

    def __init__(self, batch, tolerance):
        y = hy.make_vars(*(f"y_{i}" for i in range(modes.STATE)))
        c = [hy.par[i] for i in range(modes.CONSTANTS)]
        added = c[modes.BAR_COIL] * hy.exp(0.5 * c[modes.SLOPE] * (y[modes.U] * y[modes.U]))
        rates, guards = modes.motion.py_func(y, c, added)
        self.table, self.mode = np.empty((batch, len(Mole._fields))), np.empty((modes.MODE, batch))
        self.integrator = hy.taylor_adaptive_batch(
            list(zip(y, rates, strict=True)),
            np.zeros((modes.STATE, batch)),
            tol=tolerance,
            pars=np.zeros((modes.CONSTANTS, batch)),
            t_events=[self._event(which, guard) for which, guard in enumerate(guards)],
            fast_math=True,
        )
        self.state, self.constants = self.integrator.state, self.integrator.pars

    def _event(self, which, guard):
        def callback(integrator, sign, lane):
            modes.happen(which, self.table, lane, self.state, self.constants, self.mode)
            return True

        # With a cooldown, events soon after each other are missed at low tolerances.
        falling = hy.event_direction.negative
        return hy.t_event_batch(guard, callback=callback, direction=falling, cooldown=0.0)

    def advance(self, table, record, halves):
        """Return the states, shape (10, n), of n machines after some halves of control periods.

        Machines are a multiple of the batch, with one control period.
        """
        half_period = 0.5 * mole_of(table, 0).control_period
        end = np.empty((modes.STATE, len(table)))
        batch = len(self.table)
        for first in range(0, len(table), batch):
            chunk = slice(first, first + batch)
            self.table[:] = table[chunk]
            parts = self.state, self.constants, self.mode
            for lane in range(batch):
                modes.begin(self.table, lane, record[first + lane], *parts)
            self.integrator.set_time(0.0)
            self.integrator.reset_cooldowns()
            for half in range(1, halves + 1):
                self.integrator.propagate_until(half * half_period)
                for lane in range(batch):
                    modes.turn_relay(self.table, lane, *parts)
            end[:, chunk] = self.state
        return end
