% dashpot 0.1.0: state space of the model: displacement x in, force F out
% USE: From 0.004 to 0.32 Hz the stiffness is known to +/-0.12 %, the loss factor to +/-0.47 %. Outside this band a linear seal is assumed: add a hammer test.
% UNITS: mm-t-s: mm, t, s, N, MPa; frequency in Hz
% model: k_inf = 0.1965 N/mm
%   k_inf is at most 0.1967 N/mm; the tests give no lower limit
%   arm 1: k = 0.1175 N/mm, tau = 0.5021276596 s, b = 0.059 N s/mm
%   arm 2: k = 0.0178 N/mm, tau = 16.41573034 s, b = 0.2922 N s/mm
% temperature: 296.15 K (23 degC)
% contact length: 100 mm
% fit: f461af37467c50f8
% source: seal_8mm.csv sha256 2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae
% valid band: 0.004 to 0.32 Hz; values outside are EXTRAPOLATED from the fitted arms
% not solver-verified: no solver of this kind runs in dashpot's tests
% dy/dt = A y + B x, F = C y + D x + E dx/dt; y is the elongation of each arm's dashpot
A = -diag([1.991525424 0.06091718001]);
B = [1.991525424; 0.06091718001];
C = -[0.1175 0.0178];
D = 0.3318;
E = 0.;
