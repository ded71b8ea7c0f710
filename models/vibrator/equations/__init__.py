"""The equations of motion, for one machine or for all lanes at once.

Read `system`, the constants; `rigid`, motors bolted to the body, and `rigid_motion`, the same for a
state; then `general`, with exact kinematics, mounts and feed. `time_scales` bounds steps and waits.
"""
