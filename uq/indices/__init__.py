"""Estimators of sensitivity indices: what each requires, and its literature.

Reading order; each part imports only those above it:

    index              the results of a sensitivity method
    sample             the data of a sensitivity method: one output and the rows of its design
    residual_variance  the variance that remains when one input is known
    polynomials        polynomials in correlated normal scores
    fast               extended FAST
    groups             intervals of methods whose rows come in groups
    hdmr               sensitivity from an expansion in functions of one and of two inputs
    method             a sensitivity method
    slices             slices of an input: rows with neighbouring values, or with the same one
    paths              parts of the variance estimated from paths
    morris             Morris' elementary effects: which inputs matter at all, from few rows
    sobol              Sobol' indices of a crossed design, with intervals from the replicates
    given_data         sensitivity from a plain sample
    measures           measures of how an output follows each input
    quantile_oriented  quantile-oriented indices: how much knowing an input sharpens a quantile
    shapley            Shapley effects
    first_order        first-order indices from a plain sample, with intervals
    hsic               kernel measures of dependence (HSIC)
    methods            the sensitivity methods by name, and which of them a design feeds
"""
