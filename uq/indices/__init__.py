"""Estimators of sensitivity indices: what each requires, and its literature.

Reading order; each part imports only those above it:

    index              results of a sensitivity method
    residual_variance  residual variance given one input
    polynomials        polynomials in correlated normal scores (Wick products)
    measures           given-data sensitivity measures
    method             sensitivity methods
    expansions         sensitivity indices from SALib's expansions: extended FAST and HDMR
    given_data         given-data sensitivity indices from a plain sample
    groups             confidence intervals of methods with grouped rows
    shapley            Shapley effects, which are shares of the variance that sum to 1
    first_order        first-order Sobol' indices from a plain sample, with confidence intervals
    sobol              Sobol' indices of a crossed design
    methods            registry of the sensitivity methods
"""
