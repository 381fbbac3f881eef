"""The table of crafted files: what each holds, and what must come of it; one line adds a row."""

from kit.crafted.broken import BROKEN
from kit.crafted.clocks import CLOCKS
from kit.crafted.columns import COLUMNS
from kit.crafted.containers import CONTAINERS
from kit.crafted.dialects import DIALECTS
from kit.crafted.exotic_units import EXOTIC_UNITS
from kit.crafted.exports import EXPORTS
from kit.crafted.layouts import LAYOUTS
from kit.crafted.makers import MAKERS
from kit.crafted.other_habits import OTHER_HABITS
from kit.crafted.quirks import QUIRKS
from kit.crafted.row import Row
from kit.crafted.sheets import SHEETS
from kit.crafted.small_makers import SMALL_MAKERS
from kit.crafted.specimens import SPECIMENS
from kit.crafted.treacherous import TREACHEROUS
from kit.crafted.two_rates import TWO_RATES

TABLE: tuple[Row, ...] = (
    *DIALECTS,
    *MAKERS,
    *OTHER_HABITS,
    *SMALL_MAKERS,
    *EXPORTS,
    *QUIRKS,
    *LAYOUTS,
    *COLUMNS,
    *CLOCKS,
    *SHEETS,
    *BROKEN,
    *SPECIMENS,
    *CONTAINERS,
    *TWO_RATES,
    *EXOTIC_UNITS,
    *TREACHEROUS,
)
