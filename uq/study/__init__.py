"""A study file bound to its model, checked, and its rows, drawn and evaluated.

Reading order; each part imports only those above it:

    checks            checks of a study file against its model and its design, beyond its shape
    sources           the source files of a module of a model
    file              the shape of a study file: its tables and keys, whatever the model
    evaluate          evaluation of one chunk of rows through a model's batch
    provenance        the processor and the versions that computed a result
    compiled_cache    numba's cache on disk
    model_files       files of a user that have a model
    reading           from the text of a study file to its tables
    template          a study file to start from, written for one model
    installed_models  the models installed here, found through entry points
    input_checks      consistency of inputs with each other, their parameters and the design
    schema            JSON Schema of a study file, for editors
    definition        study
    hints             hints on intervals, indices and bounds that a study will not give
    row_sampling      the rows of a study
"""
