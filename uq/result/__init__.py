"""The file of a result and its elements, weights, and rows that belong together.

Reading order; each part imports only those above it:

    element      one element of an output: one plain array, with the outcome of every row
    nesting      samples, units and repeats
    variables    the variables of a result and their attributes
    one_row      one row of a model as plain numbers, without a Dataset
    weights      rows that inspections have weighted
    soundness    checks of a Dataset that may be damaged or come from an untrusted file
    result_file  the schema of a result
    elements     the elements of a result's outputs
    workload     rows of one model that are to be computed, and a preview of them as they arrive
    result       a result
    row_choice   choice of a row of a result, and this row as plain numbers
"""
