#!/usr/bin/env bash
# Fuzzes every target from the committed corpus, one after the other, and fails at the first crash.
#
#   tests/fuzz/run.sh                   10 s per target
#   tests/fuzz/run.sh 600               so many seconds per target
#   tests/fuzz/run.sh -runs=100000      so many executions per target
#   tests/fuzz/run.sh 600 slots plan    only these targets
#
# Builds with the flags that `RUSTC_BOOTSTRAP=1 cargo fuzz build --sanitizer none` sets, so that no
# other tool is needed. What a run finds stays in the target folder; the corpus is not touched.
set -euo pipefail
cd "$(dirname "$0")"

budget=${1:-10}
shift || true
case $budget in
-runs=*) limit=$budget ;;
*[!0-9]*)
    echo "usage: $0 [SECONDS | -runs=N] [TARGET...]" >&2
    exit 2
    ;;
*) limit=-max_total_time=$budget ;;
esac

mapfile -t targets < <(for file in fuzz_targets/*.rs; do basename "$file" .rs; done)
if [ $# -gt 0 ]; then
    targets=("$@")
fi

host=$(rustc -vV | sed -n 's/^host: //p')
export RUSTC_BOOTSTRAP=1
RUSTFLAGS="--cfg fuzzing -C codegen-units=1 -C passes=sancov-module"
for flag in level=4 inline-8bit-counters pc-table trace-compares; do
    RUSTFLAGS+=" -C llvm-args=-sanitizer-coverage-$flag"
done
export RUSTFLAGS
# Naming the host keeps the flags away from build scripts and macros.
cargo build -q --locked --release --bins --target "$host"

folder=${CARGO_TARGET_DIR:-target}
scratch=$folder/fuzz-run
rm -rf "$scratch"
mkdir -p "$scratch"
for target in "${targets[@]}"; do
    mkdir -p "$scratch/$target"
    cp corpus/"$target"/* "$scratch/$target"
    log=$scratch/$target.log
    if ! "$folder/$host/release/$target" "$scratch/$target" -seed=1 "$limit" -timeout=20 \
        -rss_limit_mb=1024 -max_len=4096 -print_final_stats=1 \
        -artifact_prefix="$scratch/$target-" >"$log" 2>&1; then
        tail -n 40 "$log" >&2
        echo "fuzz: $target failed; the input is beside $log" >&2
        exit 1
    fi
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    covered=$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1)
    echo "fuzz: $target: $runs executions, $covered, none failed"
done
