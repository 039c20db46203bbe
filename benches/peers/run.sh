#!/bin/sh
# Run every peer and write peers.csv. Usage: ./run.sh [PYTHON]   (a Python that has SciPy; octave on PATH)
set -eu
cd "$(dirname "$0")"
python=${1:-python3}
cargo build --release --quiet
peers=$(cargo metadata --format-version 1 --no-deps | sed 's/.*"target_directory":"\([^"]*\)".*/\1/')/release/peers
"$peers" histories > histories.csv
{
    echo "# $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), one thread. Command: benches/peers/run.sh PYTHON"
    echo "# $(rustc --version | cut -d' ' -f1,2); $("$python" -c 'import scipy,sys; print("Python", sys.version.split()[0], "SciPy", scipy.__version__)'); $(octave --version | head -1)"
    echo "peer,scene,setting,max_abs_error,ns_per_update,note"
    "$peers"
    OMP_NUM_THREADS=1 "$python" peers.py histories.csv
    octave --no-gui --quiet peers.m histories.csv 2>/dev/null
} > peers.csv
