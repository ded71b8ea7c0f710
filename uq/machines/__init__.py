"""Models from outside: functions, programs, servers and FMUs as `uq.contract.Model`.

Reading order; each part imports only those above it:

    child_processes    processes that a program leaves behind, ended with it
    compilation        notice when numba compiles, which may take a while
    returned           outputs of a function
    row_folders        folders of rows
    row_by_row         rows computed one after the other by a function of numbers that returns
    compiled_function  a function compiled by numba as a machine
    machine_file       a machine file: a program, its input and its results, described in TOML
    um_bridge          the protocol of UM-Bridge models [1]_
    json_requests      requests with JSON over HTTP
    function           a plain function as a machine
    fmu_description    description of an FMU [1]_, read by FMPy
    fmu_file           a machine file that names an FMU
    program_outputs    outputs of a program
    server             a model on a UM-Bridge server as a machine: each row is a call of its own
    serving            a model offered to others by the protocol of UM-Bridge
    fmu                an FMU as a machine: each row simulates an instance of its own
    program            a program as a machine: each row runs it once, in a folder of its own
    machine            a machine file, or an FMU, as a machine
"""
