"""Machines from outside: models that are not packages of models, made into a `uq.contract.Model`.

Reading order; a module imports only those above it:

    returned        what a function returns, declared or found from rows
    function        a plain function as a machine, and its model
"""
