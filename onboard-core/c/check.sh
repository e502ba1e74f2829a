#!/usr/bin/env bash
# Is the library what its header says, and can no panic be reached in it?
#
# Compares the header with what the source gives, then builds the library for x86-64 and the
# Cortex-M7 at opt-level 3 and s. In each build every function of the header must be defined, and
# nothing may be missing but the memory and arithmetic functions that compiled code calls: a panic, an
# allocation or std would be missing too. The unoptimised build, in which panics can be reached, must
# be refused.
#
# The Cortex-M's compiler comes from GYRFALCON_THUMB, as in tests/link-probe/link.sh.
set -euo pipefail
here=$(dirname "$(realpath "$0")")
. "$here/../../tests/link-probe/link.sh"

cargo run --locked --quiet --manifest-path "$here/header/Cargo.toml" -- --check
echo "c: the header is what the source says"
functions=$(grep -oE '\bgyr_[a-z_]+\(' "$here/include/gyrfalcon.h" | tr -d '(' | sort -u)
lent='^(mem(cpy|move|set|cmp)|bcmp|__aeabi_[a-z0-9_]+|__(u?div|u?mod|mul|ashl|lshr)[dt]i[34]|__(fix|float)[a-z]+)$'

# What the library stands on is built where the link probe has built it already.
folder=$(realpath -m "${CARGO_TARGET_DIR:-$probe/target}")

# Builds BUILD and names in `why` what is wrong with it; empty when nothing is.
examine() {
    local build=$1 target=x86_64-unknown-linux-gnu rustc=rustc cpu=""
    if [[ $build == m7-* ]]; then
        target=$thumb
        cpu=-Ctarget-cpu=cortex-m7
        rustc=$(thumb_rustc) || exit 1
    fi
    local level=${build##*-} others
    # Without optimisation of the library itself; what it stands on is that of opt-level 3.
    others=${level/0/3}
    [ "$others" = 3 ] || others="\"$others\""
    [ "$level" = s ] && level="\"s\""
    RUSTC=$rustc CARGO_TARGET_DIR=$folder \
        CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS=-Cjump-tables=no \
        CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS=$cpu \
        cargo build --locked --quiet --release --manifest-path "$here/Cargo.toml" --target "$target" \
        --config "profile.release.opt-level=$level" \
        --config "profile.release.package.\"*\".opt-level=$others" || exit 1
    local all defined missing
    all=$(nm "$folder/$target/release/libgyrfalcon.a" 2>/dev/null | awk -v own=0 '/^gyrfalcon-/ { own = 1 } /^compiler_builtins-/ { own = 0 } own')
    defined=$(awk '$2 == "T" { print $3 }' <<<"$all" | grep '^gyr_' | sort -u)
    missing=$(awk '$1 == "U" { print $2 }' <<<"$all" | grep -vE "$lent" || true)
    why=$missing
    if [ "$defined" != "$functions" ]; then
        why+=" the functions differ from the header's: $(diff <(echo "$functions") <(echo "$defined") || true)"
    fi
}

for build in x86-64-3 x86-64-s m7-3 m7-s; do
    examine "$build"
    if [ -n "$why" ]; then
        echo "c: on $build this is reached or missing: $why" >&2
        exit 1
    fi
    echo "c: $(wc -l <<<"$functions") functions without panic, allocation or std on $build"
done
examine x86-64-0
if ! grep -q gyr_panic_is_reachable <<<"$why"; then
    echo "c: the panics of an unoptimised build went unnoticed" >&2
    exit 1
fi
echo "c: an unoptimised build is refused, as it must be"
