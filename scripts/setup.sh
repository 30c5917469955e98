# Shared by the scripts here, which source it: goes to the project's folder, and installs what is
# missing. With everything there it takes a fraction of a second and needs no network.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# What a build needs (Debian 12).
BUILD_PACKAGES=(gcc libc6-dev pkg-config libclang-dev libsundials-dev libhdf5-dev)

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

# Debian packages, by name.
need_packages() {
    local package missing=()
    if ! command -v dpkg-query >/dev/null; then
        echo "setup: not a Debian system; these packages are taken to be there: $*" >&2
        return
    fi
    for package in "$@"; do
        dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed ||
            missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    echo "setup: installing ${missing[*]}" >&2
    as_root apt-get -qq update </dev/null
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends \
        -o DPkg::Lock::Timeout=300 install "${missing[@]}" </dev/null >/dev/null
}

# The toolchain, with the components named.
need_rust() {
    local component
    command -v cargo >/dev/null || PATH="$HOME/.cargo/bin:$PATH"
    if ! command -v cargo >/dev/null; then
        echo "setup: there is no Rust toolchain; https://rustup.rs tells how to install it" >&2
        exit 1
    fi
    for component in "$@"; do
        if ! cargo "${component/rustfmt/fmt}" --version >/dev/null 2>&1; then
            echo "setup: installing $component" >&2
            rustup component add "$component" </dev/null >&2
        fi
    done
    # .cargo/config.toml names the folder of the commonest machines
    if [ -z "${HDF5_DIR:-}" ] && [ "$(uname -m)" != x86_64 ]; then
        export HDF5_DIR="/usr/lib/$(gcc -print-multiarch)/hdf5/serial"
    fi
}

# The Python packages of requirements.txt, in .venv.
need_python() {
    python_is_ready && return
    echo "setup: installing into .venv: $(paste -sd ' ' scripts/requirements.txt)" >&2
    .venv/bin/python -m pip --version >/dev/null 2>&1 || python3 -m venv --clear .venv
    .venv/bin/python -m pip install --quiet --disable-pip-version-check \
        --requirement scripts/requirements.txt </dev/null >&2
}

# Node and the driver of the browser tests, in tests/browser.
need_browser_driver() {
    command -v node >/dev/null && command -v npm >/dev/null || need_packages nodejs npm
    (
        cd tests/browser
        npm ls --silent >/dev/null 2>&1 && exit
        echo "setup: installing into tests/browser/node_modules: playwright-core" >&2
        npm ci --silent --no-audit --no-fund </dev/null >&2
    )
}

# Whether .venv holds each package in the version wanted.
python_is_ready() {
    [ -x .venv/bin/python ] && .venv/bin/python - 2>/dev/null <<'PYTHON'
from importlib.metadata import version
for line in open("scripts/requirements.txt"):
    name, wanted = line.strip().split("==")
    if version(name) != wanted:
        raise SystemExit(1)
PYTHON
}
