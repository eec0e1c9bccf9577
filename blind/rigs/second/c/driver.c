/* From the commands sent to the voltages that turn the rotors. */
#include <math.h>

#include "simulation.h"

static double within(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

/* Both inputs are late alike. */
void commands_send(state_t *s, const double u_V[2])
{
    double luck = 2.0 * scatter(s->sent++) - 1.0;
    for (int i = 0; i < 2; i++)
        line_send(&s->line[i], s->t_s, luck, u_V[i]);
}

void commands_settle(state_t *s, const double u_V[2])
{
    for (int i = 0; i < 2; i++)
        s->line[i].now_V = s->stepped_V[i] = s->slewed_V[i] = s->first_V[i] = s->second_V[i] = u_V[i];
    s->load_V = fabs(u_V[0]) + fabs(u_V[1]);
}

/* Steps with a memory: the level changes only once the command is clearly nearer to another. */
static double stepped(const effects_t *fx, state_t *s, int i, double u)
{
    double q = fx->step_V[i];
    if (fabs(u - s->stepped_V[i]) > q * (0.5 + fx->step_hold[i]))
        s->stepped_V[i] = q * round(u / q);
    return s->stepped_V[i];
}

double slewed(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    double up = fx->slew_V_s[i] * (1.0 + fx->slew_skew[i]), down = fx->slew_V_s[i] * (1.0 - fx->slew_skew[i]);
    s->slewed_V[i] += within(u - s->slewed_V[i], -down * dt, up * dt);
    return s->slewed_V[i];
}

/* Two lags in a row that share the time between them. */
double lagged(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    double first_s = fx->lag_s[i] * fx->lag_split[i], second_s = fx->lag_s[i] - first_s;
    s->first_V[i] += (u - s->first_V[i]) * -expm1(-dt / first_s);
    s->second_V[i] += (s->first_V[i] - s->second_V[i]) * -expm1(-dt / second_s);
    return s->second_V[i];
}

/* Nothing up to d (1 - knee), a parabola up to d (1 + knee), |u| - d beyond; d differs a little between the signs. */
double dead_band(const effects_t *fx, int i, double u)
{
    double d = fx->dead_V[i] * (u > 0.0 ? 1.0 + fx->dead_skew[i] : 1.0 - fx->dead_skew[i]);
    double from = d * (1.0 - fx->dead_knee[i]), to = d * (1.0 + fx->dead_knee[i]), size = fabs(u);
    double kept = size <= from ? 0.0 : (size >= to ? size - d : (size - from) * (size - from) / (2.0 * (to - from)));
    return copysign(kept, u);
}

/* Straight up to a knee, then towards the limit as a tanh. */
double limited(const effects_t *fx, int i, double u)
{
    double room = fx->limit_V[i] * fx->limit_knee[i], knee = fx->limit_V[i] - room, size = fabs(u);
    return size <= knee ? u : copysign(knee + room * tanh((size - knee) / room), u);
}

double sagged(const effects_t *fx, const state_t *s, int i, double u)
{
    return u / (1.0 + fx->sag[i] * s->load_V / 10.0);
}

void driver_step(const rig_t *rig, const effects_t *fx, state_t *s, double dt)
{
    double came[2];
    for (int i = 0; i < 2; i++) {
        double newest = line_arrived(&s->line[i], s->t_s, fx->delay_s[i], fx->delay_spread[i]);
        came[i] = within(newest, rig->u_min_V[i], rig->u_max_V[i]);
    }
    if (fx->supply_s > 0.0)
        s->load_V += (fabs(came[0]) + fabs(came[1]) - s->load_V) * -expm1(-dt / fx->supply_s);
    for (int i = 0; i < 2; i++) {
        double u = came[i] + fx->bias_V[i] + fx->cross[i] * came[1 - i];
        if (fx->step_V[i] > 0.0)
            u = stepped(fx, s, i, u);
        s->volts[i] = stages(fx, s, i, u, dt) * s->dip_factor[i];
    }
}
