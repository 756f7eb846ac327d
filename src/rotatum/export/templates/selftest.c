/* Written by rotatum. Runs stage @NAME@ on recorded inputs and compares what it computes with
 * what Python computed, bit for bit; with --tolerance 1e-9 to within that part of each output's
 * largest value so far, for a machine with another libm.
 *
 *     ./selftest test_vector.bin [--tolerance T]
 *
 * Exit code 0: equal; 1: different; 2: the vector cannot be read. */

#include "@NAME@.h"
#include "@NAME@_params.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IN_WORDS @IN_WORDS@
#define OUT_WORDS @OUT_WORDS@
#define HEADER_WORDS 8

static const char *const FIELDS[OUT_WORDS] = {
@FIELDS@
};
static const char KINDS[] = "@KINDS@"; /* per output: f a double, i an int64_t */

typedef struct {
    uint64_t samples, block, head, stride;
    double tolerance;
    uint64_t compared, different;
    double peak[OUT_WORDS];
} test_t;

static double as_double(uint64_t word)
{
    double x;
    memcpy(&x, &word, sizeof x);
    return x;
}

/* Every NaN is the same NaN. */
static uint64_t canonical(uint64_t word, char kind)
{
    if (kind == 'f' && isnan(as_double(word))) {
        return UINT64_C(0x7ff8000000000000);
    }
    return word;
}

static int read_words(FILE *file, uint64_t *words, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        unsigned char bytes[8];
        if (fread(bytes, 1, 8, file) != 8) {
            return 0;
        }
        words[i] = 0;
        for (int b = 7; b >= 0; --b) {
            words[i] = (words[i] << 8) | bytes[b];
        }
    }
    return 1;
}

static int equal(test_t *test, int field, uint64_t got, uint64_t wanted)
{
    if (test->tolerance < 0.0 || KINDS[field] == 'i') {
        return got == wanted;
    }
    double x = as_double(got), y = as_double(wanted);
    if (isfinite(y) && fabs(y) > test->peak[field]) {
        test->peak[field] = fabs(y);
    }
    return got == wanted || fabs(x - y) <= test->tolerance * test->peak[field];
}

static void show(uint64_t word, char kind)
{
    if (kind == 'i') {
        printf("%" PRId64, (int64_t)word);
    } else {
        printf("%.17g (%a)", as_double(word), as_double(word));
    }
}

static void compare(
    test_t *test, uint64_t sample, int joint, const uint64_t *got, const uint64_t *wanted)
{
    for (int f = 0; f < OUT_WORDS; ++f) {
        uint64_t y = canonical(wanted[f], KINDS[f]);
        ++test->compared;
        if (!equal(test, f, got[f], y) && test->different++ < 10) {
            printf("sample %" PRIu64 ", joint %d, field %s: C ", sample, joint, FIELDS[f]);
            show(got[f], KINDS[f]);
            printf(", reference ");
            show(y, KINDS[f]);
            printf("\n");
        }
    }
}

/* FNV-1a over words, folded so that high bits matter too. */
static uint64_t digest(uint64_t hash, const uint64_t *words)
{
    for (int f = 0; f < OUT_WORDS; ++f) {
        hash = (hash ^ words[f]) * UINT64_C(0x100000001b3);
        hash ^= hash >> 32;
    }
    return hash;
}

/* Runs every sample; returns 0 when the file ends too early. */
static int run(test_t *test, FILE *file)
{
    static @NAME@_state_t state[@NAME_UPPER@_JOINTS];
    uint64_t in[IN_WORDS], got[OUT_WORDS], wanted[OUT_WORDS], hash = 0;
    for (int j = 0; j < @NAME_UPPER@_JOINTS; ++j) {
        @NAME@_init(&@NAME@_params[j], &state[j]);
    }
    for (uint64_t k = 0; k < test->samples; ++k) {
        int stored = k < test->head || k % test->stride == 0;
        if (k % test->block == 0) {
            hash = UINT64_C(0xcbf29ce484222325);
        }
        for (int j = 0; j < @NAME_UPPER@_JOINTS; ++j) {
            @NAME@_input_t u;
            @NAME@_output_t out;
            memset(&out, 0, sizeof out);
            if (!read_words(file, in, IN_WORDS)) {
                return 0;
            }
            memcpy(&u, in, sizeof u);
            @NAME@_step(&@NAME@_params[j], &state[j], &u, &out);
            memcpy(got, &out, sizeof out);
            for (int f = 0; f < OUT_WORDS; ++f) {
                got[f] = canonical(got[f], KINDS[f]);
            }
            hash = digest(hash, got);
            if (stored) {
                if (!read_words(file, wanted, OUT_WORDS)) {
                    return 0;
                }
                compare(test, k, j, got, wanted);
            }
        }
        if ((k + 1) % test->block == 0 || k + 1 == test->samples) {
            uint64_t reference;
            if (!read_words(file, &reference, 1)) {
                return 0;
            }
            if (test->tolerance < 0.0 && hash != reference && test->different == 0) {
                printf("samples %" PRIu64 " to %" PRIu64 ": an output that is not stored differs\n",
                       k / test->block * test->block, k);
                ++test->different;
            }
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    test_t test = {.tolerance = -1.0};
    uint64_t header[HEADER_WORDS];
    if (argc == 4 && strcmp(argv[2], "--tolerance") == 0) {
        test.tolerance = atof(argv[3]);
    } else if (argc != 2) {
        fprintf(stderr, "usage: %s test_vector.bin [--tolerance T]\n", argv[0]);
        return 2;
    }
    FILE *file = fopen(argv[1], "rb");
    if (file == NULL || !read_words(file, header, HEADER_WORDS)
        || header[0] != UINT64_C(@MAGIC@) || header[1] != @NAME_UPPER@_JOINTS
        || header[3] != IN_WORDS || header[4] != OUT_WORDS
        || sizeof(@NAME@_input_t) != 8 * IN_WORDS || sizeof(@NAME@_output_t) != 8 * OUT_WORDS) {
        fprintf(stderr, "%s is not a test vector of @NAME@\n", argv[1]);
        return 2;
    }
    test.samples = header[2];
    test.block = header[5];
    test.head = header[6];
    test.stride = header[7];
    if (!run(&test, file)) {
        fprintf(stderr, "%s ends too early\n", argv[1]);
        return 2;
    }
    fclose(file);
    printf("@NAME@: %" PRIu64 " samples of %d joint(s), ", test.samples, @NAME_UPPER@_JOINTS);
    if (test.tolerance < 0.0) {
        printf("all %" PRIu64 " values compared bit for bit (%" PRIu64 " one by one): ",
               test.samples * @NAME_UPPER@_JOINTS * OUT_WORDS, test.compared);
    } else {
        printf("%" PRIu64 " values compared to within %g: ", test.compared, test.tolerance);
    }
    printf(test.different == 0 ? "equal\n" : "DIFFERENT\n");
    return test.different == 0 ? 0 : 1;
}
