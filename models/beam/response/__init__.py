"""The settled response at constant gaps: work-rates, regime, period, and their errors.

averages               time means under a random load
approached_orbits      the stable orbits that many beams approach at once
settling               from a start to the settled response
step_error             the error of the steps of the fast propagator
neighbouring_starts    the error of one aperiodic response out of many
"""
