/* The day on a bare Cortex-M: reset, FPU, and the host's files by semihosting.
 *
 * Reads uplink.tbl, clock.rec, newer.tbl and back.rec, writes day.txt with a line of a name and a word each. Ends with the
 * code of day_fly, 254 where a file cannot be used, 255 after a fault. Linked by tests/firmware/link.x
 * and a board's memory.x; needs no C library.
 */
#include "day.h"

#define SYS_OPEN 0x01u
#define SYS_CLOSE 0x02u
#define SYS_WRITE 0x05u
#define SYS_READ 0x06u
#define SYS_EXIT_EXTENDED 0x20u
#define APPLICATION_EXIT 0x20026u
#define READ_BINARY 1u
#define WRITE_BINARY 5u
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

extern unsigned char stack_top[];
void reset(void);

static uint8_t container[1 << 18];
static uint8_t clock_record[128];
static uint8_t newer[1 << 18];
static uint8_t order[128];
static char output[1 << 12];
static uint32_t filled;
static uint32_t handle;
static uint32_t failed;

static uint32_t call(uint32_t operation, const uint32_t *arguments) {
    register uint32_t r0 __asm__("r0") = operation;
    register const uint32_t *r1 __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void finish(uint32_t code) {
    uint32_t arguments[2];
    arguments[0] = APPLICATION_EXIT;
    arguments[1] = code;
    for (;;) {
        call(SYS_EXIT_EXTENDED, arguments);
    }
}

static void fault(void) {
    finish(255);
}

/* The stack, and the handlers of the first fifteen exceptions. */
struct vectors {
    unsigned char *stack;
    void (*handlers[15])(void);
};

extern const struct vectors vectors;
__attribute__((section(".vectors"), used)) const struct vectors vectors = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
     fault},
};

static uint32_t open(const char *name, uint32_t mode) {
    uint32_t arguments[3];
    uint32_t length = 0;
    while (name[length] != '\0') {
        length++;
    }
    arguments[0] = (uint32_t)(uintptr_t)name;
    arguments[1] = mode;
    arguments[2] = length;
    return call(SYS_OPEN, arguments);
}

/* Bytes read; 0 where the file is not there, is empty, or fills the memory. */
static size_t read_file(const char *name, uint8_t *memory, uint32_t size) {
    uint32_t arguments[3];
    uint32_t left;
    arguments[0] = open(name, READ_BINARY);
    arguments[1] = (uint32_t)(uintptr_t)memory;
    arguments[2] = size;
    if (arguments[0] == UINT32_MAX) {
        return 0;
    }
    left = call(SYS_READ, arguments);
    call(SYS_CLOSE, arguments);
    return left > 0 && left <= size ? size - left : 0;
}

static void flush(void) {
    uint32_t arguments[3];
    arguments[0] = handle;
    arguments[1] = (uint32_t)(uintptr_t)output;
    arguments[2] = filled;
    failed |= call(SYS_WRITE, arguments);
    filled = 0;
}

static void put(char letter) {
    if (filled == sizeof output) {
        flush();
    }
    output[filled] = letter;
    filled++;
}

void day_tell(const char *name, uint64_t word) {
    int shift;
    for (; *name != '\0'; name++) {
        put(*name);
    }
    put(' ');
    for (shift = 60; shift >= 0; shift -= 4) {
        put("0123456789abcdef"[(word >> shift) & 15u]);
    }
    put('\n');
}

/* Not inlined, lest it use the FPU before it is on. */
__attribute__((noinline)) static uint32_t run(void) {
    day_input_t input;
    uint32_t code;
    filled = 0;
    failed = 0;
    input.container = container;
    input.container_length = read_file("uplink.tbl", container, sizeof container);
    input.clock_record = clock_record;
    input.clock_length = read_file("clock.rec", clock_record, sizeof clock_record);
    input.newer = newer;
    input.newer_length = read_file("newer.tbl", newer, sizeof newer);
    input.order = order;
    input.order_length = read_file("back.rec", order, sizeof order);
    handle = open("day.txt", WRITE_BINARY);
    if (input.container_length == 0 || input.clock_length == 0 || input.newer_length == 0 ||
        input.order_length == 0 || handle == UINT32_MAX) {
        return 254;
    }
    code = (uint32_t)day_fly(&input);
    flush();
    call(SYS_CLOSE, &handle);
    return failed == 0 ? code : 254;
}

void reset(void) {
    CPACR |= 0xF00000u;
    __asm__ volatile("dsb\n\tisb" : : : "memory");
    finish(run());
}
