"""The rod as one oscillator per mode, and the random load on it.

finite_element    frequencies and tip values of the modes
random_load       the random force as a sum of lines, drawn anew in each epoch
modal             rows of parameters as beams in modal form; what a propagator records
"""
