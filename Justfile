# The tasks of the house; `just` alone lists them.

# .venv/bin/just finds its tools beside it: no environment needs to be activated
tools := parent_directory(just_executable())
separator := if os() == "windows" { ";" } else { ":" }
export PATH := if path_exists(tools / "ruff") == "true" { tools + separator + env("PATH") } else { env("PATH") }

default:
    @just --list

# lint, format, types, layers
check: scripts
    ruff format --check .
    ruff check .
    mypy
    lint-imports

# format, lint and types of the scripts of app and report
scripts:
    #!/usr/bin/env bash
    set -euo pipefail
    command -v deno >/dev/null || { echo "no deno here: the scripts are not checked (pip install deno)"; exit 0; }
    export NO_COLOR=1 DENO_NO_UPDATE_CHECK=1
    mapfile -t scripts < <(git ls-files -co --exclude-standard 'src/*.js')
    deno fmt --check "${scripts[@]}"
    deno lint "${scripts[@]}"
    deno check -q "${scripts[@]}"

# the tests, doctests and the examples in the docs
test *args:
    pytest {{args}}

# figures of the structure: names, tokens, files that fit and report run, imports of extensions
structure *args:
    python tests/kit/structure.py {{args}}

# README's two set-up lines, in a fresh clone and an empty environment; one of them: main or tests
readme which="all":
    .ci/readme {{which}}

# the statistical sweeps that are too long for every run
slow *args:
    pytest -m slow {{args}}

# what the gate leaves out: studies, mutants, every test on other versions and of the wheel; docs/quality.md
nightly:
    #!/usr/bin/env bash
    set -uo pipefail
    folder="$(mktemp -d)"
    trap 'rm -rf "$folder"' EXIT
    night="$folder/night"
    export HYPOTHESIS_PROFILE=night
    failed=0
    mkdir -p "$night"
    just readme > "$night/readme.txt" || failed=1
    pytest -q -m slow --junitxml "$night/slow.xml" || failed=1
    DASHPOT_FUZZ=1 pytest -q -m fuzz --junitxml "$night/fuzz.xml" || failed=1
    just release || failed=1
    for one in lowest newest wheel; do
        .ci/environment "$one" "$folder/$one" || failed=1
        [ -x "$folder/$one/bin/pytest" ] || continue
        "$folder/$one/bin/dashpot" demo -o "$folder/demo-$one" || failed=1
        # doctests of src would be those of the working copy
        paths=(); [ "$one" = wheel ] && paths=(tests docs README.md)
        "$folder/$one/bin/pytest" -q -m "not slow and not fuzz" --junitxml "$night/$one.xml" \
            "${paths[@]}" || failed=1
    done
    python benchmarks/verdicts.py "$night/verdicts.jsonl" > "$night/verdicts.txt" || failed=1
    python benchmarks/anybody.py > "$night/speed.txt" || failed=1
    just speed "$(git rev-list -n 1 --before=7.days.ago HEAD)" > "$night/ratios.txt" || failed=1
    for study in $(python benchmarks/coverage_kinds.py --list); do
        python benchmarks/coverage_kinds.py "$study" >> "$night/coverage.txt" || failed=1
    done
    python .ci/quality.py "$night" "Commit $(git rev-parse --short HEAD)."
    exit "$failed"

# an hour guided by coverage, then mutants of every format: 100,000 of the binary ones
fuzz minutes="60" times="28" *args:
    PYTHONPATH=tests python -m kit.guided {{minutes}} .fuzz
    DASHPOT_FUZZ={{times}} pytest -m fuzz {{args}}

# the documentation, warnings as errors
docs:
    sphinx-build -W --keep-going -q docs docs/_build/html

