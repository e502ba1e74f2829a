/* A day of the mission with the flight core: the example of docs/c-interface.md.
 *
 * It uploads a container into a slot and takes tables from it, correlates the clock, asks for
 * attitudes, searches transits and counts visits, and then flies: each cycle of 10 s the clock, a step
 * of the scrub, once a minute a measured attitude to the tracker, a step of the forecast, and a tick of
 * the sequencer, whose events become telemetry; once an hour housekeeping. Finder, visit log and, at noon, the tracker are made anew and go on from saved records.
 * Then the container is damaged and found out, and a newer one is uploaded and rolled back. Every answer
 * is told as a word. Two arrays stand for the flash.
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
#define SLOT_BYTES (1u << 18)

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
static gyr_scrub_t scrub;
static gyr_upload_t upload;
static gyr_revocation_t revocation;

/* The flash. */
static uint8_t slot_a[SLOT_BYTES];
static uint8_t slot_b[SLOT_BYTES];
static const gyr_slots_t slots = {slot_a, SLOT_BYTES, slot_b, SLOT_BYTES};

/* What outlives a reset. */
static uint8_t saved_tracker[GYR_TRACKER_BYTES];
static uint8_t saved_searches[GYR_CHANNELS][GYR_SEARCH_BYTES];
static uint8_t saved_visits[GYR_CHANNELS][GYR_VISIT_BYTES];

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

