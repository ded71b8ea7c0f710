"""Populations: rows with weights, each a value known to the digit or the law of a life.

Reading order; a module imports only those above it:

    sums            the law of a sum of independent logarithms
    scale_laws      the law of what scales a life, given all that does not
    row_inputs      the inputs of some rows, and their laws
    scaling         the inputs of a result that are integrated, and the laws of its lives
    by_level        what scales a life, level by level
    smoothing       smoothed importance weights, and whether they can be trusted
    means           weighted means of numbers between 0 and 1, with intervals
    functionals     probabilities and quantiles of a population
    counting        how many units of a fleet have ended
    fleets          units of one world, and how many of them have ended
    worlds          how the probability of a unit's life spreads over worlds
    densities       the density of the inputs under a study
    reweighting     the rows of a result as those of another study
"""
