# The tasks of the house; `just` alone lists them.

default:
    @just --list

# lint, format, types, layers
check:
    ruff format --check .
    ruff check .
    mypy
    lint-imports

# the tests, doctests and the examples in the docs
test *args:
    pytest {{args}}

# the statistical sweeps that are too long for every run
slow *args:
    pytest -m slow {{args}}

# the documentation, warnings as errors
docs:
    sphinx-build -W --keep-going -q docs docs/_build/html

# speed and accuracy, side by side with what a user would use instead
bench:
    for script in benchmarks/*.py; do echo "== $script"; python "$script"; done
