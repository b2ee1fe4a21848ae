"""Comparison of the rebuilt error with criteria, on the same simulated tests.

Each test is a closed loop that is marched in time with its actuator (gain and delay, lag, second order,
drift, rate limit, backlash, saturation, a compensator that overcorrects) or with a nonlinear specimen; its
reference is the same loop with a perfect actuator. The error of the piston's true motion against that
reference is the truth. The signals that a laboratory records (command, displacement with sensor noise, force)
are then judged twice: by the error that `reliab.assessment.rebuilt_error` computes from command and
displacement, and by A and d with equations (15) and (18), the shipped criterion and the motion's own
boundary.

The march (`reliab.simulation.hybrid_test.closed_loop.run_closed_loop`: the integral of the equation of motion
between samples with the force as the actuator gives it) shares no code with the recursion of `rebuild`, which
never sees the ground motion. `rebuild` with a model marches its own reference with the same kernels of the
specimen's force, under the demand that the recorded displacement reveals.
"""
