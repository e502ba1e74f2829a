#!/usr/bin/env bash
# Structural coverage of onboard-core by its own unit and property tests: lines, regions and branches
# per module, as a table.
#
#   tests/coverage.sh            prints the table
#   tests/coverage.sh --write    writes it into docs/validation/coverage.md
#
# Test code is not counted: neither what stands behind `#[cfg(test)]` nor files that are tests alone.
# What several instances of a generic function run is added up. Branches need what only a nightly
# compiler accepts, so RUSTC_BOOTSTRAP is set for this build, which has a target folder of its own.
#
# llvm-cov and llvm-profdata must be of the compiler's LLVM: rustup's component llvm-tools, or the
# system's, or else Debian's packages, unpacked in target/llvm and not installed. Needs python3.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$PWD/target/coverage
host=$(rustc -vV | sed -n 's/^host: //p')
major=$(rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')

# Where llvm-cov and llvm-profdata are, the first folder that has them.
tools() {
    local folder
    for folder in "$(rustc --print sysroot)/lib/rustlib/$host/bin" "/usr/lib/llvm-$major/bin" \
        "target/llvm/usr/lib/llvm-$major/bin"; do
        if [ -x "$folder/llvm-cov" ] && [ -x "$folder/llvm-profdata" ]; then
            echo "$folder"
            return
        fi
    done
}

if [ -z "$(tools)" ]; then
    command -v apt-get >/dev/null || {
        echo "coverage: llvm-cov of LLVM $major is not here: rustup component add llvm-tools" >&2
        exit 1
    }
    mkdir -p target/llvm/debs
    (
        cd target/llvm/debs
        # LLVM's own library comes with every version; the others may be on the system.
        apt-get download -q "llvm-$major" "libllvm$major" libpfm4 libz3-4 >&2
        for package in *.deb; do
            dpkg-deb -x "$package" ..
        done
    )
    rm -r target/llvm/debs
fi
llvm=$(tools)
libraries=$(printf ':%s' "$PWD"/target/llvm/usr/lib/*-linux-gnu)
export LD_LIBRARY_PATH="${LD_LIBRARY_PATH:-}${libraries}"

rm -rf "$target/profiles"
RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Cinstrument-coverage -Zcoverage-options=branch" CARGO_INCREMENTAL=0 \
    LLVM_PROFILE_FILE="$target/profiles/%p-%m.profraw" \
    cargo test --locked --quiet -p onboard-core --lib --target-dir "$target" >&2
program=$(find "$target/debug/deps" -maxdepth 1 -name 'onboard_core-*' -executable -type f -printf '%T@ %p\n' |
    sort -rn | sed -n '1s/^[^ ]* //p')
"$llvm/llvm-profdata" merge -sparse -o "$target/core.profdata" "$target/profiles"/*.profraw
"$llvm/llvm-cov" export -instr-profile "$target/core.profdata" "$program" >"$target/core.json"
python3 tests/coverage.py "$target/core.json" "$(rustc -V)" "$@"
