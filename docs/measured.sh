# What the pages claim, and how it is measured; read by measure.sh.
#
# To add a claim, add a line to the table at the end:
#
#   claim PAGE 'its words, {} where a number stands' TOLERANCE COMMAND...
#
# COMMAND prints the numbers in the order of the {}; where the words hold none, it succeeds if they
# are true. A tolerance is
#   rounded   half a unit of the last digit stated
#   N         a difference
#   N%        a part of what was measured
#   xN        a factor, for times; not judged while the machine has more work than cores
#   below     what was measured does not exceed what is stated
# `run NAME ARGUMENTS...` starts the program once and keeps what it prints as NAME, `number NAME REGEX
# K` prints the K-th number of its first line that matches.
# shellcheck shell=bash disable=SC2154

# Hours that the boresight has a target, or all of them (total), in view.
hours() {
    local key=$1 mission=$2
    shift 2
    local name="hours $mission $*"
    run "$name" transits --json --out "$work/rows" --mission "$mission" "$@"
    value "$name" "$key"
}

half_turn=(--set scan.spin_phase_deg=180)
papers_sun=(--sun circular:191.37579428901796)
papers=("${half_turn[@]}" "${papers_sun[@]}" --observer sun --geometric)

litebird_hours() {
    hours total litebird "${papers[@]}"
    hours total litebird "${half_turn[@]}" "${papers_sun[@]}"
    hours total litebird "${half_turn[@]}"
}

mars_hours() {
    hours mars litebird "${half_turn[@]}"
    hours mars litebird "${papers[@]}"
}

# From L2 with the paper's Sun, with DE440's: the total and Mars.
l2_hours() {
    hours total litebird "${half_turn[@]}" "${papers_sun[@]}"
    hours mars litebird "${half_turn[@]}" "${papers_sun[@]}"
    hours total litebird "${half_turn[@]}"
    hours mars litebird "${half_turn[@]}"
}

# Days of the N-th longest gap of a target.
gap() {
    sed -nE "/^$2, longest gaps:/,\$p" "$work/$1" | sed -n "$((1 + $3))p" | numbers | head -n 1
}

# The least and the largest N-th gap of the outer planets.
gaps() {
    local target
    for target in jupiter saturn uranus neptune; do
        gap "$1" "$target" "$2"
    done | sort -g | sed -n '1p;$p'
}

waits() {
    run "waits $1" visits --theta-phi 90deg,180deg --target jupiter,saturn,uranus,neptune --mission "$1"
    gap "waits $1" pixel:64:ring:24576 1
    gap "waits $1" pixel:64:ring:24576 4
    gaps "waits $1" 1
    gaps "waits $1" 3
}

