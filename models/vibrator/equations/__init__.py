"""The equations of motion, of one machine or of many.

Reading order; a module imports only those above it:

    rigid           motors bolted to the body, no feed: constants and accelerations
    rigid_motion    accelerations of a state
    system          the constants of any machine
    geometry        exact kinematics of body, motor set and unbalanced masses
    mass_matrix     mass matrix of the general machine
    general         accelerations with exact kinematics, mounts and feed
    time_scales     bounds of steps and waiting times
"""
