"""Draw the pictures of the README: the paper's result on the simulated broad seal."""

from pathlib import Path

import dashpot as dp
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.table_1 import BROAD, BROAD_MASS

FOLDER = Path(__file__).parent / "pictures"


def main() -> None:
    """Run the whole story and save its picture."""
    bench = simulate_relaxation(BROAD, seed=0)
    hammer = simulate_impact(BROAD, mass=BROAD_MASS, seed=0)
    frf = dp.estimate_frf(hammer.test, mass=BROAD_MASS)
    study = dp.characterise(
        bench.test, frf, impact=hammer.test, mass=BROAD_MASS, seals=2, arms=2, band=(4.0, 40.0)
    )
    FOLDER.mkdir(exist_ok=True)
    dp.plot.save(dp.plot.hero(study), FOLDER / "hero.png")


if __name__ == "__main__":
    main()
