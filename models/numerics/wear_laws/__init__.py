"""Laws of wear: how the volume worn off depends on work-rate, time, depth and volume.

By Archard's law the rod loses the volume k U per time. Each law here changes this rate.

Reading order; a module imports only those above it:

    law             what a law declares
    power           an exponent and a threshold of the work-rate
    running_in      a rate that changes as the scar grows
    edf             a power of the work-rate that tends to a given rate in time
    laws            all of them, by name, and their values as numbers
    worn            the rate of wear by a law
"""
