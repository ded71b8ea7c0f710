"""The file of a result and its elements, weights, and rows that belong together.

Reading order; each part imports only those above it:

    element      one element of an output: one plain array, with the outcome of every row
    nesting      nested design
    variables    the variables of a result and their attributes
    one_row      one row of a model as plain numbers, without a Dataset
    weights      posterior weights of rows: their variables in a result, and checks of them
    soundness    checks of a Dataset that may be damaged or come from an untrusted file
    result_file  the schema of a result
    life_record  lives from the field, read from CSV
    elements     the elements of a result's outputs
    workload     workload: rows of one model to compute, and running statistics of arriving rows
    result       a result: the Dataset of its rows, with its attributes parsed once
    row_table    rows of a result as one flat table, written as CSV or Parquet
    row_choice   selection of a row of a result, and its values as plain numbers
"""
