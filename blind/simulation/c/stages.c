/* The stages of a driver in the order in which a signal passes them, whichever rig: each is there where its effect is, and by the
 * rig's own law. */
#include "simulation.h"

double stages(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    if (fx->slew_V_s[i] > 0.0)
        u = slewed(fx, s, i, u, dt);
    if (fx->lag_s[i] > 0.0)
        u = lagged(fx, s, i, u, dt);
    if (fx->dead_V[i] > 0.0)
        u = dead_band(fx, i, u);
    if (fx->limit_V[i] > 0.0)
        u = limited(fx, i, u);
    if (fx->sag[i] != 0.0)
        u = sagged(fx, s, i, u);
    return u;
}
