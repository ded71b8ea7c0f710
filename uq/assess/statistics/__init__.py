"""The statistics of an output: ``table`` lists them.

Reading order; each part imports only those above it:

    counts     rows without a value or less accurate than requested
    moments    mean, standard deviation and tail, and the share of the variance between regimes
    quantiles  quantiles, B-lives, probabilities at thresholds
    causes     cumulative incidence and B-lives of each cause that may end a life
    tolerance  tolerance bounds: limits for a given share of all values, with a given confidence
    table      the statistics of an output. To add one, write its maker and list it here
"""
