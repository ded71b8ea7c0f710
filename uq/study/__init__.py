"""A study file bound to its model, checked, and its rows, drawn and evaluated.

Reading order; each part imports only those above it:

    file              the shape of a study file: its tables and keys, whatever the model
    checks            what a study file asks of its model and of its design, beyond its shape
    model_files       files of a user that have a model, found by their text
    sources           the source files of a module of a model
    columns           the arrays that a model's ``batch`` must return
    provenance        the processor and the versions that computed a result
    reading           from the text of a study file to its tables
    template          a study file to start from, written for one model
    namesakes         other packages that bear the name of one of ours
    compiled_cache    numba's cache on disk
    evaluate          one chunk of rows through a model's batch; if that fails
    input_checks      whether the inputs suit each other, their parameters and the design
    installed_models  the models installed here, found through entry points
    definition        a study: a study file bound to its model, checked and frozen
    schema            JSON Schema of a study file, for editors
    changes           what differs between a study and the one for which rows were computed
    hints             what a study will lack, as far as it shows before any row is computed
    row_sampling      the rows of a study
"""
