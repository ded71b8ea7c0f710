"""Estimators of sensitivity indices: what each requires, and its literature.

Reading order; each part imports only those above it:

    sample             what a sensitivity method works on: one output and the rows of its design
    index              the results of a sensitivity method
    polynomials        polynomials in correlated normal scores
    residual_variance  the variance that remains when one input is known
    slices             slices of an input: rows with neighbouring values, or with the same one
    method             a sensitivity method
    hdmr               sensitivity from an expansion in functions of one and of two inputs
    fast               extended FAST
    paths              parts of the variance that paths show
    measures           measures of how an output follows each input
    given_data         sensitivity from a plain sample
    quantile_oriented  quantile-oriented indices: how much knowing an input sharpens a quantile
    shapley            Shapley effects
    hsic               dependence measured by kernels
    morris             Morris' elementary effects: which inputs matter at all, from few rows
    first_order        first-order indices from a plain sample, with intervals
    sobol              Sobol' indices of a crossed design, with intervals from the replicates
    methods            the sensitivity methods by name, and which of them a design feeds
"""
