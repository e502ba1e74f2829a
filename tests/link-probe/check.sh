#!/usr/bin/env bash
# Links the probe at both optimisation levels, counts the probes in the binary, and shows that each
# seeded fault breaks the link.
set -euo pipefail
cd "$(dirname "$0")"

link() {
    cargo rustc -q --locked --release --bin link-probe \
        --config "profile.release.opt-level=$1" --config "profile.release.package.\"*\".opt-level=$1" \
        "${@:2}" -- -C link-arg=-nostartfiles -C link-arg=-lc
}

for level in 3 '"s"'; do
    link "$level"
    binary="${CARGO_TARGET_DIR:-target}/release/link-probe"
    declared=$(grep -cE '^    [a-z_0-9]+\(.*\) -> .* \{ .* \}$' src/main.rs)
    # shellcheck disable=SC2046
    linked=$(nm "$binary" | awk '$2 == "T" {print $3}' |
        grep -cxF -f <(sed -nE 's/^    ([a-z_0-9]+)\(.*\) -> .* \{ .* \}$/\1/p' src/main.rs))
    if [ "$declared" != "$linked" ]; then
        echo "link probe: $declared probes declared, $linked in the binary" >&2
        exit 1
    fi
    echo "link probe: $linked functions without panic, allocation or std at opt-level $level"
done

for fault in bad-index bad-division bad-overflow bad-allocation bad-std; do
    if link 3 --features "$fault" 2>/dev/null; then
        echo "link probe: the seeded fault $fault went unnoticed" >&2
        exit 1
    fi
    echo "link probe: $fault breaks the link, as it must"
done
