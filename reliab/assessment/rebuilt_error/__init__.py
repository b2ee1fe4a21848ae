"""The error of a test, rebuilt from its own command and measured displacement (plain arrays, SI units).

The error e = x_c − x_I of a hybrid test obeys the whole structure's own equation of motion, driven only
by the restoring force that was wrong: M e'' + C e' + K e = γ(Z x_c − f), e'' + 2ξω₀e' + ω₀²e = αω₀²(x_c −
x_m) for one degree of freedom, and x_m − x_I = e − (x_c − x_m). Start with :func:`rebuild`::

    error = rebuild(command, measured, time_step, structure, tolerances=Tolerances(frequency=0.01))
    error.rms.value, error.rms.low, error.rms.high      RMS^R and its 90 % interval; error.mte likewise
    error.probability(threshold, metric)                P(error < threshold), capped by the draws
    error.error, error.smooth_error, error.reference    x_m − x_I and x_I [m], shape (n,)
    error.low, error.high                               90 % band of x_m − x_I [m], shape (n,)
    error.parts()                                       Parts: gain, delay, first, by_name[...] with share,
                                                        rms, remaining_rms, remaining_mte, history;
                                                        over_time(...), over_frequency(...)
    error.widenings(metric)                             what widens the interval, widest first
    error.start.offset, error.noise.white               the sensor's offset and noise [m]

`structure` is a :class:`~reliab.structures.structure.Structure` (one degree of freedom, share α) or a
:class:`~reliab.structures.partition.Partition` (matrices M, C, K with an interface and a linear specimen).
Further tools:

- :func:`examine_specimen`: whether the force shows a nonlinear specimen;
- :func:`rebuild_with_specimen`: the error of a test whose specimen is nonlinear and has a calibrated model;
- `reliab.assessment.monitor.Monitor`: the same numbers while the test runs, and the damping that the
  actuator leaves.

What is assumed: the structure is linear with the stated properties (or its specimen has a model), the command
solves its equation of motion, and the fed-back force is that of the piston's true displacement, without the
sensor's noise and offset. An offset that the sensor shows before the test moves is the sensor's and is taken
away; `sensor_offset=0.0` says that the loop felt it. A sensor with a wrong scale, a channel that is shifted
in time, or a force that is fed back late looks exactly like an actuator error: state a tolerance for each,
and the interval includes it.
"""
