"""Estimators of sensitivity indices: what each requires, and its literature.

Reading order; each part imports only those above it:

    index              the results of a sensitivity method
    residual_variance  the variance that remains when one input is known
    polynomials        polynomials in correlated normal scores
    measures           measures of how an output follows each input
    method             a sensitivity method
    expansions         sensitivity from expansions by SALib: extended FAST and HDMR
    given_data         sensitivity from a plain sample
    groups             intervals of methods whose rows come in groups
    shapley            Shapley effects
    first_order        first-order indices from a plain sample, with intervals
    hsic               kernel measures of dependence (HSIC)
    sobol              Sobol' indices of a crossed design, with intervals from the replicates
    methods            the sensitivity methods by name, and which of them a design feeds
"""
