"""The averaged theory: at which angle and speed the vibrators run together.

Reading order; a module imports only those above it:

    feed              the mass that a feed thrown by the deck adds to it
    linear_machine    what the response of a machine needs
    receptance        how it moves when its vibrators turn at one speed
    balance           torques of motors and of the shaking body
    averaged          the speed and the angle at which they balance
"""
