"""The statistics of an output: ``table`` lists them.

Reading order; each part imports only those above it:

    between_regimes  the share of the variance of an output that lies between regimes
    counts           numbers of rows without a value, or less accurate than requested
    quantiles        the quantiles that a study asks for, and the B-lives of lifetimes
    moments          mean, standard deviation, and the tail that may rule them out
    thresholds       probabilities that an output lies above and below thresholds
    tolerance        tolerance bounds
    integrated       variance reduction by exact integration of the lives of an output
    table            the statistics of an output. To add one, write its maker and list it here
"""
