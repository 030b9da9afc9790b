#!/usr/bin/env bash
# Prints the figures of docs/accuracy.md for one model: what ships, or any other.
#
#   cargo build --release --workspace
#   docs/measure.sh DATA models/default.posewise OUT
#
# DATA is the data folder of docs/training.md; tables of single frames and pictures are left in OUT. Takes a quarter
# of an hour and needs ffmpeg. Programs elsewhere than in target/release: name their folder in POSEWISE_BIN.
set -euo pipefail

data=$1 model=$2 out=$3
bin=${POSEWISE_BIN:-$(dirname "$0")/../target/release}
rendered=$data/clips-rendered
mkdir -p "$out"

section() { printf '\n== %s\n' "$*"; }
# columns FILE NAME…: these columns of a table, one line per row.
columns() {
    awk -F, -v names="${*:2}" '
        NR == 1 { count = split(names, name, " "); for (i = 1; i <= NF; i++) at[$i] = i; next }
        { for (i = 1; i <= count; i++) printf "%s%s", $at[name[i]], i < count ? " " : "\n" }' "$1"
}
track() { "$bin/posewise" track "$@" --model "$model" --quiet; }
landmarks() {
    "$bin/posewise" eval landmarks --csv "$data/faces68/dev.csv" --images "$data/faces68/dev" --model "$model" "$@"
}

section "Photographs"
landmarks --per-image "$out/dev.csv"

for options in "--roll 30" "--roll 45" "--roll -45" "--gain 0.15 --noise 3" "--contrast 0.15" "--noise 25" "--noise 15" \
    "--blur 3"; do
    section "Photographs, $options"
    read -ra flags <<< "$options"
    landmarks "${flags[@]}"
done

section "Rendered clips"
all=()
for truth in "$rendered"/*.csv; do
    clip=$(basename "$truth" .csv)
    track "$rendered/$clip.mp4" --focal "$(columns "$truth" fx | sed -n 1p)" --csv "$out/$clip.csv"
    all+=(--truth "$truth" --csv "$out/$clip.csv")
done
"$bin/posewise" eval pose "${all[@]}"
"$bin/posewise" eval eyes "${all[@]}"

section "Each fifth frame as a still: true yaw to, stills in view, found"
for truth in "$rendered"/*.csv; do
    clip=$(basename "$truth" .csv)
    stills=$out/stills/$clip
    focal=$(columns "$truth" fx | sed -n 1p)
    mkdir -p "$stills"
    ffmpeg -v error -y -i "$rendered/$clip.mp4" -vf "select='not(mod(n,5))'" -fps_mode passthrough -pix_fmt gray \
        "$stills/%04d.png"
    for still in "$stills"/*.png; do
        track "$still" --focal "$focal" --csv "$out/still.csv"
        columns "$out/still.csv" success
    done > "$stills/success"
    columns "$truth" in_frame yaw | awk 'NR % 5 == 1' | paste -d' ' - "$stills/success"
done | awk '$1 >= 0.9 {
        yaw = $2 < 0 ? -$2 : $2
        band = yaw <= 15 ? 15 : yaw <= 45 ? 45 : yaw <= 60 ? 60 : yaw <= 75 ? 75 : 91
        stills[band]++; found[band] += $3
    }
    END { for (band in stills) printf "%d %d %.1f %%\n", band, stills[band], 100 * found[band] / stills[band] }' | sort -n

section "Real eyes"
"$bin/posewise-train" eyes --eyes "$data/eyes" --model "$model"

for clip in webcam-a webcam-b; do
    section "$clip"
    track "$data/clips/$clip.mp4" --csv "$out/$clip.csv"
    columns "$out/$clip.csv" success | awk '{ n += $1 } END { print n " of " NR " frames tracked" }'
    "$bin/posewise" eval jitter --csv "$out/$clip.csv" --clip "$data/clips/$clip.mp4"
    track "$data/clips/$clip.mp4" --smooth --csv "$out/$clip-smooth.csv"
    "$bin/posewise" eval jitter --csv "$out/$clip-smooth.csv"
done

section "05_fast, every n-th frame: tracked"
for n in 1 2 3 5 8; do
    ffmpeg -v error -i "$rendered/05_fast_640x480_gray.mp4" -vf "select='not(mod(n,$n))',setpts=N/FRAME_RATE/TB" -r 30 \
        -f yuv4mpegpipe -pix_fmt yuv420p - | track - --scan-budget 3000 --csv "$out/fast-$n.csv"
    columns "$out/fast-$n.csv" success | awk -v every="$n" '{ n += $1 } END { print every ": " n " of " NR }'
done

section "The face is lost and found"
"$bin/posewise" eval recovery --clip "$data/clips/webcam-a.mp4" --clip "$data/clips/webcam-b.mp4" \
    --backgrounds "$data/backgrounds" --model "$model"

section "Faceless frames"
faceless() { "$bin/posewise" eval faceless --backgrounds "$data/backgrounds" --scan-budget 3000 --model "$model" "$@"; }
faceless
faceless --gain 0.15 --noise 3
faceless --noise 25
for clip in webcam-a webcam-b; do
    faceless --after "$data/clips/$clip.mp4"
done

section "Drift"
"$bin/posewise" eval drift --clip "$rendered/04_free_640x480_color.mp4" --truth "$rendered/04_free_640x480_color.csv" \
    --model "$model"

section "07_leave in sixteen ways: tracked while nobody is there, while nine tenths of the landmarks are in view"
ways=(null hflip scale=480:360 scale=576:432 scale=704:528 crop=600:480:0:0 crop=600:480:40:0
    rotate=8*PI/180:fillcolor=gray rotate=-8*PI/180:fillcolor=gray eq=brightness=-0.2 eq=brightness=0.2
    eq=contrast=0.6 eq=gamma=0.6 eq=gamma=1.6 gblur=2 noise=alls=30:allf=t)
for way in "${ways[@]}"; do
    ffmpeg -v error -i "$rendered/07_leave_640x480_gray.mp4" -vf "$way" -pix_fmt gray -strict -1 -f yuv4mpegpipe - |
        track - --csv "$out/leave.csv"
    columns "$out/leave.csv" success | paste -d' ' <(columns "$rendered/07_leave_640x480_gray.csv" in_frame) - |
        awk -v way="$way" '$1 == 0 { gone++; wrong += $2 } $1 >= 0.9 { there++; right += $2 }
            END { printf "%d of %d, %d of %d %s\n", wrong, gone, right, there, way }'
done | awk '{ print; wrong += $1; gone += $3; right += $4; there += $6 }
    END { printf "%d of %d, %d of %d in all\n", wrong, gone, right, there }'
