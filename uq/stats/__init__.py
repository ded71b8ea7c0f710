"""Statistics of plain arrays: estimates, intervals, order statistics, Kaplan-Meier, weights.

Reading order; each part imports only those above it:

    clusters              rows that are not independent
    estimate              one number with its interval, or the reason why there is none
    quantile_functions    quantile functions of the laws behind intervals
    roots                 roots of a function of one variable
    jumps                 the error that jumps leave in the mean of designs that spread evenly
    location_scale        maximum likelihood for Weibull and lognormal lives
    estimate_json         estimates as JSON
    two_samples           the difference and ratio of two estimates
    intervals             intervals of 95 % for means and shares
    control_variate       control variates
    group_sequential      the confidence of each of several checks
    order_statistics      quantiles, their intervals, and tolerance bounds
    survival_curves       survival curves of censored lives
    tails                 heaviness of the tails of an output, and thus the moments that exist
    uncertainty_exponent  the uncertainty exponent of the boundary between basins
    variance_components   shares of the variance of nested rows
    importance_weights    importance weights
    moments               mean and standard deviation with their intervals, where they exist
    weighted_means        weighted means of numbers between 0 and 1, with intervals
    counting              counts of ended units
"""
