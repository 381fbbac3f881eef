#!/usr/bin/env bash
# python-calamine: a clock of days in a worksheet has three types, and its day 60 is day 59 again.
#
# Expected: a column of elapsed times, one format (hh:mm:ss) and one count of days in the file,
#   comes back as one type, or at least as values that rise as the numbers in the file do.
# Happens: below 24 h the cells are times of day, a whole day is a date of 1900, the rest are dates
#   with a time. From 1440 h on they repeat: 60.5 days is the 28th of February 1900 at noon, as 59.5
#   days is, and 61 days is the 1st of March: the day that Excel has and the calendar has not. A
#   column in [h]:mm:ss comes back as durations, all of them right.
# Matters: compression stress relaxation is run for 1000 to 3000 h. The clock jumps back by a day at
#   1440 h, and of points that are further apart than a day one is a day too early, with nothing to
#   see. Format the column as [h]:mm:ss or as a number before you export.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "python-calamine==0.9.1" "openpyxl==3.1.5"
cd "$folder"
venv/bin/python - <<'PYTHON'
from importlib.metadata import version

import openpyxl
import python_calamine

days = [0.5, 1.0, 1.5, 59.0, 59.5, 60.0, 60.5, 61.0, 61.5]
book = openpyxl.Workbook()
for column, form in enumerate(("hh:mm:ss", "[h]:mm:ss"), 1):
    for row, value in enumerate(days, 1):
        book.active.cell(row, column, value).number_format = form
book.save("clock.xlsx")
print("python-calamine", version("python-calamine"), "openpyxl", openpyxl.__version__)
rows = python_calamine.CalamineWorkbook.from_path("clock.xlsx").get_sheet_by_index(0).to_python()
for value, (clock, duration) in zip(days, rows):
    print(f"{24 * value:6g} h   {type(clock).__name__:8} {clock!s:20} {type(duration).__name__} {duration}")
clocks, durations = zip(*rows)
assert [type(clock).__name__ for clock in clocks[:3]] == ["time", "date", "datetime"]
assert clocks[3:5] == clocks[5:7]
assert [duration.total_seconds() / 86400 for duration in durations] == days
PYTHON
