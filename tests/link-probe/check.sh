#!/usr/bin/env bash
# Links the probe on x86-64 and for the Cortex-M at both optimisation levels, counts the probes in
# each binary, and shows that each seeded fault breaks a link that would do without it.
set -euo pipefail
. "$(dirname "$(realpath "$0")")/link.sh"
form='^    ([a-z_0-9]+)\(.*\) -> .* \{ .* \}$'
# Those below a `#[cfg]` are for hosts alone.
all=$(sed -nE "s/$form/\1/p" "$probe/src/main.rs")
everywhere=$(sed -E '/^    #\[cfg\(/{N;d}' "$probe/src/main.rs" | sed -nE "s/$form/\1/p")

for build in $BUILDS; do
    names=$everywhere
    [[ $build != x86-64-* ]] || names=$all
    declared=$(wc -l <<<"$names")
    link "$build"
    linked=$(nm "$binary" | awk '$2 == "T" {print $3}' | grep -cxF -f <(echo "$names"))
    if [ "$declared" != "$linked" ]; then
        echo "link probe: $declared probes declared, $linked in the binary of $build" >&2
        exit 1
    fi
    echo "link probe: $linked functions without panic, allocation or std on $build"
done

for build in x86-64-3 m7-3; do
    link "$build" --features alone
    for fault in bad-index bad-division bad-overflow bad-allocation bad-std; do
        if link "$build" --features "$fault" 2>/dev/null; then
            echo "link probe: the seeded fault $fault went unnoticed on $build" >&2
            exit 1
        fi
        echo "link probe: $fault breaks the link on $build, as it must"
    done
done
