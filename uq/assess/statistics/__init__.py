"""The statistics of an output: ``table`` lists them.

Reading order; each part imports only those above it:

    tolerance        tolerance bounds
    thresholds       the probabilities that an output lies above and below the thresholds of a
    between_regimes  the share of the variance of an output that lies between regimes
    quantiles        the quantiles that a study asks for, and the B-lives of lifetimes
    joint            tolerance bounds that hold for several outputs at once
    moments          mean, standard deviation, and the tail that may rule them out
    counts           how many rows have no value, or one less accurate than requested
    integrated       what is integrated exactly of the lives of an output
    table            the statistics of an output. To add one, write its maker and list it here
"""
