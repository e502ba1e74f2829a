/* A day of the mission in an uplinked container, flown by the flight core: what host and target share.
 */
#ifndef DAY_H
#define DAY_H

#include <stddef.h>
#include <stdint.h>

/* The counter at the container's first valid instant, and its ticks in a second: the correlation that
 * is handed in must say the same. */
#define DAY_FIRST_TICK 1000u
#define DAY_TICKS_PER_S 1000000u

/* What the day is flown with. */
typedef struct {
    const uint8_t *container;
    size_t container_length;
    const uint8_t *clock_record;
    size_t clock_length;
    /* A container with the next sequence number, and the order to return from it to the first. */
    const uint8_t *newer;
    size_t newer_length;
    const uint8_t *order;
    size_t order_length;
} day_input_t;

/* Takes a word of the answer, with the name of what it is. Given by the board. */
void day_tell(const char *name, uint64_t word);

/* Flies; 0 when all went well, else the code of the call that did not. */
int day_fly(const day_input_t *input);

#endif
