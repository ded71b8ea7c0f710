"""Rods in service: what else moves their gaps, and shapes their scars, over years.

Equations, with V_i the volume worn off both bodies at site i, h_i the growth of its gap by wear:

    (1)  dV_i/dt = (1 + kappa) w,  w from k_i U_i by laws of wear; no wear while X_i <= 0
    (2)  V = B h^p, as in `models.numerics.scars`
    (3)  X_i = X_i0 + h_i + C(t) + Theta,  C(t) as in `models.numerics.gap_drift`
    (4)  X_i0 = -delta_0 for a support preloaded by delta_0 > 0, else that of the beam
    (5)  depth of the rod's scar = h_i/(1 + kappa); down to delta_ox, w is multiplied by psi_ox

U_i is the work-rate of the settled response at the gaps; Theta the offset of a state of duty.

Reading order; a module imports only those above it:

    work_maps       work-rates under a random force as functions of both gaps
    growth          the equations as kernels of the integrator of slow time
    responses       settled responses of many rods, each from the one before it
    lives           rows integrated by turns, each as far as its responses go
    shared_lives    rows that differ only in what scales their lives
    life_outputs    outputs that depend on lives
    batch           from rows of parameters to outputs
    again           the same from work-rates mapped before
"""
