"""A study file bound to its model, checked, and its rows, drawn and evaluated.

Reading order; each part imports only those above it:

    changes           changes of a parsed study file, each named by the place of its entry
    checks            semantic validation of a study file against its model and its design
    sources           source files of a model's module, and of the modules that it imports
    file              schema of a study file: its tables and keys, independent of the model
    evaluate          evaluation of a chunk of rows by the batch function of a model
    provenance        provenance of a result
    compiled_cache    numba's cache on disk
    model_files       user files that define a model
    reading           parser of a study file
    installed_models  installed models, found through entry points, and a hash of their code
    input_checks      consistency checks of inputs with each other
    schema            JSON Schema of a study file, for editors
    definition        study
    template          template of a study file for a model, and variants of a study
    hints             hints on intervals, indices and bounds that a study cannot give
    row_sampling      rows of a study
"""
