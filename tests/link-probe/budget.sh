#!/usr/bin/env bash
# Worst-case stack of every entry point and sizes of the core against tests/firmware/budget.toml;
# then shows that the analysis refuses each seeded fault. `--update` records the values, `--all` lists
# every entry point, with the deepest chain.
set -euo pipefail
here=$(dirname "$(realpath "$0")")
. "$here/link.sh"
OBJDUMP_ARM=$(thumb_objdump)
export OBJDUMP_ARM

budget() {
    cargo run -q --locked --manifest-path "$here/../Cargo.toml" --bin budget -- "$@"
}

# The values follow the compiler: they are held to it, whichever it is, but another one is named.
recorded_with() {
    local recorded found
    recorded=$(sed -n "s/^$1 = \"\(.*\)\"$/\1/p" "$here/../firmware/budget.toml")
    found=$("$2" -V | cut -d' ' -f2)
    if [ "$recorded" != "$found" ]; then
        echo "budget: recorded with Rust $recorded for $1, this is $found"
    fi
}
recorded_with host rustc
recorded_with thumb "$(thumb_rustc)"

binaries=$(mktemp -d)
trap 'rm -r "$binaries"' EXIT
for build in $BUILDS; do
    link "$build"
    cp "$binary" "$binaries/$build"
    set -- "$@" "$build=$binaries/$build"
done
options=()
while [[ ${1:-} == --* ]]; do
    options+=("$1")
    shift
done
budget "${options[@]}" "$here/../firmware" "$@"

# Each fault with the words of its refusal.
while read -r fault words; do
    for build in x86-64-3 m7-s; do
        [ "$fault $build" != "bad-frame x86-64-3" ] || continue # has no limit
        link "$build" --features "$fault"
        if said=$(budget --fault "$here/../firmware" "$build=$binary" 2>&1) || ! grep -q "$words" <<<"$said"; then
            echo "budget: the seeded fault $fault went unnoticed on $build: $said" >&2
            exit 1
        fi
    done
    echo "budget: $fault is refused, as it must be"
done <<'FAULTS'
bad-recursion recursion: .*climb calls .*climb
bad-indirect indirect call in .*call_any
bad-frame fill [0-9]* .*TOO LARGE
bad-dynamic unknown frame of .*shift_stack
bad-static static memory [1-9][0-9]* .*TOO LARGE
FAULTS
