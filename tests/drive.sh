#!/usr/bin/env bash
# Drives the program as a hand does, on a display: opens a model, orbits, follows a ray and steps along it, drags the plane that
# divides a node, compares two structures, saves, quits and opens what was saved. Nothing may be lost on the way: what is saved then
# must be, to the byte, what was saved before.
#
#     xvfb-run -s '-screen 0 1400x900x24' tests/drive.sh [PICTURES]
#
# BOXWOOD names a program that is built already; otherwise it is built. Takes a picture of each step into the folder PICTURES, if one is named. Needs a driver for graphics (a software one will do),
# xdotool, for pictures ImageMagick, and no window manager, which would move the window.
set -euo pipefail
pictures=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."
boxwood=${BOXWOOD:-}
if [ -z "$boxwood" ]; then
    cargo build --locked
    boxwood=${CARGO_TARGET_DIR:-target}/debug/boxwood
fi

home=$(mktemp -d)
trap 'kill "$program" 2>/dev/null || true; rm -rf "$home"' EXIT
mkdir "$home/bin" "$home/run"
# The dialog for files, where no desktop answers: the hand that types a name into it.
printf '#!/bin/sh\ncat "%s/answer"\n' "$home" >"$home/bin/zenity"
chmod +x "$home/bin/zenity"
export PATH=$home/bin:$PATH HOME=$home XDG_DATA_HOME=$home XDG_CONFIG_HOME=$home XDG_RUNTIME_DIR=$home/run
unset DBUS_SESSION_BUS_ADDRESS WAYLAND_DISPLAY

step=0
# seen NAME: what is on the screen.
seen() {
    step=$((step + 1))
    [ -z "$pictures" ] || import -window root "$pictures/$step-$1.png"
}
start() {
    "$boxwood" "$@" &
    program=$!
    local window
    window=$(xdotool search --sync --onlyvisible --name Boxwood | head -1)
    sleep 5
    xdotool windowfocus "$window"
}
key() {
    xdotool key --clearmodifiers "$1"
    sleep "${2:-1}"
}
# Does what the palette of commands finds under these words.
palette() {
    key ctrl+p
    xdotool type --delay 60 "$1"
    sleep 1
    key Return 3
}
click() {
    xdotool mousemove "$1" "$2" click 1
    sleep "$3"
}
# drag X Y TO_X TO_Y
drag() {
    xdotool mousemove "$1" "$2" mousedown 1
    sleep 0.3
    xdotool mousemove $((($1 + $3) / 2)) $((($2 + $4) / 2))
    sleep 0.3
    xdotool mousemove "$3" "$4"
    sleep 0.3
    xdotool mouseup 1
    sleep 1
}
# save NAME: the workspace into a file of that name.
save() {
    echo "$home/$1" >"$home/answer"
    key ctrl+s
    for _ in $(seq 20); do
        [ -s "$home/$1" ] && return
        sleep 0.5
    done
    echo "The workspace was not saved as $1." >&2
    exit 1
}
quit() {
    key ctrl+q 0
    wait "$program"
}

start
key Escape # the tour
key ctrl+l
xdotool type --delay 30 'builtin:teapot'
key Return 4
seen opened
drag 620 300 700 330
seen turned
key F3
click 620 330 4
click 1134 258 1 # the next leaf
seen ray
key F2 3
palette 'dearest'
drag 1100 550 1150 552
seen divided
key F4
palette 'compare with k-d tree'
seen compared
save first.boxwood
quit

start "$home/first.boxwood"
sleep 5
seen reopened
save second.boxwood
quit
diff "$home/first.boxwood" "$home/second.boxwood"
for part in '"tried"' '"ray"' '"kdtree"' '"selected"'; do
    grep -q "$part" "$home/first.boxwood" || { echo "There is no $part in what was saved." >&2; exit 1; }
done
echo 'Nothing was lost.'