# LiteBIRD's three years with all products; of the large ones only sizes and counts are kept.
three_years() {
    if [ ! -e "$work/three" ]; then
        run three plan --out "$work/plan" --also all
        wc -c "$work"/plan/* >"$work/sizes"
        head -n 20 "$work/plan/attitude.aem" >"$work/attitude"
        grep -c '^META_START' "$work/plan/attitude.aem" >"$work/segments"
        grep -cE '^[0-9]{4}-' "$work/plan/attitude.aem" >"$work/samples"
        rm "$work"/plan/attitude.*
    fi
}

# The size of a product, in units of so many bytes.
size() {
    three_years
    over "$(number sizes "/$1\$" 1)" "$2"
}

plan_of_three_years() {
    three_years
    number three '^objective' 1
    number three '^objective' 2
    number three '^objective' 3
}

gap_of_three_years() {
    three_years
    number three '^objective' 3
}

opportunities() {
    three_years
    number three '^total' 3
}

whole_plan() {
    opportunities
    plan_of_three_years
}

sessions() {
    three_years
    number three '^total' 1
    cat "$work/segments"
    over "$(cat "$work/samples")" 1e6
}

interpolation() {
    three_years
    number attitude 'samples every' 1
    number attitude 'samples every' 2
}

# The attitude of two weeks, in MB.
fortnight() {
    run fortnight plan --duration 14d --also aem --out "$work/fortnight-plan"
    over "$(wc -c <"$work/fortnight-plan/attitude.aem")" 1e6
}

coarser_is_a_quarter() {
    run coarser plan --duration 14d --also aem --out "$work/coarser-plan" --aem-error-arcsec 20
    over "$(wc -c <"$work/coarser-plan/attitude.aem")" "$(fortnight)" |
        awk '{ exit !($1 > 0.2e6 && $1 < 0.3e6) }'
}

# What ten more minutes a day bring: to the objective, and to Jupiter.
ten_minutes() {
    three_years
    cp "$work/plan/timeline.json" "$work/timeline"
    number_after timeline '"10 more minutes per day"' objective_percent 1
    number_after timeline '"10 more minutes per day"' '"jupiter"' 1
}

time_of_three_years() {
    three_years
    seconds three
}

times() {
    time_of_three_years
    run week plan --duration 7d --out "$work/week-plan"
    seconds week
}

between_times() {
    time_of_three_years
    time_of_three_years
}

week_is_optimal() {
    run week plan --duration 7d --out "$work/week-plan"
    grep -q 'optimal: no schedule is better' "$work/week"
}

month() {
    run month plan --duration 30d --out "$work/month-plan"
    number month '^objective' 3
}

commissioning() {
    run commissioning plan --out "$work/commissioning-plan" \
        --mission ground-tools/examples/commissioning/mission.toml
    number commissioning '^objective' 1
    number commissioning '^objective' 2
    number commissioning '^objective' 3
}

commissioning_gap() {
    commissioning | sed -n 3p
}

later_gap() {
    run "$1" plan --out "$work/later-plan" --start "$1T00:00:00 TDB"
    rm -rf "$work/later-plan"
    number "$1" '^objective' 3
}

later_gaps() {
    later_gap 2029-01-01
    later_gap 2030-07-01
}

# Bytes of the onboard table's ephemeris.
table() {
    run table table build --out "$work/built.tbl"
    sed -n 's/.*of which ephemeris //p' "$work/table"
}

table_kib() {
    over "$(table)" 1024
}

# The largest error of the table that is built, in mas.
table_error() {
    table >"$work/ignored"
    awk 'NF == 5 && $5 + 0 > 0 { print $5 + 0 }' "$work/table" | sort -g | tail -n 1
}

# The shortest spin period of HFT at these angles, in min.
shortest_spin() {
    local name="constraints $*"
    run "$name" constraints --set "scan.alpha_deg=$1" --set "scan.beta_deg=$2"
    number "$name" '^T_beta_lower[+]' 3
}

shortest_spins() {
    shortest_spin 45 50
    shortest_spin 10 85
    shortest_spin 85 10
}

sweeps() {
    run sweeps constraints --json
    value sweeps omega_max_plus_deg_s
    value sweeps omega_max_minus_deg_s
}

table_verified() {
    table
    run verified table verify "$work/built.tbl"
    awk 'NF == 5 && $2 + 0 > 0 { print $2 }' "$work/verified" | sort -g | tail -n 1
}

# How far the bound lies above the floor, in percent.
excess() {
    local name="excess $*"
    run "$name" resonance "$@"
    number "$name" '^bound within tolerance' 2
}

excesses() {
    excess --sun circular
    excess
}

# The precession period, in min, at which the most uneven hits are predicted.
worst_period() {
    run scan resonance --sun circular --scan 192:193:0.0025
    grep -E '^[0-9]' "$work/scan" | sort -t, -k2 -g | tail -n 1 | cut -d, -f1
}

crosslinks() {
    run crosslinks resonance --sun circular --crosslink 1,2,3,4,5,6
    local n
    for n in 1 2 3 4 5 6; do
        over "$(number crosslinks "^n = $n " 2)" 0.01
    done
}

# A year of 365 days at 19 Hz: sigma of the hits.
year() {
    local name="year $*"
    run "$name" survey --duration 365d --nside 256 --sun circular:0 --set scan.spin_phase_deg=180 "$@"
    number "$name" '^hits:' 2
}

sigmas() {
    local standard balanced
    standard=$(year)
    balanced=$(year --set scan.alpha_deg=47.5 --set scan.beta_deg=47.5)
    echo "$standard"
    echo "$balanced"
    over "$balanced" "$standard"
}

scan_beam() {
    year >"$work/ignored"
    number 'year ' 'scan-beam angle' 1
}

claim README.md 'It takes about {} s on two cores' x3 time_of_three_years
claim README.md '| LiteBIRD | 3.1 to 3.2 | {} | {} | {} |' rounded litebird_hours
claim README.md '| PICO | 1.8 | {} |' rounded hours total pico "${papers[@]}"
claim README.md '| Planck | 1.6 | {} |' rounded hours total planck "${papers[@]}"
claim README.md 'Mars gets {} h instead of {} h' rounded mars_hours
claim README.md '(phase 0) gives {} h' rounded hours total litebird
claim README.md '| LiteBIRD | 6 months, 10 d | {} d, {} d | {} to {} d, {} to {} d |' rounded waits litebird
claim README.md '| PICO | 6 months, 90 d | {} d, {} d | {} to {} d, {} to {} d |' rounded waits pico
claim README.md '| Planck | 6 months, 6 months | {} d, {} d | {} to {} d, {} to {} d |' rounded waits planck
claim README.md '{} KiB, below 1 mas' rounded table_kib
claim README.md 'KiB, below {} mas' below table_error
claim README.md 'two cores: three years; a week | {} s; {} s |' x3 times
claim README.md 'within {} % of a proven bound' below gap_of_three_years
claim README.md "a week's proved optimal" rounded week_is_optimal
claim CHANGELOG.md 'three years of LiteBIRD within {} % of the bound' rounded gap_of_three_years

claim docs/scheduling.md 'LiteBIRD, three years, {} opportunities' rounded opportunities
claim docs/scheduling.md 'run --release -- plan` | {} s of at most {} s: gap {} %' rounded plan_of_three_years
claim docs/scheduling.md 'in {} to {} s, all files written' x3 between_times
claim docs/scheduling.md "LiteBIRD's three years end {} % below the bound" rounded gap_of_three_years
claim docs/scheduling.md "would add {} % to LiteBIRD's objective, {} % of Jupiter's time" rounded ten_minutes
claim docs/scheduling.md 'examples/commissioning` | {} s of at most {} s: gap {} %' rounded commissioning
claim docs/scheduling.md '{} % in the commissioning example' rounded commissioning_gap
claim docs/scheduling.md 'Over the first 30 days the gap is {} %' rounded month
claim docs/decisions/0004-schedule-day-by-day.md 'ends within {} % of the bound' below gap_of_three_years
claim ground-tools/examples/commissioning.rs 'leaves a gap of {} %' rounded commissioning_gap
slow claim docs/scheduling.md 'gaps {} and {} %, in' rounded later_gaps

claim docs/outputs.md 'LiteBIRD {} s, {} arcsec' rounded interpolation
claim docs/outputs.md "LiteBIRD's three years take {} MB" rounded size report.html 1e6
claim docs/outputs.md '{} sessions in {} segments of {} million samples' rounded sessions
claim docs/outputs.md '`attitude.aem` {} MB' 1% size attitude.aem 1e6
claim docs/outputs.md '`attitude.xml` {} GB' rounded size attitude.xml 1e9
claim docs/outputs.md '`attitude.a` {} MB' 1% size attitude.a 1e6
claim docs/outputs.md '`attitude.bc` {} MB' 1% size attitude.bc 1e6
claim docs/outputs.md '`pointing-periods.csv` {} MB' rounded size pointing-periods.csv 1e6
claim docs/outputs.md '`timeline.ics` {} MB' rounded size timeline.ics 1e6
claim docs/outputs.md '`timeline.parquet` {} MB' rounded size timeline.parquet 1e6
claim docs/outputs.md '`sessions.int` {} MB' rounded size sessions.int 1e6
claim docs/outputs.md '`--aem-error-arcsec 20` writes a quarter' rounded coarser_is_a_quarter
claim docs/outputs.md 'two weeks writes an AEM of {} MB' rounded fortnight

claim docs/onboard.md '{} KiB for the Sun and five planets' rounded table_kib

claim docs/resonance.md '| {} min; within 0.0075 min |' rounded worst_period
claim docs/resonance.md "bound {}% above the floor; on DE440's orbit {}%" rounded excesses
claim docs/resonance.md "LiteBIRD's box is {}% above the floor of three years" rounded excess --duration 1095.75d
claim docs/resonance.md '| 192.348 | {} / 4.717 | {} / 8.053 | {} / 6.020 | {} / 2.539 | {} / 3.890 | {} / 2.759 |' rounded crosslinks

claim docs/survey.md 'spin phase of 180 deg, is {} for the standard angles and {} for alpha = beta = 47.5 deg, a ratio of {}' rounded sigmas
claim docs/survey.md '{} deg for LiteBIRD at 20 min' rounded scan_beam

claim docs/validation/2026-11-22.md '{} min; {} at alpha 10, beta 85; {} at alpha 85, beta 10' rounded shortest_spins
claim docs/validation/2026-11-22.md '| same | {} and {} deg/s |' rounded sweeps
claim docs/validation/2026-11-22.md 'LiteBIRD {}, PICO' rounded hours total litebird "${papers[@]}"
claim docs/validation/2026-11-22.md 'PICO {}, Planck' rounded hours total pico "${papers[@]}"
claim docs/validation/2026-11-22.md 'Planck {} |' rounded hours total planck "${papers[@]}"
claim docs/validation/2026-11-22.md '{} (Mars {}); {} (Mars {})' rounded l2_hours
claim docs/validation/2026-11-22.md '{} bytes of ephemeris, worst {} mas at 10,000' rounded table_verified
claim docs/validation/2026-11-22.md '{} opportunities, objective {} s of at most {} s: gap {} %' rounded whole_plan
claim docs/validation/2026-11-22.md 'whole process, two cores (2026-11-30) | {} to {} s' x3 between_times
