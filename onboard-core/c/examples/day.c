/* A day of the mission with the flight core: the example of docs/c-interface.md.
 *
 * It takes tables from a slot, correlates the clock, asks for attitudes, searches transits and counts
 * visits, and then flies: each cycle of 10 s the clock, once a minute a measured attitude to the
 * tracker, a step of the forecast, and a tick of the sequencer. Every answer is told as a word.
 *
 * The measured attitudes are those of the mission's own strategy; the tracker begins with the spin a
 * little off, so that it has something to correct.
 */
#include "day.h"

#include "gyrfalcon.h"

#define SECOND INT64_C(1000000000)
#define CYCLE_S 10
#define DAY_S 86400
#define TELESCOPES 3u
/* 2^-18 turn: 24 microradians. */
#define SPIN_ERROR (UINT64_C(1) << 46)

/* All that flies, in memory that needs no initial values. */
static gyr_tables_t tables;
static gyr_clock_t correlation;
static gyr_strategy_t mission;
static gyr_strategy_t believed;
static gyr_tracker_t tracker;
static gyr_finder_t finder;
static gyr_forecast_t forecast;
static gyr_sequencer_t sequencer;
static gyr_visit_log_t visit_log;

static void tell(const char *name, uint64_t word) {
    day_tell(name, word);
}

static void tell_signed(const char *name, int64_t value) {
    day_tell(name, (uint64_t)value);
}

static void tell_real(const char *name, double value) {
    union {
        double value;
        uint64_t bits;
    } word;
    word.value = value;
    day_tell(name, word.bits);
}

static void tell_reals(const char *name, const double *values, unsigned count) {
    unsigned i;
    for (i = 0; i < count; i++) {
        tell_real(name, values[i]);
    }
}

static void tell_quaternion(const char *name, const gyr_quaternion_t *q) {
    tell_real(name, q->x);
    tell_real(name, q->y);
    tell_real(name, q->z);
    tell_real(name, q->w);
}

/* Returns from the function with the code of a call that did not answer GYR_OK. */
#define MUST(call)                                                                                 \
    do {                                                                                           \
        const gyr_error_t code_ = (call);                                                          \
        if (code_ != GYR_OK) {                                                                     \
            return code_;                                                                          \
        }                                                                                          \
    } while (0)

/* Takes the newest sound container of two slots; here B is empty. */
static gyr_error_t take_tables(const day_input_t *input, gyr_header_t *header) {
    gyr_slots_t slots;
    uint32_t slot;
    uint32_t index;
    gyr_session_t session;
    slots.a = input->container;
    slots.a_length = input->container_length;
    slots.b = NULL;
    slots.b_length = 0;
    MUST(gyr_slots_active(&slots, &slot, &tables));
    MUST(gyr_tables_header(&tables, header));
    tell("slot", slot);
    tell("sequence", header->sequence);
    tell("digest", header->set_digest);
    tell_signed("valid from", header->valid_from_tai_ns);
    tell_signed("valid until", header->valid_until_tai_ns);
    tell("telescopes", header->telescopes);
    for (index = 0; gyr_tables_session(&tables, index, &session) == GYR_OK; index++) {
        tell_signed("session's start", session.start_tai_ns);
        tell_signed("session's first entry", session.first_entry_tai_ns);
        tell_signed("session's last exit", session.last_exit_tai_ns);
        tell_signed("session's end", session.end_tai_ns);
        tell_signed("session's body", session.body);
        tell("session's telescope", session.telescope);
        tell("session's passes", session.passes);
    }
    /* The same container again is not newer. */
    tell("admitted", (uint64_t)gyr_slots_admit(&slots, input->container, input->container_length,
                                               header->valid_from_tai_ns, &slot));
    return GYR_OK;
}

/* What is refused, and that it is. */
static gyr_error_t show_refusals(const gyr_header_t *header) {
    static gyr_strategy_t never;
    gyr_quaternion_t boresight;
    const int64_t at = header->valid_from_tai_ns;
    const int64_t beyond = INT64_MAX;
    never.opaque[0] = UINT64_C(0x5555555555555555);
    tell("null", (uint64_t)gyr_attitude(NULL, &tables, at, &boresight));
    tell("no place", (uint64_t)gyr_attitude(&mission, &tables, at, NULL));
    tell("never made", (uint64_t)gyr_attitude(&never, &tables, at, &boresight));
    never = mission;
    tell("copied", (uint64_t)gyr_attitude(&never, &tables, at, &boresight));
    tell("out of span", (uint64_t)gyr_attitude(&mission, &tables, beyond, &boresight));
    return GYR_OK;
}

