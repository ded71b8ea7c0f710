"""Years of service: bearings that age, rubber that hardens, springs that break.

Each process is so slow that the machine runs on the stable synchronous orbit of the present.

Reading order; a module imports only those above it:

    slow_states    the machine after some time in service
    steady         its synchronous running: by the averaged theory, and as a periodic orbit
    course         one machine: when its disphasing angle passes a limit
    life           n machines: their times, causes and numerical errors
"""
