"""The paper, reproduced: its equations as printed, its figures, its table, each beside dashpot."""