/* Attitude, sweep of each telescope's line of sight and half-wave plate once a minute. */
static gyr_error_t show_attitudes(const gyr_header_t *header) {
    int64_t second;
    for (second = 0; second < DAY_S; second += 60) {
        const int64_t at = header->valid_from_tai_ns + second * SECOND;
        gyr_phases_t phases;
        gyr_quaternion_t boresight;
        uint16_t index;
        MUST(gyr_strategy_phases(&mission, at, &phases));
        MUST(gyr_attitude(&mission, &tables, at, &boresight));
        tell("precession", phases.precession);
        tell("spin", phases.spin);
        tell("spin turns", phases.spin_turns);
        tell_quaternion("boresight", &boresight);
        for (index = 0; index < header->telescopes && index < TELESCOPES; index++) {
            gyr_telescope_t telescope;
            gyr_sweep_t sweep;
            uint64_t plate;
            MUST(gyr_tables_telescope(&tables, index, &telescope));
            MUST(gyr_sweep(&mission, &tables, &telescope.rotation, at, &sweep));
            tell_quaternion("telescope", &sweep.attitude);
            tell_reals("line of sight", sweep.direction_xyz, 3);
            tell_real("crossing angle", sweep.crossing_angle_rad);
            tell_real("speed", sweep.speed_rad_s);
            tell_real("scan-beam angle", sweep.scan_beam_angle_rad);
            if (telescope.has_hwp) {
                MUST(gyr_hwp_phase(&mission, &telescope.hwp, at, &plate));
                tell("half-wave plate", plate);
                tell_real("half-wave plate", gyr_phase_rad(plate));
            }
        }
    }
    return GYR_OK;
}

/* The targets of the plan's first sessions, each through its telescope, for a day. */
static uint32_t channels(const gyr_header_t *header, gyr_channel_t *found) {
    uint32_t count = 0;
    uint32_t index;
    gyr_session_t session;
    for (index = 0; gyr_tables_session(&tables, index, &session) == GYR_OK; index++) {
        uint32_t known;
        for (known = 0; known < count; known++) {
            if (found[known].body == session.body && found[known].telescope == session.telescope) {
                break;
            }
        }
        if (known == count && count < GYR_CHANNELS) {
            found[count].from_tai_ns = header->valid_from_tai_ns;
            found[count].until_tai_ns = header->valid_from_tai_ns + DAY_S * SECOND;
            found[count].body = session.body;
            found[count].telescope = session.telescope;
            found[count].field = 0;
            count++;
        }
    }
    return count;
}

static void tell_transit(const gyr_transit_t *transit) {
    tell("channel", transit->channel);
    tell_signed("entry", transit->entry_tai_ns);
    tell_signed("closest", transit->closest_tai_ns);
    tell_signed("exit", transit->exit_tai_ns);
    tell_real("separation", transit->min_separation_rad);
    tell("clipped", transit->entry_clipped * 2 + transit->exit_clipped);
}

/* Every transit of the day, counted by target. */
static gyr_error_t find_transits(const gyr_header_t *header) {
    const gyr_divisions_t divisions = {
        {GYR_BINS_LINEAR, 0.0, 20.0},
        {GYR_BINS_LOGARITHMIC, 1.0, 1e6},
        {GYR_BINS_LOGARITHMIC, 1.0, 1e6},
    };
    gyr_channel_t wanted[GYR_CHANNELS];
    const uint32_t count = channels(header, wanted);
    gyr_step_t step;
    uint32_t index;
    MUST(gyr_visit_log_init(&visit_log, &divisions));
    MUST(gyr_finder_init(&finder, &tables));
    for (index = 0; index < count; index++) {
        MUST(gyr_finder_add(&finder, &tables, &mission, &wanted[index]));
    }
    do {
        MUST(gyr_finder_step(&finder, &tables, &step));
        if (step.kind == GYR_STEP_TRANSIT) {
            tell_transit(&step.transit);
            MUST(gyr_visit_log_record(&visit_log, step.transit.channel, &step.transit));
        }
    } while (step.kind != GYR_STEP_DONE);
    for (index = 0; index < count; index++) {
        gyr_target_visits_t visits;
        unsigned bin;
        MUST(gyr_visit_log_get(&visit_log, index, &visits));
        tell("visits", visits.visits);
        tell_signed("dwell", visits.dwell_sum_ns);
        tell_signed("longest gap", visits.longest_gap_ns);
        for (bin = 0; bin < GYR_VISIT_BINS; bin++) {
            tell("dwells", visits.dwell.counts[bin]);
            tell("revisits", visits.revisit.counts[bin]);
        }
    }
    return GYR_OK;
}

/* The mission's strategy with the spin a little off. */
static gyr_error_t believe(void) {
    gyr_scan_t parameters;
    MUST(gyr_strategy_parameters(&mission, &parameters));
    parameters.spin.start += SPIN_ERROR;
    return gyr_strategy_init(&believed, &parameters);
}

