"""The rod as one oscillator per mode, and the load on it.

Reading order; a module imports only those above it:

    finite_element     frequencies and tip values of the modes
    random_lines       the random force as a sum of lines
    random_response    the steady response to it
    random_load        its lines for a given beam, and the length of their epochs
    modal              the equations of motion, and rows of parameters as beams in modal form
    propagation        the interface and the record of their propagators
"""
