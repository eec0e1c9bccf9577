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

/* Dead band with rounded knees: w ln(1 + exp((|u| - d) / w)), d subtracted far outside, almost nothing inside. */
static double dead_band(double u, double d, double w)
{
    double excess = (fabs(u) - d) / w;
    double kept = excess > 30.0 ? excess : log1p(exp(excess));
    double at_zero = log1p(exp(-d / w));
    return copysign(w * (kept - at_zero), u);
}

/* Limit with a rounded corner, (1 + |u/L|^12)^(-1/12). */
static double soft_limit(double u, double limit)
{
    double x = fabs(u) / limit;
    double x2 = x * x, x4 = x2 * x2, x12 = x4 * x4 * x4;
    return u / pow(1.0 + x12, 1.0 / 12.0);
}

static double motor_voltage(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double u)
{
    if (fx->dead_V[rotor] > 0.0)
        u = dead_band(u, fx->dead_V[rotor], fx->dead_width[rotor] * fx->dead_V[rotor]);
    if (fx->limit_V[rotor] > 0.0)
        u = soft_limit(u, fx->limit_V[rotor]);
    if (fx->sag[rotor] != 0.0)
        u *= 1.0 - fx->sag[rotor] * s->load_V / 10.0;
    if (fx->current_V[rotor] > 0.0) {
        double back_V = rotor_damping(rig, rotor, s->omega[rotor]) * s->omega[rotor] / rig->drive[rotor];
        u = clamp(u, back_V - fx->current_V[rotor], back_V + fx->current_V[rotor]);
    }
    return u;
}

double driver_output(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double dt)
{
    double came = line_arrived(&s->line[rotor], s->t_s, fx->delay_s[rotor], 0.0);
    double u = clamp(came, rig->u_min_V[rotor], rig->u_max_V[rotor]);
    if (fx->step_V[rotor] > 0.0)
        u = fx->step_V[rotor] * floor(u / fx->step_V[rotor] + 0.5);
    if (fx->play_V[rotor] > 0.0)
        u = s->played_V[rotor] = clamp(s->played_V[rotor], u - fx->play_V[rotor], u + fx->play_V[rotor]);
    if (fx->slew_V_s[rotor] > 0.0)
        u = s->slewed_V[rotor] += clamp(u - s->slewed_V[rotor], -fx->slew_V_s[rotor] * dt, fx->slew_V_s[rotor] * dt);
    if (fx->lag_s[rotor] > 0.0)
        u = s->lagged_V[rotor] += (u - s->lagged_V[rotor]) * dt / (fx->lag_s[rotor] + dt);
    return motor_voltage(rig, fx, s, rotor, u);
}
