"""Statistics of plain arrays: estimates, intervals, order statistics, Kaplan-Meier, weights.

Reading order; each part imports only those above it:

    estimate              estimate; differences and ratios of two
    quantile_functions    quantile functions of the normal, Student; roots
    jumps                 error of a mean from discontinuities in stratified designs
    dependent_rows        dependence between rows: replicates, several rows per sample, a shared law
    location_scale        maximum likelihood for censored Weibull and lognormal lives
    estimate_json         estimates as JSON
    intervals             confidence intervals of means and proportions, 95 % by default
    control_variate       control variates
    group_sequential      group-sequential confidence levels
    order_statistics      sample quantiles, their confidence intervals, and tolerance bounds
    survival_curves       survival curves of censored lives, cumulative incidence by cause
    interval_censoring    nonparametric likelihood of lives known within intervals, with late entry
    life_likelihood       maximum likelihood for laws of lives, profile-likelihood intervals
    tails                 tail index of an output, which determines the moments that exist
    uncertainty_exponent  uncertainty exponent of a basin boundary
    variance_components   variance components of nested rows
    regressions           regressions on inputs by OpenTURNS: polynomial chaos, Gaussian process
    importance_weights    pareto-smoothed importance weights and their reliability diagnostics
    moments               mean and standard deviation with confidence intervals
    weighted_means        weighted means of numbers between 0 and 1, with confidence intervals
    counting              counts of failed units
"""
