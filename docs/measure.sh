#!/usr/bin/env bash
# Holds numbers that the pages state against those that the program prints.
#
#   docs/measure.sh          every claim but the slow ones
#   docs/measure.sh --all    all of them
#
# The claims are in measured.sh. The program is $GYRFALCON, else target/release/gyrfalcon. Exit code 1
# and a line for each number that is stale, with its page, what it states and what was measured. Files
# go to a temporary folder, 2 GB for some seconds.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "$0")/.."
gyrfalcon=$(realpath "${GYRFALCON:-target/release/gyrfalcon}")
all=${1:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
held=0
stale=0
judged=yes

# Starts the program once under a name; what it prints is kept, and the seconds that it took.
run() {
    local name=$1 begin code=0
    shift
    if [ ! -e "$work/$name" ]; then
        begin=$EPOCHREALTIME
        "$gyrfalcon" "$@" >"$work/$name" 2>"$work/error" || code=$?
        # 1 is a verdict, such as that of periods that beat.
        if [ "$code" -gt 1 ]; then
            cat "$work/error" >&2
            return 1
        fi
        awk -v b="$begin" -v e="$EPOCHREALTIME" 'BEGIN { print e - b }' >"$work/$name.seconds"
    fi
}

# The numbers of the lines that it reads, one a line.
numbers() {
    grep -oE '[0-9][0-9,]*(\.[0-9]+)?(e-?[0-9]+)?' | tr -d ','
}

number() {
    grep -m 1 -E "$2" "$work/$1" | numbers | sed -n "$3p"
}

# The same of the first line after one that matches.
number_after() {
    sed -nE "/$2/,\$p" "$work/$1" | grep -E -m 1 "$3" | numbers | sed -n "$4p"
}

# The value of a key in a line of JSON.
value() {
    grep -oE "\"$2\":[0-9.e-]+" "$work/$1" | numbers | head -n 1
}

# One number by another.
over() {
    awk -v a="$1" -v b="$2" 'BEGIN { printf "%.9g\n", a / b }'
}

seconds() {
    cat "$work/$1.seconds"
}

# Whether what is stated agrees with what was measured.
agree() {
    awk -v stated="$1" -v measured="$2" -v tolerance="$3" 'BEGIN {
        difference = stated - measured
        if (difference < 0) difference = -difference
        slack = 1e-9 * (measured < 0 ? -measured : measured)
        if (tolerance == "rounded") {
            point = index(stated, ".")
            allowed = 0.5 * 10 ^ (point ? point - length(stated) : 0)
        } else if (tolerance == "below") {
            exit !(measured <= stated)
        } else if (tolerance ~ /^x/) {
            factor = substr(tolerance, 2)
            exit !(measured <= factor * stated && stated <= factor * measured)
        } else if (tolerance ~ /%$/) {
            allowed = measured * tolerance / 100
        } else {
            allowed = tolerance
        }
        exit !(difference <= allowed + slack)
    }'
}

# Whether half as many processes again as there are cores were running when this began.
busy() {
    awk -v cores="$(nproc)" 'BEGIN { getline load < "/proc/loadavg"; exit !(load + 0 > 1.5 * cores) }'
}

refuse() {
    echo "$1" >&2
    stale=$((stale + 1))
}

claim() {
    local page=$1 words=$2 tolerance=$3 pattern found measured stated i
    shift 3
    if [[ $tolerance == x* && $judged == no ]]; then
        return
    fi
    # A regular expression of the words, each {} a number.
    pattern=$(sed -E 's/[][\\.^$*+?(){}|]/\\&/g; s/\\\{\\\}/([0-9][0-9,]*(\\.[0-9]+)?)/g' <<<"$words")
    if ! found=$(grep -oE -m 1 -e "$pattern" "$page"); then
        refuse "$page: the words are not there: $words"
        return
    fi
    if [[ $words != *'{}'* ]]; then
        if "$@"; then held=$((held + 1)); else refuse "$page: no longer true: $words"; fi
        return
    fi
    # The numbers stated are the groups of the match; every second one is its decimals.
    [[ $found =~ $pattern ]]
    stated=()
    for ((i = 1; i < ${#BASH_REMATCH[@]}; i += 2)); do
        stated+=("${BASH_REMATCH[i]//,/}")
    done
    if ! "$@" >"$work/measured"; then
        refuse "$page: nothing was measured: $words"
        return
    fi
    mapfile -t measured <"$work/measured"
    if [ "${#measured[@]}" != "${#stated[@]}" ]; then
        refuse "$page: ${#stated[@]} numbers stated, ${#measured[@]} measured: $words"
        return
    fi
    for i in "${!stated[@]}"; do
        if agree "${stated[i]}" "${measured[i]}" "$tolerance"; then
            held=$((held + 1))
        else
            refuse "$page: ${stated[i]} stated, ${measured[i]} measured (tolerance $tolerance): $words"
        fi
    done
}

slow() {
    if [ "$all" = --all ]; then "$@"; fi
}

# That a stale number is found, on a page made up for it.
check_itself() {
    local page=$work/page
    echo 'It has 1,234.5 parts (a * b), 2 kinds, and 30 % of | 0.75 |.' >"$page"
    claim "$page" 'has {} parts (a * b), {} kinds' rounded printf '%s\n' 1234.46 2.4
    claim "$page" '{} %' 10% echo 28
    claim "$page" '| {} |' x3 echo 2.2
    claim "$page" '| {} |' below echo 0.7
    claim "$page" 'It has' rounded true
    [ "$held $stale" = '6 0' ] || { echo "a true claim was refused" >&2; exit 2; }
    {
        claim "$page" 'has {} parts' rounded echo 1234.6
        claim "$page" '{} kinds' 0.1 echo 2.2
        claim "$page" '{} %' 10% echo 27
        claim "$page" '| {} |' x3 echo 2.3
        claim "$page" '| {} |' below echo 0.76
        claim "$page" '{} kinds' rounded printf '%s\n' 2 2
        claim "$page" '{} kinds' rounded false
        claim "$page" 'It hasn' rounded true
        claim "$page" 'It has' rounded false
    } 2>"$work/ignored"
    [ "$held $stale" = '6 9' ] || { echo "a stale claim was not found" >&2; exit 2; }
    held=0
    stale=0
}

check_itself
if busy; then
    echo "measure: other work is running, times are not judged" >&2
    judged=no
fi
. docs/measured.sh
if [ "$stale" != 0 ]; then
    echo "measure: $stale numbers are stale, $held hold" >&2
    exit 1
fi
echo "measure: $held numbers hold"
