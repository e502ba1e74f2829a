# Sourced: how the probe is built. BUILDS names all, a machine and an optimisation level each.
#
# `link BUILD [CARGO ARGUMENTS]` builds one and leaves its path in `binary`. The Cortex-M builds take
# their compiler from GYRFALCON_THUMB (default target/thumb of the repository, as made by
# tests/firmware/toolchain.sh), else the installed one when it has the target.

BUILDS="x86-64-3 x86-64-s m7-3 m7-s m4f-3 m4f-s"
probe=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
tools=$(realpath -m "${GYRFALCON_THUMB:-$probe/../../target/thumb}")
thumb=thumbv7em-none-eabihf

# The compiler for the Cortex-M, or a sentence that says how to get one.
thumb_rustc() {
    if [ -x "$tools/rustc" ]; then
        echo "$tools/rustc"
    elif [ -d "$(rustc --print sysroot)/lib/rustlib/$thumb" ]; then
        echo rustc
    else
        echo "no compiler for $thumb: run tests/firmware/toolchain.sh, or rustup target add $thumb" >&2
        return 1
    fi
}

# A disassembler for the Cortex-M.
thumb_objdump() {
    if [ -x "$tools/arm-none-eabi-objdump" ]; then
        echo "$tools/arm-none-eabi-objdump"
    elif command -v arm-none-eabi-objdump; then
        return 0
    else
        echo "no arm-none-eabi-objdump: run tests/firmware/toolchain.sh, or install binutils-arm-none-eabi" >&2
        return 1
    fi
}

link() {
    local build=$1 target rustc=rustc flags=() cpu=()
    shift
    case $build in
    x86-64-*)
        target=x86_64-unknown-linux-gnu
        flags=(-Crelocation-model=static -Clink-arg=-static -Clink-arg=-nostartfiles -Clink-arg=-nodefaultlibs)
        ;;
    m7-*) cpu=(-Ctarget-cpu=cortex-m7) ;;
    m4f-*) cpu=(-Ctarget-cpu=cortex-m4) ;;
    *)
        echo "no such build: $build (there are: $BUILDS)" >&2
        return 1
        ;;
    esac
    if [ "${#cpu[@]}" != 0 ]; then
        target=$thumb
        rustc=$(thumb_rustc) || return 1
    fi
    local level=${build##*-} folder=$(realpath -m "${CARGO_TARGET_DIR:-$probe/target}")
    [ "$level" = 3 ] || level="\"$level\""
    # Without jump tables on x86-64, where they look like indirect calls.
    (
        cd "$probe"
        RUSTC="$rustc" RUSTC_WORKSPACE_WRAPPER="$probe/stack-sizes.sh" CARGO_TARGET_DIR="$folder" \
            CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS=-Cjump-tables=no \
            CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="${cpu[*]}" \
            cargo rustc -q --locked --release --target "$target" --bin link-probe \
            --config "profile.release.opt-level=$level" \
            --config "profile.release.package.\"*\".opt-level=$level" \
            "$@" -- "${flags[@]}"
    ) || return 1
    binary="$folder/$target/release/link-probe"
}
