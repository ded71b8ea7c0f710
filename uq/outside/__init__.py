"""Machines from outside: models that are not packages of models, made into a `uq.contract.Model`.

Reading order; a module imports only those above it:

    returned        what a function returns, declared or found from rows
    row_by_row      a batch that computes rows one after the other
    compiled        one that numba has compiled: a loop over rows
    function        a plain function as a machine, and its model
    machine_tables  machine files in TOML, read and checked
    machine_file    a program, its input and its results, described in TOML
    results_of_programs  what a program has written
    folders         a folder for each row, kept when it failed
    descendants     processes that a program leaves behind
    program         a program as a machine, and its model
    fmu_file        an FMU and what is made of its variables, described in TOML
    fmu_said        what an FMU says of itself
    fmu             an FMU as a machine, and its model
    machine         a machine file of either kind, or an FMU
    um_bridge       the protocol by which servers of models are asked
    server          a model on a server as a machine
    offered         answers of a model to the questions of that protocol
    serving         a model offered to others over HTTP
"""
