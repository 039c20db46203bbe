#!/bin/sh
# Writes frame files with OpenEXR, Mitsuba, colour-science, Spectral Python, Pillow, Radiance and imageio, and checks that
# `sungaze inspect --json` reads the same out of them; that plates pass through; that PIZ is OpenEXR's to the bit; and that what is seen of spectra is what
# colour-science and Mitsuba make of them. Needs the network once; not part of the checks of every commit.
#
#   tests/interop/run.sh [VENV]
#
# VENV: a folder for the virtual environment, kept for the next time; without it, a temporary one.
# SUNGAZE: the program to check; without it, the release build.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
venv=${1:-$work/venv}
if [ ! -x "$venv/bin/python" ]; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet -r "$here/requirements.txt"
fi
if [ -z "${SUNGAZE:-}" ]; then
    cargo build --release --manifest-path "$here/../../Cargo.toml"
    SUNGAZE=$here/../../target/release/sungaze
fi
"$venv/bin/python" "$here/check.py" "$SUNGAZE" "$work"
"$venv/bin/python" "$here/plates.py" "$SUNGAZE" "$work"
"$venv/bin/python" "$here/piz.py" "$SUNGAZE" "$work"
"$venv/bin/python" "$here/light.py" "$SUNGAZE" "$work"
