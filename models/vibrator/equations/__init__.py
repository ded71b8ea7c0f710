"""The equations of motion, for one machine or for all lanes at once.

Read `system`, the constants; `rigid`, motors bolted to the body, and `rigid_motion`, the same for a
state; then `general`, with exact kinematics, mounts and feed, on its `geometry` and `mass_matrix`.
`rigid_derivatives` are for Newton's method; `time_scales` bound steps and waits.
"""
