/* From the commanded voltage to the voltage that turns a rotor. */
#include <math.h>

#include "simulation.h"

static double clamp(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

void commands_send(state_t *s, const double u_V[2])
{
    for (int rotor = 0; rotor < 2; rotor++)
        line_send(&s->line[rotor], s->t_s, 0.0, u_V[rotor]);
}

void commands_settle(state_t *s, const double u_V[2])
{
    for (int i = 0; i < 2; i++)
        s->line[i].now_V = s->slewed_V[i] = s->lagged_V[i] = s->played_V[i] = u_V[i];
    s->load_V = fabs(u_V[0]) + fabs(u_V[1]);
}

double slewed(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    return s->slewed_V[i] += clamp(u - s->slewed_V[i], -fx->slew_V_s[i] * dt, fx->slew_V_s[i] * dt);
}

double lagged(const effects_t *fx, state_t *s, int i, double u, double dt)
{
    return s->lagged_V[i] += (u - s->lagged_V[i]) * dt / (fx->lag_s[i] + dt);
}

/* Dead band with rounded knees: w ln(1 + exp((|u| - d) / w)), d subtracted far outside, almost nothing inside. */
double dead_band(const effects_t *fx, int i, double u)
{
    double d = fx->dead_V[i], w = fx->dead_width[i] * d;
    double excess = (fabs(u) - d) / w;
    double kept = excess > 30.0 ? excess : log1p(exp(excess));
    double at_zero = log1p(exp(-d / w));
    return copysign(w * (kept - at_zero), u);
}

/* Limit with a rounded corner, (1 + |u/L|^12)^(-1/12). */
double limited(const effects_t *fx, int i, double u)
{
    double x = fabs(u) / fx->limit_V[i];
    double x2 = x * x, x4 = x2 * x2, x12 = x4 * x4 * x4;
    return u / pow(1.0 + x12, 1.0 / 12.0);
}

double sagged(const effects_t *fx, const state_t *s, int i, double u)
{
    return u * (1.0 - fx->sag[i] * s->load_V / 10.0);
}

double driver_output(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double dt)
{
    double came = line_arrived(&s->line[rotor], s->t_s, fx->delay_s[rotor], 0.0);
    double u = clamp(came, rig->u_min_V[rotor], rig->u_max_V[rotor]);
    if (fx->step_V[rotor] > 0.0)
        u = fx->step_V[rotor] * floor(u / fx->step_V[rotor] + 0.5);
    if (fx->play_V[rotor] > 0.0)
        u = s->played_V[rotor] = clamp(s->played_V[rotor], u - fx->play_V[rotor], u + fx->play_V[rotor]);
    u = stages(fx, s, rotor, u, dt);
    if (fx->current_V[rotor] > 0.0) {
        double back_V = rotor_damping(rig, rotor, s->omega[rotor]) * s->omega[rotor] / rig->drive[rotor];
        u = clamp(u, back_V - fx->current_V[rotor], back_V + fx->current_V[rotor]);
    }
    return u;
}