/* A record, four bytes a word. */
static void tell_record(const char *name, const uint8_t *bytes, unsigned length) {
    unsigned at;
    for (at = 0; at + 4 <= length; at += 4) {
        const uint32_t low = (uint32_t)bytes[at] | (uint32_t)bytes[at + 1] << 8;
        const uint32_t high = (uint32_t)bytes[at + 2] | (uint32_t)bytes[at + 3] << 8;
        tell(name, high << 16 | low);
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

static void erase(uint8_t *slot) {
    size_t at;
    for (at = 0; at < SLOT_BYTES; at++) {
        slot[at] = 0xff;
    }
}

/* Does to the flash what an operation says; programming only clears bits. */
static void carry_out(const gyr_flash_operation_t *operation) {
    uint8_t *slot = operation->slot == GYR_SLOT_A ? slot_a : slot_b;
    size_t at;
    if (operation->kind == GYR_FLASH_ERASE) {
        erase(slot);
        return;
    }
    for (at = 0; at < GYR_WORD_BYTES; at++) {
        slot[operation->offset + at] &= operation->word[at];
    }
}

/* Brings a container into the slot that is not active. */
static gyr_error_t bring(const uint8_t *container, size_t length, int64_t now) {
    const gyr_bytes_t candidate = {container, length};
    gyr_flash_operation_t operation;
    uint32_t slot;
    uint32_t programmed = 0;
    MUST(gyr_slots_admit(&slots, &candidate, now, &upload));
    MUST(gyr_upload_slot(&upload, &slot));
    tell("written", slot);
    for (;;) {
        MUST(gyr_upload_next(&upload, &slots, &operation));
        if (operation.kind == GYR_FLASH_DONE) {
            break;
        }
        carry_out(&operation);
        programmed += operation.kind == GYR_FLASH_PROGRAM;
    }
    tell("programmed", programmed);
    return GYR_OK;
}

static gyr_error_t tell_slots(void) {
    uint32_t slot;
    for (slot = GYR_SLOT_A; slot <= GYR_SLOT_B; slot++) {
        gyr_slot_state_t state;
        MUST(gyr_slots_state(&slots, slot, &state));
        tell("slot's state", (uint64_t)state.state);
        tell("slot's sequence", state.has_sequence ? state.sequence : 0);
    }
    return GYR_OK;
}

/* Uploads the container into erased flash and takes the tables of the active slot. */
static gyr_error_t take_tables(const day_input_t *input, gyr_header_t *header) {
    gyr_bytes_t again;
    uint32_t slot;
    uint32_t index;
    gyr_session_t session;
    erase(slot_a);
    erase(slot_b);
    MUST(tell_slots());
    tell("none active", (uint64_t)gyr_slots_active(&slots, &slot, &tables));
    MUST(gyr_tables_load(input->container, input->container_length, &tables));
    MUST(gyr_tables_header(&tables, header));
    MUST(gyr_tables_unload(&tables));
    MUST(bring(input->container, input->container_length, header->valid_from_tai_ns));
    MUST(tell_slots());
    MUST(gyr_slots_active(&slots, &slot, &tables));
    MUST(gyr_tables_header(&tables, header));
    tell("slot", slot);
    tell("sequence", header->sequence);
    tell("spacecraft", header->spacecraft);
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
    again.first = input->container;
    again.length = input->container_length;
    tell("admitted",
         (uint64_t)gyr_slots_admit(&slots, &again, header->valid_from_tai_ns, &upload));
    return GYR_OK;
}

/* Brings a newer container, then returns to the one before by the order, once. */
static gyr_error_t go_and_return(const day_input_t *input, const gyr_header_t *header) {
    const int64_t now = header->valid_from_tai_ns;
    gyr_bytes_t order;
    gyr_flash_operation_t operation;
    uint32_t slot;
    order.first = input->order;
    order.length = input->order_length;
    tell("too early", (uint64_t)gyr_slots_roll_back(&slots, &order, now, &revocation));
    MUST(bring(input->newer, input->newer_length, now));
    MUST(tell_slots());
    MUST(gyr_slots_roll_back(&slots, &order, now, &revocation));
    MUST(gyr_revocation_slot(&revocation, &slot));
    tell("revoked", slot);
    for (;;) {
        MUST(gyr_revocation_next(&revocation, &slots, &operation));
        if (operation.kind == GYR_FLASH_DONE) {
            break;
        }
        tell("programmed in", operation.slot);
        tell("programmed at", operation.offset);
        carry_out(&operation);
    }
    MUST(tell_slots());
    tell("again", (uint64_t)gyr_slots_roll_back(&slots, &order, now, &revocation));
    tell("no change of mission",
         (uint64_t)gyr_slots_admit_changed(&slots, &order, &order, now, &upload));
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

/* A finder of the wanted searches. */
static gyr_error_t make_finder(const gyr_channel_t *wanted, uint32_t count) {
    uint32_t index;
    MUST(gyr_finder_init(&finder, &tables));
    for (index = 0; index < count; index++) {
        MUST(gyr_finder_add(&finder, &tables, &mission, &wanted[index]));
    }
    return GYR_OK;
}

/* Saves every search and goes on from the records in a finder made anew. */
static gyr_error_t reset_finder(const gyr_channel_t *wanted, uint32_t count) {
    uint32_t index;
    for (index = 0; index < count; index++) {
        MUST(gyr_finder_save(&finder, index, saved_searches[index], GYR_SEARCH_BYTES));
        tell_record("saved search", saved_searches[index], GYR_SEARCH_BYTES);
    }
    MUST(make_finder(wanted, count));
    for (index = 0; index < count; index++) {
        MUST(gyr_finder_resume(&finder, index, saved_searches[index], GYR_SEARCH_BYTES));
    }
    tell("other search",
         (uint64_t)gyr_finder_resume(&finder, count - 1, saved_searches[0], GYR_SEARCH_BYTES));
    return GYR_OK;
}

/* Saves the visits of every target and goes on from the records in a log made anew. */
static gyr_error_t reset_visits(const gyr_divisions_t *divisions, uint32_t spacecraft,
                                uint32_t count) {
    uint32_t index;
    for (index = 0; index < count; index++) {
        MUST(gyr_visit_log_save(&visit_log, index, spacecraft, saved_visits[index],
                                GYR_VISIT_BYTES));
        tell_record("saved visits", saved_visits[index], GYR_VISIT_BYTES);
    }
    MUST(gyr_visit_log_init(&visit_log, divisions));
    for (index = 0; index < count; index++) {
        MUST(gyr_visit_log_resume(&visit_log, index, spacecraft, saved_visits[index],
                                  GYR_VISIT_BYTES));
    }
    tell("other spacecraft", (uint64_t)gyr_visit_log_resume(&visit_log, 0, spacecraft ^ 1u,
                                                            saved_visits[0], GYR_VISIT_BYTES));
    return GYR_OK;
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
    uint32_t steps = 0;
    uint32_t index;
    MUST(gyr_visit_log_init(&visit_log, &divisions));
    MUST(make_finder(wanted, count));
    do {
        MUST(gyr_finder_step(&finder, &tables, &step));
        if (step.kind == GYR_STEP_TRANSIT) {
            tell_transit(&step.transit);
            MUST(gyr_visit_log_record(&visit_log, step.transit.channel, &step.transit));
        }
        if (++steps == 200) {
            MUST(reset_finder(wanted, count));
            MUST(reset_visits(&divisions, header->spacecraft, count));
        }
    } while (step.kind != GYR_STEP_DONE);
    tell("steps", steps);
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

static const gyr_tracker_settings_t tracker_settings = {
    {1e-3, 1e-4, 1e-3}, /* angle_sigmas_rad */
    {1e-6, 1e-6},       /* rate_sigmas */
    {0.0, 0.0, 0.0},    /* angle_walks */
    {0.0, 0.0},         /* rate_walks */
    60 * SECOND,        /* max_age_ns */
    SECOND,             /* max_lead_ns */
    100.0,              /* gate */
    {0.01, 0.01, 0.01}, /* limits_rad */
};

static gyr_error_t prepare(const gyr_header_t *header) {
    gyr_channel_t wanted[GYR_CHANNELS];
    const uint32_t count = channels(header, wanted);
    const gyr_sequencer_settings_t how = {
        .tolerance_ns = SECOND, .longest_gap_ns = 2 * CYCLE_S * SECOND,
        .check_ahead_ns = 3600 * SECOND, .recheck_rad = 1e-3,
        .telescope = count > 0 ? wanted[0].telescope : 0, .steps_per_tick = 8};
    uint32_t index;
    MUST(believe());
    MUST(gyr_tracker_init(&tracker, &believed, &tracker_settings, header->valid_from_tai_ns));
    MUST(gyr_scrub_init(&scrub, &tables));
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

/* Saves the tracker and goes on from the record in one made anew. */
static gyr_error_t reset_tracker(const gyr_header_t *header) {
    MUST(gyr_tracker_save(&tracker, header->spacecraft, saved_tracker, GYR_TRACKER_BYTES));
    tell_record("saved tracker", saved_tracker, GYR_TRACKER_BYTES);
    MUST(gyr_tracker_init(&tracker, &believed, &tracker_settings, header->valid_from_tai_ns));
    MUST(gyr_tracker_resume(&tracker, header->spacecraft, saved_tracker, GYR_TRACKER_BYTES));
    saved_tracker[100] ^= 1;
    tell("damaged tracker", (uint64_t)gyr_tracker_resume(&tracker, header->spacecraft,
                                                         saved_tracker, GYR_TRACKER_BYTES));
    return GYR_OK;
}

static void tell_state(const gyr_state_t *state) {
    tell("state", state->kind);
    tell("state's session", state->session);
    tell("state's reason", (uint64_t)state->reason);
    tell_signed("state's value", state->value);
}

static gyr_error_t tick(uint64_t ticks, uint32_t damaged, uint32_t spacecraft) {
    uint8_t payload[GYR_EVENT_BYTES];
    const gyr_situation_t situation = {.ticks = ticks, .clock = &correlation, .tables = &tables,
                                       .tracker = &tracker, .tables_damaged = damaged};
    gyr_tick_t brought;
    gyr_event_t event;
    gyr_error_t code;
    MUST(gyr_sequencer_tick(&sequencer, &situation, &brought));
    tell_state(&brought.state);
    tell("evaluations", brought.evaluations);
    tell("check", brought.check);
    while ((code = gyr_telemetry_pop(&sequencer, &correlation, spacecraft, &event, payload,
                                     GYR_EVENT_BYTES)) == GYR_OK) {
        tell_record("telemetry", payload, GYR_EVENT_BYTES);
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

/* Housekeeping of the telescope, in a packet of APID 291. */
static gyr_error_t report(uint64_t ticks, uint32_t spacecraft, uint16_t count) {
    uint8_t packet[GYR_PACKET_HEADER_BYTES + GYR_HOUSEKEEPING_BYTES];
    gyr_next_visit_t next;
    const bool known = gyr_forecast_next(&forecast, 0, &next) == GYR_OK;
    const gyr_housekeeping_t housekeeping = {
        .ticks = ticks, .sequencer = &sequencer, .clock = &correlation, .tables = &tables,
        .tracker = &tracker, .scrub = &scrub, .visit = known ? &next : NULL, .spacecraft = spacecraft};
    MUST(gyr_packet_header(291, count, GYR_HOUSEKEEPING_BYTES, packet, GYR_PACKET_HEADER_BYTES));
    MUST(gyr_telemetry_housekeeping(&housekeeping, packet + GYR_PACKET_HEADER_BYTES,
                                    GYR_HOUSEKEEPING_BYTES));
    tell_record("packet", packet, sizeof packet);
    return GYR_OK;
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
static gyr_error_t fly(const gyr_header_t *header) {
    bool going = true;
    int64_t second;
    for (second = 0; second < DAY_S; second += CYCLE_S) {
        const uint64_t ticks = DAY_FIRST_TICK + (uint64_t)second * DAY_TICKS_PER_S;
        gyr_scrub_step_t scrubbed;
        int64_t now;
        MUST(gyr_clock_instant(&correlation, ticks, &now));
        MUST(gyr_scrub_step(&scrub, &tables, &scrubbed));
        tell("scrub", scrubbed.kind);
        if (second == DAY_S / 2) {
            MUST(reset_tracker(header));
        }
        if (second % 60 == 0) {
            MUST(measure(now));
        }
        if (going) {
            MUST(predict(&going));
        }
        MUST(tick(ticks, 0, header->spacecraft));
        if (second % 3600 == 0) {
            MUST(report(ticks, header->spacecraft, (uint16_t)(second / 3600)));
        }
    }
    return GYR_OK;
}

/* Damages the container's last byte; the scrub finds it, and the sequencer becomes safe. */
static gyr_error_t damage(const day_input_t *input, const gyr_header_t *header) {
    uint8_t *last = &slot_a[GYR_SLOT_HEAD_BYTES + input->container_length - 1];
    gyr_scrub_step_t scrubbed;
    gyr_lost_t lost;
    uint32_t longest;
    uint32_t steps = 0;
    MUST(gyr_scrub_longest(&scrub, &longest));
    tell("longest", longest);
    *last ^= 1;
    do {
        MUST(gyr_scrub_step(&scrub, &tables, &scrubbed));
        steps++;
    } while (scrubbed.kind != GYR_SCRUB_DAMAGED && steps < longest);
    tell("found", scrubbed.kind);
    tell("damage", (uint64_t)scrubbed.damage);
    MUST(tick(DAY_FIRST_TICK + (uint64_t)DAY_S * DAY_TICKS_PER_S, 1, header->spacecraft));
    *last ^= 1;
    MUST(gyr_sequencer_lost(&sequencer, &lost));
    tell("lost", lost.entered + lost.started + lost.ended + lost.skipped + lost.aborted +
                     lost.safe + lost.tables + lost.time_jumped);
    return GYR_OK;
}

static gyr_error_t day(const day_input_t *input) {
    gyr_header_t header;
    gyr_scrub_step_t unused;
    MUST(take_tables(input, &header));
    MUST(gyr_clock_read(input->clock_record, input->clock_length, NULL, header.spacecraft,
                        &correlation));
    MUST(gyr_strategy_of_tables(&mission, &tables));
    MUST(show_refusals(&header));
    MUST(show_attitudes(&header));
    MUST(find_transits(&header));
    MUST(prepare(&header));
    MUST(fly(&header));
    MUST(damage(input, &header));
    /* From here on the slots may change: nothing reads them any more. */
    MUST(gyr_tables_unload(&tables));
    tell("scrub without", (uint64_t)gyr_scrub_step(&scrub, &tables, &unused));
    MUST(go_and_return(input, &header));
    tell("unloaded", (uint64_t)gyr_tables_header(&tables, &header));
    return GYR_OK;
}

int day_fly(const day_input_t *input) {
    return (int)day(input);
}
