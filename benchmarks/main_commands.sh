#!/usr/bin/env bash
# The main commands and the main Python calls, in the current folder, which should be empty.
#
#   bash benchmarks/main_commands.sh "python -m dashpot" [PYTHON_CALLS]
#
# The first argument runs one command line of dashpot. The second, if there is one, runs
# benchmarks/main_calls.py. With "python -m coverage run -p --source=dashpot -m dashpot" the
# commands show which files of the core the method enters: tests/test_structure.py does so.
# Prints the exit code of every command; exit status 1 where a command failed.
set -u
read -r -a run <<<"$1"
read -r -a calls <<<"${2:-}"
here="$(cd "$(dirname "$0")" && pwd)"
mass=(--mass 114.8g --seals 2)
units=(--unit-system mm-t-s --temperature 23degC --length 50mm --allow all)
failed=0

dashpot() {
    "${run[@]}" "$@" >>output.txt 2>>messages.txt
    local code=$?
    echo "$code  dashpot $*"
    [ "$code" = 0 ] || failed=1
}

dashpot --help
dashpot --version
dashpot demo --files
dashpot inspect seal_8mm.csv hammer.csv --save lab.toml
dashpot fit seal_8mm.csv -o fit.json
dashpot fit seal_8mm.csv --arms 2 -o two.html
dashpot fit seal_8mm.csv --method hold --arms 2 --json
dashpot fit seal_8mm.csv --elastic nonlinear
dashpot fit seal_8mm.csv --model fractional -o fractional.json
dashpot fit hammer.csv -o frf.csv --json
dashpot fit seal_8mm.csv hammer.csv "${mass[@]}" -o joint.json
dashpot predict fit.json "${mass[@]}" -o predicted.csv
dashpot predict fit.json "${mass[@]}" -o predicted.html
dashpot compare fit.json hammer.csv "${mass[@]}" --json
dashpot compare frf.csv predicted.csv
dashpot report seal_8mm.csv hammer.csv "${mass[@]}" -o report.html
dashpot export joint.json --to nastran "${units[@]}" --band 1:20Hz -o seal.bdf
dashpot export joint.json --to abaqus "${units[@]}" -o seal.inp
dashpot export joint.json --to csv "${units[@]}" -o seal.csv
dashpot export joint.json --to statespace "${units[@]}" -o seal.m
dashpot plan --frequency 12.7Hz
dashpot simulate relaxation --seal paper -o again.csv
if [ "${#calls[@]}" != 0 ]; then
    "${calls[@]}" "$here/main_calls.py" >>output.txt 2>>messages.txt
    code=$?
    echo "$code  main_calls.py"
    [ "$code" = 0 ] || failed=1
fi
exit "$failed"
