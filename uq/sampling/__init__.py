"""Laws of inputs and designs of points: what is uncertain, how inputs depend, which points.

Reading order; each part imports only those above it:

    input_faults   faults of a study file, and their error lines for the user
    unit_cube      points of the unit cube: random, stratified, low-discrepancy
    levels         levels of nested sampling: rows of a sample that share an input
    named_values   validation of named values for the parameters and settings of a model
    dependence     Gaussian copula, and conditional draws given some inputs
    designs        registry of designs: how each draws its points and groups its rows
    law            the base class of all laws of an uncertain parameter
    data_files     columns of numbers named by a study file, kept in its text
    listed_values  laws of listed values: choices, integers, measured values or their histogram
    scipy_laws     continuous laws of an uncertain parameter
    laws           registry of the laws by name
    truncation     laws within bounds: quantiles, probabilities, density
    log_sums       distribution of a sum of independent terms
"""
