"""The averaged theory: the angle and speed at which the vibrators run synchronously.

Reading order; a module imports only those above it:

    motor_set         the motor set, and damping by a ratio
    feed              the apparent mass of a feed thrown by the deck
    linear_machine    constants of a machine's linear response
    receptance        the response when both vibrators turn at one speed
    balance           torques of the motors and of the vibrating body
    averaged          the speed and the angle at which they balance
"""
