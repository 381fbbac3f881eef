"""The seal of the paper's Table 1, which every showcase starts from."""

from dashpot.solids.maxwell import GeneralizedMaxwell

TABLE_1 = GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
"""Table 1 at 8 mm, N/m and s: 0.1965, 0.1175, 0.0178 N/mm, 0.0590 and 0.2922 N s/mm."""
