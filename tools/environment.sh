#!/usr/bin/env bash
# Makes .venv hold exactly what a lock says, and the project itself; does nothing, at once and offline, when it
# already does.  Usage: tools/environment.sh run|dev       (PYTHON=... chooses the interpreter)
#
# A fresh Debian has neither python3-venv (so no ensurepip) nor a pip that may write outside a virtual
# environment.  So the environment is made without pip, and the system's pip is told to fill it; the lock
# holds a pip of its own, which is there from then on.
set -euo pipefail
cd "$(dirname "$0")/.."
export PYTHONDONTWRITEBYTECODE=  # else each start of pip takes seconds
kind=${1:?run or dev}
say() { echo "shadowcull: $*" >&2; }

suitable() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; }

pick_python() {
    if [[ -n ${PYTHON:-} ]]; then
        suitable "$PYTHON" && { echo "$PYTHON"; return; }
        say "PYTHON=$PYTHON is not a working Python 3.11, 3.12 or 3.13"
        return 1
    fi
    local candidate
    for candidate in python3 python3.13 python3.12 python3.11 /usr/bin/python3; do
        suitable "$candidate" && { echo "$candidate"; return; }
    done
    say "needs Python 3.11, 3.12 or 3.13, and finds none: install python3, or name one with 'make PYTHON=/path/to/python3.12 ...'"
    return 1
}

# What an environment was made from: it is remade or refilled when any of this changes, the folder included,
# since an environment that was moved along with its folder has scripts that point to the old place.
fingerprint() { { cat "tools/$1.lock" pyproject.toml tools/environment.sh; pwd -P; } | sha256sum | cut -d' ' -f1; }
stamp() { echo ".venv/.$1.stamp"; }
current() { [[ -f $(stamp "$1") && $(<"$(stamp "$1")") == "$(fingerprint "$1")" ]]; }

ready() { suitable .venv/bin/python && { current dev || { [[ $kind == run ]] && current run; }; }; }

ready && exit 0

# One at a time: two makes in one folder would fill the same environment at once.
mkdir -p .cache
exec 9>.cache/environment.lock
flock 9
ready && exit 0

wanted=${PYTHON:-}
if [[ -e .venv ]] && ! suitable .venv/bin/python; then
    say "remaking .venv, whose Python has gone"
    rm -rf .venv
fi
if [[ ! -e .venv ]]; then
    python=$(pick_python)
    say "making .venv with $("$python" --version) ($(command -v "$python"))"
    "$python" -m venv --without-pip .venv
fi

# Settings of a user's pip that would send packages elsewhere.
export PIP_USER=0 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_REQUIRE_VIRTUALENV=0
unset PIP_TARGET PIP_PREFIX PIP_ROOT
pip=()
for candidate in .venv/bin/python "${wanted:-python3}" python3 /usr/bin/python3 "$(.venv/bin/python -c 'import sys; print(sys._base_executable)')"; do
    if "$candidate" -m pip --python .venv/bin/python --version >/dev/null 2>&1; then
        pip=("$candidate" -m pip --python .venv/bin/python)
        break
    fi
done
if ((${#pip[@]} == 0)); then
    if ! .venv/bin/python -m ensurepip >/dev/null 2>&1; then
        say "needs pip 22.3 or newer, and finds none: install python3-pip (or python3-venv)"
        exit 1
    fi
    pip=(.venv/bin/python -m pip)
fi

say "installing the packages of tools/$kind.lock into .venv (once)"
# Python compiles a module when it is first imported: most of these packages' modules never are.
quiet=(--quiet --no-input)
[[ -t 2 ]] && quiet=(--no-input)
pip_install() { "${pip[@]}" install "$@" --no-compile --only-binary :all: --require-hashes; }

# uv does in seconds what takes pip a minute.  Where the lock has none, or pip is set up with another index, pip does it,
# as it does what uv could not.  Like pip, it trusts whom the system trusts: without that, a proxy's certificate ends it.
install_by_uv() {
    grep -q '^uv==' "tools/$kind.lock" && [[ -z ${PIP_INDEX_URL:-$("${pip[@]}" config get global.index-url 2>/dev/null)} ]] || return
    sed -n '/^uv==/,/[^\\]$/p' "tools/$kind.lock" >.cache/uv.lock
    pip_install --quiet --no-input --no-deps -r .cache/uv.lock &&
        .venv/bin/python -m uv pip install --no-config --system-certs --quiet --python .venv/bin/python --only-binary :all: \
            --require-hashes -r "tools/$kind.lock"
}

if ! install_by_uv 2>.cache/uv.log && ! pip_install "${quiet[@]}" -r "tools/$kind.lock"; then
    say "the packages could not be installed (pip's message is above); the first run needs the network"
    exit 1
fi
.venv/bin/python -m pip install --quiet --no-input --no-deps --no-build-isolation --no-index --editable .
fingerprint "$kind" >"$(stamp "$kind")"
