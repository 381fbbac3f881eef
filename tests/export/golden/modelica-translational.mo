// dashpot 0.1.0: Modelica model of springs and dampers
// USE: From 0.004 to 0.32 Hz the stiffness is known to +/-0.12 %, the loss factor to +/-0.47 %. Outside this band a linear seal is assumed: add a hammer test.
// UNITS: mm-t-s: mm, t, s, N, MPa; frequency in Hz
// model: k_inf = 0.1965 N/mm
//   k_inf is at most 0.1967 N/mm; the tests give no lower limit
//   arm 1: k = 0.1175 N/mm, tau = 0.5021276596 s, b = 0.059 N s/mm
//   arm 2: k = 0.0178 N/mm, tau = 16.41573034 s, b = 0.2922 N s/mm
// temperature: 296.15 K (23 degC)
// contact length: 100 mm
// fit: f461af37467c50f8
// source: seal_8mm.csv sha256 2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae
// valid band: 0.004 to 0.32 Hz; values outside are EXTRAPOLATED from the fitted arms
// not solver-verified: read only. pymoca 0.12 flattens such a model in dashpot's tests, with Spring and Damper as the Modelica Standard Library defines them, to the stiffness of the solid
// connect the flanges; the dampers rest as long as nothing moves: start there, or
// initialise their s_rel, of which each arm has one
model ViscoelasticMount "springs and dampers of a seal"
  parameter Real k_inf(unit="N/mm", min=0.0) = 0.1965 "equilibrium stiffness";
  parameter Real k_1(unit="N/mm", min=0.0) = 0.1175 "stiffness of arm 1";
  parameter Real tau_1(unit="s", min=0.0) = 0.5021276596 "relaxation time of arm 1";
  parameter Real k_2(unit="N/mm", min=0.0) = 0.0178 "stiffness of arm 2";
  parameter Real tau_2(unit="s", min=0.0) = 16.41573034 "relaxation time of arm 2";
  Modelica.Mechanics.Translational.Interfaces.Flange_a flange_a "ground side";
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_b "moving side";
  Modelica.Mechanics.Translational.Components.Spring spring(c=1000.0*k_inf);
  Modelica.Mechanics.Translational.Components.Spring spring_1(c=1000.0*k_1);
  Modelica.Mechanics.Translational.Components.Damper damper_1(d=1000.0*k_1*tau_1);
  Modelica.Mechanics.Translational.Components.Spring spring_2(c=1000.0*k_2);
  Modelica.Mechanics.Translational.Components.Damper damper_2(d=1000.0*k_2*tau_2);
equation
  connect(flange_a, spring.flange_a);
  connect(spring.flange_b, flange_b);
  connect(flange_a, damper_1.flange_a);
  connect(damper_1.flange_b, spring_1.flange_a);
  connect(spring_1.flange_b, flange_b);
  connect(flange_a, damper_2.flange_a);
  connect(damper_2.flange_b, spring_2.flange_a);
  connect(spring_2.flange_b, flange_b);
end ViscoelasticMount;