# speed and accuracy, side by side with what a user would use instead: all in full, for hours
bench:
    #!/usr/bin/env bash
    set -uo pipefail
    failed=()
    # what has no __main__ is a part of others
    for script in $(grep -l __main__ benchmarks/*.py); do
        echo "== $script"
        python "$script" || failed+=("$script")
    done
    [ "${#failed[@]}" = 0 ] || { echo "failed: ${failed[*]}"; exit 1; }

# what public packages do with valid input that an expert would not guess: every script, or those named, a line each
findings *names:
    #!/usr/bin/env bash
    set -uo pipefail
    names=({{names}})
    [ "${#names[@]}" -gt 0 ] || for script in findings/*.sh; do names+=("$(basename "$script" .sh)"); done
    failed=0
    for name in "${names[@]}"; do
        before=$SECONDS
        if output="$(bash "findings/$name.sh" 2>&1)"; then result=unchanged; else result=changed; failed=1; fi
        printf '%-9s  %4d s  %s\n' "$result" "$((SECONDS - before))" "$name"
        [ "$result" = unchanged ] || tail -n 12 <<< "$output" | sed 's/^/           /'
    done
    exit "$failed"

# CPU time of this working copy beside an earlier commit: fails where a command takes a quarter more
speed before *args:
    #!/usr/bin/env bash
    set -euo pipefail
    folder="$(mktemp -d)"
    trap 'git worktree remove --force "$folder/tree"; rm -rf "$folder"' EXIT
    git worktree add --quiet --detach "$folder/tree" "{{before}}"
    # the version is written by the build, and a working copy has one
    cp src/dashpot/base/_version.py "$folder/tree/src/dashpot/base/"
    packages="$(python -c 'import numpy, pathlib; print(pathlib.Path(numpy.__file__).parents[1])')"
    for one in before after; do
        python -m venv --without-pip "$folder/$one"
        source="$folder/tree/src"; [ "$one" = before ] || source="$PWD/src"
        paths=("$folder/$one"/lib/python*/site-packages)
        printf '%s\n' "$source" "$packages" > "${paths[0]}/dashpot.pth"
        printf '#!%s\nimport sys\nfrom dashpot.cli import main\nsys.exit(main())\n' \
            "$folder/$one/bin/python" > "$folder/$one/bin/dashpot"
        chmod +x "$folder/$one/bin/dashpot"
    done
    python benchmarks/side_by_side.py "$folder/before" "$folder/after" --most 1.25 {{args}}

# what the gate tests, pinned: constraints.txt, and requirements.txt with the hash of every file
pins:
    python .ci/constraints.py > constraints.txt
    uv pip compile pyproject.toml --extra all -c constraints.txt --generate-hashes --universal \
        --python-version 3.11 --no-annotate --quiet --output-file requirements.txt \
        --custom-compile-command "pip install --require-hashes -r requirements.txt; just pins writes it"

# wheel, sdist and an SBOM of what was tested, in dist/
release:
    #!/usr/bin/env bash
    set -euo pipefail
    if tag="$(git describe --exact-match --match 'v*' 2>/dev/null)"; then
        grep -q "^## ${tag#v} - 20" CHANGELOG.md || { echo "CHANGELOG.md has no day of ${tag#v}"; exit 1; }
        grep -q "^version: ${tag#v}$" CITATION.cff || { echo "CITATION.cff is not of ${tag#v}"; exit 1; }
    fi
    rm -rf dist
    python -m build --outdir dist
    folder="$(mktemp -d)"
    trap 'rm -rf "$folder"' EXIT
    python -m venv --without-pip "$folder"
    wheel="$(echo dist/*.whl)"
    python -m pip --python "$folder/bin/python" install -q -c constraints.txt \
        --report "$folder/report.json" "$wheel[all]"
    sbom="${wheel%-py3-none-any.whl}"
    sed "s|^dynamic = .*|version = \"${sbom#dist/dashpot-}\"|" pyproject.toml > "$folder/pyproject.toml"
    cyclonedx-py environment --pyproject "$folder/pyproject.toml" --mc-type library \
        --output-reproducible --of JSON -o "$sbom.cdx.json" "$folder/bin/python"
    python .ci/sbom.py "$sbom.cdx.json" "$folder/report.json"
    cp requirements.txt dist
    cd dist && sha256sum -- * > SHA256SUMS
