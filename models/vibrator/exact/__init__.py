"""The exact propagator: any machine, one at a time, with error control.

Read `propagator`; then `budgeted`, a machine that is run again and again, its periodic `orbit`, and
the `measures` of a sampled motion.
"""
