#!/usr/bin/env bash
# Mutation tests of onboard-core by its own tests (cargo-mutants): what one changed operator, constant,
# match arm or return value breaks, a test must see.
#
#   tests/mutants.sh [BASE]       mutants of the lines changed since the commit BASE; without it since
#                                 the parent of HEAD. At most 25 of them, at most five minutes
#   tests/mutants.sh --all [K/N]  all mutants, or the K-th (from 0) of N equal parts; no limit of time
#
# Where git knows no such commit (a shallow clone), a fixed sample of four is tried instead. Fails
# where a mutant survives that tests/mutants.toml does not name. Results stay in
# target/mutants/mutants.out.
#
# cargo-mutants is installed in target/mutants unless this version is on the path. The whole takes
# hours; docs/validation/mutants.md says what was found, and how.
set -euo pipefail
cd "$(dirname "$0")/.."
version=27.1.0
most=25
seconds=300
work=$PWD/target/mutants
mkdir -p "$work"
export PATH="$work/bin:$PATH"
# Built once per mutant, run once: a small build is worth more than a quick one.
export CARGO_INCREMENTAL=1 CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=none

if [ "$(cargo mutants --version 2>/dev/null)" != "cargo-mutants $version" ]; then
    cargo install --quiet --locked --debug --root "$work" --version "$version" cargo-mutants
fi
mutants=(cargo mutants --package onboard-core --config tests/mutants.toml --colors never)

run() {
    # The tests themselves are `cargo test`'s; the first build of all dependencies counts as well.
    timeout --signal INT "$seconds" "${mutants[@]}" --output "$work" --baseline skip --timeout 120 \
        --no-shuffle "$@" -- --lib
}

# So many mutants that every n-th of them is no more than `most`.
shard() {
    local count
    count=$("${mutants[@]}" --list "$@" | wc -l)
    echo $(((count + most - 1) / most))
}

rm -rf "$work/mutants.out"
code=0
if [ "${1:-}" = --all ]; then
    seconds=0
    run ${2:+--shard "$2"} || code=$?
else
    base=${1:-HEAD^}
    if git rev-parse --quiet --verify "$base^{commit}" >/dev/null; then
        git diff "$base" -- onboard-core/src >"$work/changes.diff"
        parts=0
        if [ -s "$work/changes.diff" ]; then
            parts=$(shard --in-diff "$work/changes.diff")
        fi
        if [ "$parts" = 0 ]; then
            echo "mutants: no code of onboard-core has changed since $base"
            exit 0
        fi
        run --in-diff "$work/changes.diff" --shard "0/$parts" --sharding round-robin || code=$?
    else
        echo "mutants: git knows no $base, a fixed sample is tried"
        run --file onboard-core/src/clock.rs --shard 0/8 --sharding round-robin || code=$?
    fi
fi
found() {
    local list="$work/mutants.out/$1.txt"
    if [ -f "$list" ]; then wc -l <"$list"; else echo 0; fi
}
echo "mutants: $(found caught) caught, $(found timeout) ran for too long, $(found unviable) do not compile, $(found missed) survived"
case $code in
0 | 2 | 3) ;;
124) echo "mutants: stopped after $seconds s" ;;
*) exit "$code" ;;
esac
if [ "$(found missed)" != 0 ]; then
    cat "$work/mutants.out/missed.txt" >&2
    exit 1
fi
