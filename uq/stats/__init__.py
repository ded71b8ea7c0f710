"""Statistics of plain arrays: estimates, intervals, order statistics, Kaplan-Meier, weights.

Reading order; each part imports only those above it:

    quantile_functions    quantile functions of the laws behind intervals
    estimate              one number with its interval, or the reason why there is none
    jumps                 the error that jumps leave in the mean of designs that spread evenly
    clusters              rows that are not independent
    location_scale        maximum likelihood for Weibull and lognormal lives
    roots                 where a function of one variable changes its sign
    kaplan_meier          the share that outlives each time
    beta_products         the share of rows that has ended by each time
    counting              how many units of a fleet have ended
    estimate_text         estimates as text: values, intervals, and bounds with failed rows
    two_samples           the difference and ratio of two estimates
    estimate_json         estimates as JSON
    intervals             intervals of 95 % for means and shares
    tails                 how heavy the tails of an output are
    group_sequential      the confidence of each of several checks
    order_statistics      quantiles, their intervals, and tolerance bounds
    survival_band         a simultaneous confidence band of a survival curve
    uncertainty_exponent  how intermingled basins are
    variance_components   shares of the variance of nested rows
    hall_intervals        the interval of a mean whose coverage skewness does not lower
    control_variate       control variates
    importance_weights    importance weights
    moments               mean and standard deviation with their intervals, where they exist
    weighted_means        weighted means of numbers between 0 and 1, with intervals
    mixing_bounds         bounds on how a probability is distributed over worlds, from counts
"""
