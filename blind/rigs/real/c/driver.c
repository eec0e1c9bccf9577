/* From the commands sent to the voltages at the motors. */
#include <math.h>

#include "simulation.h"

void commands_send(state_t *s, const double u_V[2])
{
    for (int i = 0; i < 2; i++)
        line_send(&s->line[i], s->t_s, 0.0, u_V[i]);
}

void commands_settle(state_t *s, const double u_V[2])
{
    for (int i = 0; i < 2; i++)
        s->line[i].now_V = s->slewed_V[i] = s->lagged_V[i] = s->played_V[i] = s->volts[i] = u_V[i];
}

/* log(1 + exp(x)) bends at the band's edge; what it would pass at rest is taken off. */
double dead_band(const effects_t *fx, int i, double u)
{
    double bend = fx->dead_bend[i] * fx->dead_V[i];
    double over = (fabs(u) - fx->dead_V[i]) / bend;
    double kept = bend * (over > 30.0 ? over : log1p(exp(over))) - bend * log1p(exp(-1.0 / fx->dead_bend[i]));
    return copysign(fmax(kept, 0.0), u);
}

/* Soft in a high power. */
double limited(const effects_t *fx, int i, double u)
{
    return u * pow(1.0 + pow(fabs(u) / fx->limit_V[i], fx->limit_power[i]), -1.0 / fx->limit_power[i]);
}

double slewed(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    double gap = u - s->slewed_V[i], most = fx->slew_V_s[i] * dt;
    s->slewed_V[i] += fmin(fmax(gap, -most), most);
    return s->slewed_V[i];
}

/* Faster on the way up than on the way down, or the other way round. */
double lagged(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    double time_s = fx->lag_s[i] * (fabs(u) > fabs(s->lagged_V[i]) ? 1.0 - fx->lag_skew[i] : 1.0 + fx->lag_skew[i]);
    s->lagged_V[i] += (u - s->lagged_V[i]) * -expm1(-dt / time_s);
    return s->lagged_V[i];
}

/* A converter whose steps do not lie at zero. */
static double stepped(const effects_t *fx, int i, double u)
{
    double q = fx->step_V[i];
    return q * (floor(u / q + 0.5 + fx->step_phase[i]) - fx->step_phase[i]);
}

double sagged(const effects_t *fx, const state_t *s, int i, double u)
{
    return u * exp(-fx->sag[i] * s->load);
}

static int dips(const effects_t *fx, int i, double t_s)
{
    double phase = t_s / fx->dip_every_s[i] + fx->dip_phase[i];
    return phase - floor(phase) < fx->dip_long_s[i] / fx->dip_every_s[i];
}

void driver_step(const model_t *m, state_t *s, double dt)
{
    const effects_t *fx = &m->effects;
    double came[2] = {0.0, 0.0};
    s->load = 0.0;
    for (int i = 0; i < m->rig.inputs; i++) {
        double newest = line_arrived(&s->line[i], s->t_s, fx->delay_s[i], 0.0);
        came[i] = fmin(fmax(newest, m->rig.low_V[i]), m->rig.high_V[i]);
        s->load += fabs(came[i]) / 10.0;
    }
    for (int i = 0; i < m->rig.inputs; i++) {
        double u = came[i];
        if (fx->step_V[i] > 0.0)
            u = stepped(fx, i, u);
        if (fx->play_V[i] > 0.0)
            u = s->played_V[i] = fmin(fmax(s->played_V[i], u - 0.5 * fx->play_V[i]), u + 0.5 * fx->play_V[i]);
        u = stages(fx, s, i, u, dt);
        if (fx->power[i] != 0.0)
            u *= pow(fabs(u) / fx->power_V[i] + 1e-12, fx->power[i]);
        if (u < 0.0)
            u *= 1.0 - fx->reverse[i];
        if (fx->dip[i] != 0.0 && dips(fx, i, s->t_s))
            u *= 1.0 - fx->dip[i];
        s->volts[i] = u;
    }
}
