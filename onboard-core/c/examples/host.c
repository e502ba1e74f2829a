/* The day on a host: day CONTAINER CLOCK_RECORD NEWER_CONTAINER ORDER, a line with a name and a word
 * each on stdout. */
#include "day.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define LARGEST (1 << 20)

void day_tell(const char *name, uint64_t word) {
    printf("%s %016" PRIx64 "\n", name, word);
}

/* The file's bytes, aligned for anything; none where it cannot be read. */
static uint8_t *read_file(const char *path, size_t *length) {
    uint8_t *bytes = malloc(LARGEST);
    FILE *file = fopen(path, "rb");
    if (bytes == NULL || file == NULL) {
        return NULL;
    }
    *length = fread(bytes, 1, LARGEST, file);
    fclose(file);
    return bytes;
}

int main(int count, char **arguments) {
    day_input_t input;
    int code;
    if (count != 5) {
        fprintf(stderr, "usage: day CONTAINER CLOCK_RECORD NEWER_CONTAINER ORDER\n");
        return 2;
    }
    input.container = read_file(arguments[1], &input.container_length);
    input.clock_record = read_file(arguments[2], &input.clock_length);
    input.newer = read_file(arguments[3], &input.newer_length);
    input.order = read_file(arguments[4], &input.order_length);
    if (input.container == NULL || input.clock_record == NULL || input.newer == NULL ||
        input.order == NULL) {
        fprintf(stderr, "day: a file cannot be read\n");
        return 2;
    }
    code = day_fly(&input);
    if (code != 0) {
        fprintf(stderr, "day: code %d\n", code);
        return 1;
    }
    return 0;
}
