"""Models from outside: functions, programs, servers, FMUs, emulators as `uq.contract.Model`.

Reading order; each part imports only those above it:

    queue_table      the table ``[queue]`` of a machine file
    compilation      detect compilation by numba, which may take a while
    returned         outputs of a function
    row_resources    resources of a row of a program
    study_defaults   what a machine proposes to a new study of it
    row_by_row       rows computed one after the other by a function of numbers that returns a
    um_bridge        the protocol of UM-Bridge models [1]_
    function         plain function as a machine, row by row or compiled by numba
    machine_file     a machine file: a program, its input and its results, described in TOML
    server           a model on a UM-Bridge server as a machine: each row is a separate call
    serving          server that offers a model by the protocol of UM-Bridge
    fmu_description  description of an FMU [1]_, read by FMPy
    program_outputs  outputs of a program
    fmu              an FMU as a machine: each row simulates a separate instance
    program          program as a machine: each row is computed in a separate folder
    emulator         an emulator as a machine: outputs predicted by regressions
"""
