"""The built-in suite of synthetic ground motions.

The motions follow Dabaghi & Der Kiureghian (2018), a stochastic model of near-fault ground motion whose
parameters depend on magnitude, mechanism, distance, V_S30 and directivity. Its range (M 5.5 to 7.9, up to 31
km, V_S30 of 139 to 2016 m/s) holds every record of the FEMA P-695 far-field and near-field sets, soil sites
and velocity pulses included. Its parent, Rezaeian & Der Kiureghian (2010), holds for firm ground (V_S30 of
600 m/s and more) beyond 10 km only, where 4 of those 50 stations lie, and has no pulses.

Limits of the model: its noise has one dominant frequency at a time, so that spectral ordinates at periods
of 0.5 to 1.5 s are 25 to 45 % below the NGA-West2 models, while those at other periods and the peaks
agree within 30 %; and its motions last longer than the strong records that FEMA P-695 picked.

The steps: `fema_p695_2009` draws an earthquake and its station, `dabaghi_der_kiureghian_2018` predicts the
parameters and gives them their distributions, `recording` makes the motion and cleans it, and `suite`
scatters the parameters about the regression and names the result.
"""
