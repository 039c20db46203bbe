#!/bin/sh
# A run against programs that do less: oiiotool copies the same frames ZIP to ZIP; pfstools keeps one adapted scalar
# for the whole picture. Usage: pipeline.sh SUNGAZE FRAME.exr [COUNT]   (1080p half RGB, ZIP; Debian: openimageio-tools,
# pfstools). Prints seconds of wall clock and of processor time for all frames: of five runs in turns the one in the
# middle, of the slow ones a single run.
set -eu
sungaze=$1 frame=$2 count=${3:-48}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for i in $(seq -w 1 "$count"); do cp "$frame" "$work/f.00$i.exr"; done
cat > "$work/run.toml" <<TOML
[input]
frames = "$work/f.00##.exr"
white_cd_m2 = 3000
horizontal_fov_deg = 60
[output]
display = "none"
state = "none"
compression = "zip"
TOML
timed() {
    name=$1
    shift
    /usr/bin/time -f "$name: %e s, processor %U + %S s" "$@" > /dev/null
}
for _ in 1 2 3 4 5; do
    for model in none tracked auto; do
        timed "sungaze $model" "$sungaze" run "$work/run.toml" --set "numerics.model=$model" --out "$work/$model" \
            --overwrite --quiet 2>> "$work/$model.times"
    done
done
for model in none tracked auto; do
    grep processor "$work/$model.times" | sort -t: -k2 -g | sed -n 3p
done
timed oiiotool sh -c "for f in $work/f.*.exr; do oiiotool \$f --compression zip -o $work/copy.exr; done"
timed pfstmo_pattanaik00 \
    sh -c "pfsinexr $work/f.00%02d.exr --frames 1:$count | pfstmo_pattanaik00 -t | pfsoutexr $work/p.%04d.exr"
