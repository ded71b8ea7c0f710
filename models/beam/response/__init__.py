"""The settled response at constant gaps: work-rates, regime, period, and their errors.

Reading order; a module imports only those above it:

    averages               time means under a random load
    approached_orbits      the stable orbits that many beams approach at once
    response               measures of a settled response
    settling               from a start to the settled response
    step_error             the error of the fast propagator's steps
    neighbouring_starts    the error of aperiodic responses, from neighbouring starts
    further_starts         coexisting responses, from starts anywhere
"""