static gyr_error_t prepare(const gyr_header_t *header) {
    static const gyr_tracker_settings_t settings = {
        {1e-3, 1e-4, 1e-3}, /* angle_sigmas_rad */
        {1e-6, 1e-6},       /* rate_sigmas */
        {0.0, 0.0, 0.0},    /* angle_walks */
        {0.0, 0.0},         /* rate_walks */
        60 * SECOND,        /* max_age_ns */
        SECOND,             /* max_lead_ns */
        100.0,              /* gate */
        {0.01, 0.01, 0.01}, /* limits_rad */
    };
    gyr_sequencer_settings_t how;
    gyr_channel_t wanted[GYR_CHANNELS];
    const uint32_t count = channels(header, wanted);
    uint32_t index;
    how.tolerance_ns = SECOND;
    how.longest_gap_ns = 2 * CYCLE_S * SECOND;
    how.check_ahead_ns = 3600 * SECOND;
    how.telescope = count > 0 ? wanted[0].telescope : 0;
    how.passes_tolerance = 0;
    how.steps_per_tick = 8;
    MUST(believe());
    MUST(gyr_tracker_init(&tracker, &believed, &settings, header->valid_from_tai_ns));
    MUST(gyr_forecast_init(&forecast, &tables));
    for (index = 0; index < count; index++) {
        MUST(gyr_forecast_add(&forecast, &tables, &believed, &wanted[index]));
    }
    MUST(gyr_sequencer_init(&sequencer, &how));
    return gyr_sequencer_resume(&sequencer);
}

/* A measured attitude, and what the tracker made of it. */
static gyr_error_t measure(int64_t now) {
    gyr_measurement_t measurement;
    gyr_residuals_t residuals;
    gyr_covariance_t covariance;
    measurement.at_tai_ns = now;
    measurement.sigma_rad = 1e-5;
    MUST(gyr_attitude(&mission, &tables, now, &measurement.attitude));
    MUST(gyr_tracker_update(&tracker, &tables, &measurement, now, &residuals));
    MUST(gyr_tracker_covariance(&tracker, now, &covariance));
    tell_reals("innovation", residuals.innovation_rad, 3);
    tell_real("chi2", residuals.chi2);
    tell_reals("variance", covariance.variances, 3);
    return GYR_OK;
}

static void tell_state(const gyr_state_t *state) {
    tell("state", state->kind);
    tell("state's session", state->session);
    tell("state's reason", (uint64_t)state->reason);
    tell_signed("state's value", state->value);
}

static gyr_error_t tick(uint64_t ticks) {
    gyr_situation_t situation;
    gyr_tick_t brought;
    gyr_event_t event;
    gyr_error_t code;
    situation.ticks = ticks;
    situation.clock = &correlation;
    situation.tables = &tables;
    situation.tracker = &tracker;
    MUST(gyr_sequencer_tick(&sequencer, &situation, &brought));
    tell_state(&brought.state);
    tell("evaluations", brought.evaluations);
    while ((code = gyr_sequencer_pop(&sequencer, &event)) == GYR_OK) {
        tell("event", event.kind);
        tell("event's ticks", event.ticks);
        tell("event's session", event.session);
        tell("event's reason", (uint64_t)event.reason);
        tell_signed("event's value", event.value);
        if (event.kind == GYR_EVENT_ENTERED) {
            tell_state(&event.state);
        }
        if (event.kind == GYR_EVENT_STARTED) {
            tell_signed("event's end", event.record.end_tai_ns);
        }
    }
    return code == GYR_NOTHING ? GYR_OK : code;
}

static gyr_error_t predict(bool *going) {
    gyr_forecast_step_t step;
    gyr_next_visit_t next;
    MUST(gyr_forecast_step(&forecast, &tables, &tracker, &step));
    *going = step.kind != GYR_STEP_DONE;
    if (step.kind == GYR_STEP_FOUND) {
        MUST(gyr_forecast_next(&forecast, step.target, &next));
        tell("forecast of", step.target);
        tell_transit(&next.transit);
        tell_real("entry's sigma", next.entry_sigma_s);
        tell_real("probability", next.probability);
        tell_signed("earliest entry", next.earliest_entry_tai_ns);
    }
    return GYR_OK;
}

/* The cycles of the day. */
static gyr_error_t fly(void) {
    bool going = true;
    int64_t second;
    uint32_t dropped;
    for (second = 0; second < DAY_S; second += CYCLE_S) {
        const uint64_t ticks = DAY_FIRST_TICK + (uint64_t)second * DAY_TICKS_PER_S;
        int64_t now;
        MUST(gyr_clock_instant(&correlation, ticks, &now));
        if (second % 60 == 0) {
            MUST(measure(now));
        }
        if (going) {
            MUST(predict(&going));
        }
        MUST(tick(ticks));
    }
    MUST(gyr_sequencer_dropped(&sequencer, &dropped));
    tell("dropped", dropped);
    return GYR_OK;
}

static gyr_error_t day(const day_input_t *input) {
    gyr_header_t header;
    MUST(take_tables(input, &header));
    MUST(gyr_clock_read(input->clock_record, input->clock_length, NULL, &correlation));
    MUST(gyr_strategy_of_tables(&mission, &tables));
    MUST(show_refusals(&header));
    MUST(show_attitudes(&header));
    MUST(find_transits(&header));
    MUST(prepare(&header));
    MUST(fly());
    /* From here on the container's bytes may go: nothing reads them any more. */
    MUST(gyr_tables_unload(&tables));
    tell("unloaded", (uint64_t)gyr_tables_header(&tables, &header));
    return GYR_OK;
}

int day_fly(const day_input_t *input) {
    return (int)day(input);
}
