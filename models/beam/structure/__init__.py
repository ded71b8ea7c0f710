"""The rod as one oscillator per mode, and the load on it.

Reading order; a module imports only those above it:

    finite_element     frequencies and tip values of the modes
    interpolation      a signal between its samples
    random_noise       white Gaussian noise
    random_load        the random force as filtered noise, and the length of its filter
    random_response    the response of a contact-free beam to it
    modal              the equations of motion, and rows of parameters as beams in modal form
    propagation        the interface and the record of their propagators
"""
