#!/usr/bin/env bash
# Takes the pictures of the window that README.md and docs/ show, anew:
#
#     screenshots/take.sh [INTERIOR.glb]
#
# They are taken of the release build, in the folder that this script lies in. Pictures of a room are taken only if a model of
# one is named (bathroom2 of Bitterli's rendering resources, https://benedikt-bitterli.me/resources/). Needs a display and a driver for
# graphics (`xvfb-run -s '-noreset -screen 0 3840x2160x24' screenshots/take.sh` will do), and for the animation ImageMagick. What the
# pointer is over is told: it had better stand outside of the window.
set -euo pipefail
[ $# -eq 0 ] || set -- "$(realpath "$1")"
cd "$(dirname "$0")/.."
cargo build --release --locked
boxwood=${CARGO_TARGET_DIR:-target}/release/boxwood

# take NAME MODEL OPTIONS...
take() {
    local name=$1
    shift
    "$boxwood" "$@" --dark --size 1280x800 --screenshot "screenshots/$name.png"
}

take grid builtin:teapot --structure grid --spp 4
take check builtin:teapot --spp 64 --check
take errors builtin:cornell-box --errors image --spp 4 --no-overlay
take prediction builtin:teapot --errors prediction --spp 4 --no-overlay
take structure builtin:teapot --structure bvh --select overlap --try-plane x,0.4 --depth 4 --spp 16
take ray builtin:teapot --follow 0.1,0.1 --beside kdtree,grid --spp 16
take panes builtin:teapot --mode nodes --panes bvh,kdtree,grid --arrange divider --no-overlay --spp 4
take stadium builtin:teapot-in-stadium --mode prims --panes grid,grid2 --arrange two --no-overlay --spp 1
take film 'builtin:teapot?triangles=1000' --film 0.3 --spp 16
take section builtin:teapot --structure volumes --section x,0.5 --depth 4 --spp 16
take tiles builtin:teapot --structure wide --no-overlay --time-tiles --spp 4
if [ $# -gt 0 ]; then
    view='eye 2,17,25 target 0,11,-20 fov 55'
    take heat "$1" --structure bvh --mode nodes --no-overlay --spp 4 --camera "$view"
    take kdtree "$1" --structure kdtree --depth 12 --spp 4 --camera "$view"
    take bvh "$1" --structure bvh --depth 6 --boxes-from 50 --spp 16 --measure --camera "$view"
fi

# Eight seconds at most: turning, levels, structures.
frames=$(mktemp -d)
trap 'rm -rf "$frames"' EXIT
"$boxwood" builtin:teapot --structure bvh --depth 1 --spp 4 --dark --size 960x600 --animate "$frames"
convert -delay 10 -loop 0 "$frames"/*.png -resize 800x -layers OptimizePlus +dither -colors 128 screenshots/animation.gif
