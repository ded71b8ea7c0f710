"""A study file bound to its model, checked, and its rows, drawn and evaluated.

Reading order; each part imports only those above it:

    checks            semantic validation of a study file against its model and its design
    sources           source files of a model's module, and of the modules that it imports
    file              schema of a study file: its tables and keys, independent of the model
    evaluate          evaluation of a chunk of rows by the batch function of a model
    provenance        processor and software versions, on which rows may depend
    compiled_cache    numba's cache on disk
    model_files       user files that define a model
    reading           parser of a study file: one error line per fault
    template          template of a study file for a model
    installed_models  installed models, found through entry points, and a hash of their code
    input_checks      consistency checks of inputs with each other
    schema            JSON Schema of a study file, for editors
    definition        a validated study: file and model; comparison of two studies
    hints             hints on intervals, indices and bounds that a study cannot give
    row_sampling      rows from the unit cube to physical inputs, reproducible to the bit
"""
