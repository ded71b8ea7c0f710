"""Estimators of sensitivity indices: what each requires, and its literature.

Reading order; each part imports only those above it:

    index              kinds of indices, with an estimate for every input
    residual_variance  residual variance given one input
    polynomials        polynomials in correlated normal scores (Wick products)
    measures           given-data measures: random balance, delta, PAWN, distances
    method             a sensitivity method: its data, its required rows, its estimates
    expansions         sensitivity indices from SALib's expansions: extended FAST and HDMR
    given_data         given-data sensitivity indices from a plain sample
    groups             intervals of methods with grouped rows, and Morris' effects
    shapley            Shapley effects, which are shares of the variance that sum to 1
    first_order        first-order Sobol' indices from a plain sample, with confidence intervals
    hsic               kernel measures (HSIC): of an event, and conditional on one
    sobol              Sobol' indices of a crossed design
    methods            registry of the sensitivity methods
"""
