"""A study file bound to its model, checked, and its rows, drawn and evaluated.

Reading order; each part imports only those above it:

    checks            checks of a study file against its model and its design, beyond its shape
    columns           the arrays that a model's ``batch`` must return
    sources           the source files of a module of a model
    file              the shape of a study file: its tables and keys, whatever the model
    model_files       files of a user that have a model, found by their text
    provenance        the processor and the versions that computed a result
    evaluate          one chunk of rows through a model's batch; if that fails
    compiled_cache    numba's cache on disk
    namesakes         other packages that bear the name of one of ours
    reading           from the text of a study file to its tables
    template          a study file to start from, written for one model
    installed_models  the models installed here, found through entry points
    input_checks      consistency of inputs with each other, their parameters and the design
    schema            JSON Schema of a study file, for editors
    definition        a study: a study file bound to its model, checked and frozen
    changes           differences between a study and the one for which rows were computed
    hints             hints on what a study will lack, given before any row is computed
    row_sampling      the rows of a study
"""
