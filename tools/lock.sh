#!/usr/bin/env bash
# Writes the two locks from pyproject.toml's ranges: for every Python and platform at once, with hashes,
# from PyPI alone whatever indexes this machine is set up with.  run.lock is what the program needs (and the
# backend that installs it); dev.lock is a superset of it, for tests, lint and benchmarks.
# Usage: tools/lock.sh [PACKAGE...]   upgrades those packages, or everything when none is named.
set -euo pipefail
cd "$(dirname "$0")/.."

upgrade=(--upgrade)
if (($#)); then
    upgrade=()
    for package in "$@"; do upgrade+=(--upgrade-package "$package"); done
fi

unset UV_INDEX UV_INDEX_URL UV_DEFAULT_INDEX UV_EXTRA_INDEX_URL UV_FIND_LINKS UV_CONSTRAINT UV_OVERRIDE
compile() {
    .venv/bin/python -m uv pip compile --no-config --quiet --default-index https://pypi.org/simple \
        --universal --python-version 3.11 --generate-hashes --no-annotate \
        --custom-compile-command "make lock" pyproject.toml "$@"
}
compile "${upgrade[@]}" --group build -o tools/run.lock
compile "${upgrade[@]}" --group build --group test --group lint --group bench --group docs --group lock \
    --constraint tools/run.lock -o tools/dev.lock
echo "Wrote tools/run.lock and tools/dev.lock; 'make test' installs them."
