/* Written by rotatum from the kernels of stage lowpass; see lowpass.h. */

#include "lowpass.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* rotatum.kernels.lowpass.init: Start empty: the first sample becomes the steady state. */
static inline void init(const lowpass_params_t *params, lowpass_state_t *state)
{
    (void)params;
    state->first = 0.0;
    state->second = 0.0;
    state->count = 0;
}

/* rotatum.kernels.lowpass.smooth: One pole: ``y(k) = a y(k-1) + (1 - a) x(k)``, a = exp(-cutoff
 * T); unit gain at rest. */
static inline double lowpass_smooth(double pole, double before, double x)
{
    return before + (1.0 - pole) * (x - before);
}

/* rotatum.kernels.lowpass.step: Filter one sample. A sample that is not finite leaves the state;
 * the output holds. */
void lowpass_step(const lowpass_params_t *params, lowpass_state_t *state, const lowpass_input_t *u,
        lowpass_output_t *out)
{
    if (u->x - u->x == 0.0) {
        if (state->count == 0) {
            state->first = u->x;
            state->second = u->x;
        }
        state->first = lowpass_smooth(params->pole, state->first, u->x);
        state->second = lowpass_smooth(params->pole, state->second, state->first);
        state->count = state->count + 1;
    }
    if (params->order == 2) {
        out->x = state->second;
    } else {
        out->x = state->first;
    }
}

void lowpass_init(const lowpass_params_t *params, lowpass_state_t *state)
{
    memset(state, 0, sizeof *state);
    init(params, state);
}
