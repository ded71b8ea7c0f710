"""Laws of inputs and designs of points, with the dependence between inputs.

Reading order; each part imports only those above it:

    input_faults   faults of a study file, and their error lines for the user
    unit_cube      sampling points of the unit cube
    levels         levels of nested sampling
    named_values   validation of named values for the parameters and settings of a model
    copulas        copulas of two inputs
    dependence     dependent inputs
    designs        registry of sampling designs
    law            the base class of all laws of an uncertain parameter
    data_files     columns of numbers named by a study file
    listed_values  laws of listed values: choices, integers, measured values or their histogram
    scipy_laws     continuous laws of an uncertain parameter
    laws           registry of the laws by name
    truncation     laws truncated to the bounds of their parameter
    log_sums       distribution of a sum of independent terms
"""
