#!/usr/bin/env bash
# Makes, from Debian packages alone, what the checks on a Cortex-M need: a Rust compiler with core
# for thumbv7em-none-eabihf and riscv32imac-unknown-none-elf, lld, binutils and a C compiler for Arm,
# and QEMU.
#
#   tests/firmware/toolchain.sh [TOOLDIR]      TOOLDIR: default target/thumb of the repository
#
# Packages are unpacked in TOOLDIR, not installed. TOOLDIR then holds rustc, qemu-system-arm,
# arm-none-eabi-gcc, -objdump and -size; core is compiled with its stack sizes. A second run
# returns at once. Needs Debian 12 or later, root or fresh package lists, and cargo.
#
# With rustup none of this is needed: `rustup target add thumbv7em-none-eabihf
# riscv32imac-unknown-none-elf`, and qemu-system-arm and gcc-arm-none-eabi from the system.
set -euo pipefail
script=$(realpath "$0")
tools=$(realpath -m "${1:-$(dirname "$script")/../../target/thumb}")
targets=(thumbv7em-none-eabihf riscv32imac-unknown-none-elf)
stamp="$tools/complete"
version=$(cksum <"$script")

if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$version" ]; then
    echo "toolchain: complete in $tools"
    exit 0
fi

fail() {
    echo "toolchain: $1" >&2
    echo "toolchain: with rustup instead: rustup target add ${targets[*]}; and install qemu-system-arm and gcc-arm-none-eabi" >&2
    exit 1
}

for tool in apt-get apt-cache dpkg-deb; do
    command -v "$tool" >/dev/null || fail "$tool is not here: this script makes the compiler from Debian packages"
done
command -v cargo >/dev/null || fail "cargo is not here"

rm -rf "$tools"
mkdir -p "$tools/debs" "$tools/packages"
log="$tools/log"

# Runs a command quietly; shows what it said only when it fails.
quietly() {
    "$@" >"$log" 2>&1 || {
        tail -n 20 "$log" >&2
        fail "this failed: $*"
    }
}

if [ "$(id -u)" = 0 ]; then
    quietly apt-get update
fi
apt-cache show rustc-web >"$log" 2>&1 ||
    fail "the package lists have no rustc-web (Debian 12 with its security updates has it; run apt-get update as root)"

# Versioned dependencies of package $1 whose names match $2.
depends() {
    apt-cache depends "$1" | awk -v name="$2" '$1 == "Depends:" && $2 ~ name { print $2 }'
}
std=$(depends libstd-rust-web-dev '^libstd-rust-web-')
lld=$(depends lld '^lld-[0-9]+$')
packages=(rustc-web rust-web-src libstd-rust-web-dev "$std" "$lld" qemu-system-arm binutils-arm-none-eabi
    gcc-arm-none-eabi)
missing=$(apt-get install -s --no-install-recommends "$std" "$lld" qemu-system-arm gcc-arm-none-eabi |
    awk '$1 == "Inst" { print $2 }')
mapfile -t packages < <(printf '%s\n' "${packages[@]}" $missing | sort -u)
echo "toolchain: ${#packages[@]} Debian packages to $tools"
cd "$tools/debs"
quietly apt-get download "${packages[@]}"
for package in *.deb; do
    quietly dpkg-deb -x "$package" "$tools/packages"
done
cd "$tools"
rm -r debs

# Unpacked programs find their libraries in TOOLDIR first.
libraries=$(printf ':%s' "$tools"/packages/{usr/,}lib/*-linux-gnu)
wrap() {
    printf '#!/bin/sh\nLD_LIBRARY_PATH=%s exec %s "$@"\n' "${libraries#:}" "$2" >"$1"
    chmod +x "$1"
}
for program in rustc qemu-system-arm arm-none-eabi-gcc arm-none-eabi-objdump arm-none-eabi-size; do
    wrap "$tools/$program" "$tools/packages/usr/bin/$program"
done
host=$("$tools/rustc" -vV | sed -n 's/^host: //p')
rustlib="$tools/packages/usr/lib/rustlib"
# The compiler looks here for the linker that its bare-metal targets name.
mkdir -p "$rustlib/$host/bin"
wrap "$rustlib/$host/bin/rust-lld" "$(echo "$tools"/packages/usr/lib/llvm-*/bin/lld)"

# core and compiler_builtins, compiled from the matching source.
mkdir -p core/src
printf '[package]\nname = "sysroot"\nversion = "0.0.0"\nedition = "2021"\n[workspace]\n' >core/Cargo.toml
echo '#![no_std]' >core/src/lib.rs
cd core
# RUSTC_BOOTSTRAP: compiling core itself needs what only a nightly compiler accepts.
quietly env RUSTC="$tools/rustc" RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Cembed-bitcode=yes -Zemit-stack-sizes" \
    CARGO_TARGET_DIR="$tools/core/target" cargo build --release -Zbuild-std=core "${targets[@]/#/--target=}"
for target in "${targets[@]}"; do
    mkdir -p "$rustlib/$target/lib"
    cp "target/$target/release/deps"/lib{core,compiler_builtins}-*.rlib "$rustlib/$target/lib/"
done
cd "$tools"
rm -r core "$log"
echo "$version" >"$stamp"
echo "toolchain: $("$tools/rustc" -V) for ${targets[*]} in $tools"
