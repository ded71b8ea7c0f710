"""The equations of motion, of one machine or of many.

Reading order; a module imports only those above it:

    rigid                motors bolted to the body, no feed: constants and accelerations
    rigid_derivatives    and the derivatives of these
    rigid_motion         the same for a state
    system               the constants of any machine
    geometry             exact kinematics, mounts and feed: where everything is
    mass_matrix          and how it resists
    general              and how it moves
    time_scales          bounds of steps and waits
"""
