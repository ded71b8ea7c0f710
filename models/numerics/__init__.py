"""Numerical methods that machines share; nothing here depends on a machine.

Reading order; a module imports only those above it:

    propagator      the interface of everything that advances machines in time
    environment     the instruction set for which kernels are compiled
    cache           where compiled code is kept
    jit             how kernels are compiled
    fma             fused multiply-add where the source says so
    blocks          lanes: systems that advance together, and their memory
    sincos          sine and cosine without branches
    elementary      elementary functions of arrays, with the same bits on every processor
    uniforms        random numbers by seed and number
    fourier         the discrete Fourier transform, with the same bits on every processor
    linear          many small linear systems
    symmetric       eigenvalues of many symmetric matrices
    multipliers     the largest multiplier of many linear maps
    exponents       Lyapunov exponents
    batch_means     time means and their ratios, with errors
    block_maxima    largest values over a time, and how they grow with it
    events          event location within a step
    series          sums over power series of many systems
    tableaux        coefficients of the Runge-Kutta methods
    nystrom         any tableau for q'' = f(q, q'), many systems, fixed steps
    dop853_step     order 8(5,3), one system: a step
    dop853          the same over any time, through guarded modes
    slow_step       a step of quantities that wear, by Heun's method
    slow_time       the same over any time, with duty states, gaps that open or close, and events
    keys            refusal of keys that a table cannot have
    scars           volumes of wear scars by their depths, and the inverse
    gap_drift       growth of a gap by itself: creep, relaxation, swelling, a history
    wear_laws       rates of wear by work-rate, time, depth and volume
    duty            states of operation, mixed or in sequence
    newton          damped Newton's method
    continuation    branches of solutions, through folds
"""

from models.numerics.environment import prepare

prepare()  # numba, which the modules import, reads it only once
