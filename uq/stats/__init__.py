"""Statistics of plain arrays: estimates, intervals, order statistics, Kaplan-Meier, weights.

Reading order; each part imports only those above it:

    clusters              several rows per independent sample, or jointly weighted rows
    estimate              a number with its confidence interval, or the reason why it is missing
    quantile_functions    quantile functions of the normal, Student and binomial laws
    roots                 roots of a function of one variable
    jumps                 error of a mean from discontinuities in stratified designs
    location_scale        maximum likelihood for censored Weibull and lognormal lives
    estimate_json         estimates as JSON, null where a number is not finite
    two_samples           difference and ratio of two estimates
    intervals             confidence intervals of means and proportions, 95 % by default
    control_variate       estimates corrected by a correlated quantity of known mean
    group_sequential      the level of each interim check that preserves coverage
    order_statistics      sample quantiles, their confidence intervals, and tolerance bounds
    survival_curves       Kaplan-Meier estimate, pointwise bounds, simultaneous band
    tails                 tail index of an output, which determines the moments that exist
    uncertainty_exponent  uncertainty exponent of a basin boundary
    variance_components   shares of samples, units within them, repeats within these
    importance_weights    Pareto-smoothed importance weights and their reliability diagnostics
    moments               mean and standard deviation with confidence intervals
    weighted_means        weighted means of numbers between 0 and 1, with confidence intervals
    counting              numbers of failed units, and bounds on the mixing distribution
"""
