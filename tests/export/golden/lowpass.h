/* Stage lowpass, written by rotatum.
 * SI units; fields name theirs. Compile with -ffp-contract=off -frounding-math. */

#ifndef LOWPASS_H
#define LOWPASS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A low-pass with all poles at one place. */
typedef struct lowpass_params {
    double pole;   /* discrete pole, exp(-cutoff * period); a */
    int64_t order; /* 1 or 2 equal poles in cascade */
} lowpass_params_t;

/* Memory of a low-pass. */
typedef struct lowpass_state {
    double first;  /* after the first pole; x_1 */
    double second; /* after the second pole; x_2 */
    int64_t count; /* samples since reset */
} lowpass_state_t;

/* One number. */
typedef struct lowpass_sample {
    double x; /* signal */
} lowpass_sample_t;

typedef lowpass_sample_t lowpass_input_t;
typedef lowpass_sample_t lowpass_output_t;

/* Put a state, whatever it holds, into its initial values. */
void lowpass_init(const lowpass_params_t *params, lowpass_state_t *state);

/* Take one sample of one joint. Allocates nothing and always returns. */
void lowpass_step(const lowpass_params_t *params, lowpass_state_t *state, const lowpass_input_t *u,
        lowpass_output_t *out);

#ifdef __cplusplus
}
#endif

#endif /* LOWPASS_H */
