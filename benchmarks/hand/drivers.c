/* Loops around a step and compiled together with it. Defined on the command line: SOURCE, the file;
 * PARAMS, STATE, INPUT, OUTPUT, the types; INIT and STEP, the functions. */

#define _POSIX_C_SOURCE 199309L

#include SOURCE

#include <stddef.h>
#include <stdint.h>
#include <time.h>

const size_t sizes[4] = {sizeof(PARAMS), sizeof(STATE), sizeof(INPUT), sizeof(OUTPUT)};

void start(const PARAMS *params, STATE *state);
void run(const PARAMS *params, STATE *state, const INPUT *u, OUTPUT *out, int64_t samples);
void run_timed(const PARAMS *params, STATE *state, const INPUT *u, OUTPUT *out, int64_t samples,
               int64_t *nanoseconds);

void start(const PARAMS *params, STATE *state)
{
    INIT(params, state);
}

void run(const PARAMS *params, STATE *state, const INPUT *u, OUTPUT *out, int64_t samples)
{
    for (int64_t k = 0; k < samples; ++k) {
        STEP(params, state, &u[k], &out[k]);
    }
}

static int64_t now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return INT64_C(1000000000) * t.tv_sec + t.tv_nsec;
}

/* The time of each step, with the cost of reading the clock. */
void run_timed(const PARAMS *params, STATE *state, const INPUT *u, OUTPUT *out, int64_t samples,
               int64_t *nanoseconds)
{
    for (int64_t k = 0; k < samples; ++k) {
        int64_t before = now();
        STEP(params, state, &u[k], &out[k]);
        nanoseconds[k] = now() - before;
    }
}
