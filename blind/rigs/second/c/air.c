/* Rotors and the air: thrust and what spoils it, the brake of a dry bearing; and what changes slowly with
 * time. */
#include <math.h>

#include "simulation.h"

enum { MAIN = 0, TAIL = 1 };

/* A number in [0, 1) that looks random and is the same each time for the same key (an integer hash). */
double scatter(int key)
{
    unsigned int x = (unsigned int)key * 2654435761u + 0x9e3779b9u;
    x = (x ^ (x >> 15)) * 0x2c1b3c6du;
    x = (x ^ (x >> 12)) * 0x297a2d39u;
    x ^= x >> 15;
    return x / 4294967296.0;
}

/* v' = -a tanh(v / width) solved exactly over a time t, drop = a t: sinh(v / width) falls by exp(-drop / width). */
double rounded_drop(double v, double drop, double width)
{
    double y = fabs(v) / width;
    if (y > 20.0) {
        double left = y - drop / width;
        return copysign(left > 20.0 ? left * width : width * asinh(0.5 * exp(left)), v);
    }
    return copysign(width * asinh(sinh(y) * exp(-drop / width)), v);
}

static double plain_thrust(const double p[5], double speed)
{
    double w = fabs(speed);
    double force = (((p[4] * w + p[3]) * w + p[2]) * w + p[1]) * w + (w > 0.0 ? p[0] : 0.0);
    return speed < 0.0 ? -force : force;
}

static double bell(double x)
{
    return exp(-x * x);
}

double main_thrust(const rig_t *rig, const effects_t *fx, double speed, double psi_rad, double stale_N)
{
    double force = plain_thrust(rig->thrust[MAIN], speed);
    if (fx->ground != 0.0) {
        /* Cheeseman and Bennett 1955, 1 / (1 - (R / 4 h)^2); the height in units of that at the lower stop. */
        double height = 1.0 + fx->ground_reach * (sin(psi_rad) + sin(rig->stop_rad[0]));
        force /= 1.0 - fx->ground / (1.0 + fx->ground) / (height * height);
    }
    if (fx->flutter != 0.0)
        force *= 1.0 - fx->flutter * bell((speed - fx->flutter_rad_s) / fx->flutter_width_rad_s);
    return force - fx->stale * stale_N;
}

double tail_thrust(const rig_t *rig, const effects_t *fx, double speed, double main_speed, double rate,
                   double chip_factor)
{
    double force = plain_thrust(rig->thrust[TAIL], speed) * chip_factor;
    if (fx->reverse != 0.0 && speed < 0.0) {
        /* Blades turned the wrong way lose (or gain) once the flow is established. */
        double established = speed * speed / (speed * speed + fx->reverse_rad_s * fx->reverse_rad_s);
        force *= 1.0 + fx->reverse * established;
    }
    if (fx->downwash != 0.0)
        force *= exp(-fx->downwash * pow(fabs(main_speed) / 600.0, fx->downwash_power));
    if (fx->vortex != 0.0)
        force *= 1.0 - fx->vortex * bell((rate - fx->vortex_rad_s) / fx->vortex_width_rad_s);
    return force;
}

/* Dry friction of a rotor: more at break-away than when it turns. */
void rotor_brake(const effects_t *fx, state_t *s, double dt)
{
    for (int i = 0; i < 2; i++) {
        double level = fx->dry[i] + fx->seize[i] * (s->t_s > 0.0 ? s->t_s : 0.0);
        if (level <= 0.0)
            continue;
        double slow = s->x[4 + i] / 25.0;
        s->x[4 + i] = rounded_drop(s->x[4 + i], dt * level * (1.0 + 0.4 / (1.0 + slow * slow)), fx->dry_round_rad_s[i]);
    }
}

/* Rises in a straight line over the first part of its time, stays, falls over as long. */
static double trapezium(double phase, double rise)
{
    if (phase <= 0.0 || phase >= 1.0)
        return 0.0;
    double edge = fmin(phase, 1.0 - phase) / rise;
    return edge < 1.0 ? edge : 1.0;
}

/* Kicks of 60 ms, one in each stretch of time, when and which way as it comes. */
static double knocks(double t_s, double size_Nm, double every_s, int key)
{
    int stretch = (int)floor(t_s / every_s);
    double begins = stretch * every_s + scatter(3 * stretch + key) * (every_s - 0.06);
    double phase = (t_s - begins) / 0.06;
    double kick = phase > 0.0 && phase < 1.0 ? sin(M_PI * phase) : 0.0;
    return size_Nm * kick * (scatter(5 * stretch + 11 + key) < 0.5 ? -1.0 : 1.0);
}

static double dipped(const effects_t *fx, int i, double t_s)
{
    if (fx->dip[i] == 0.0)
        return 1.0;
    int stretch = (int)floor(t_s / fx->dip_every_s[i]);
    double room = fx->dip_every_s[i] - fx->dip_long_s[i];
    double begins = stretch * fx->dip_every_s[i] + fx->dip_spread[i] * scatter(7 * stretch + i) * room;
    return t_s >= begins && t_s < begins + fx->dip_long_s[i] ? 1.0 - fx->dip[i] : 1.0;
}

/* What depends on nothing but the time. */
void weather(const effects_t *fx, state_t *s)
{
    double t = s->t_s > 0.0 ? s->t_s : 0.0;
    for (int i = 0; i < 2; i++) {
        s->warm_factor[i] = 1.0;
        if (fx->warm[i] != 0.0) {
            /* The winding warms in seconds, the case around it in minutes. */
            double winding = 1.0 - exp(-t / fx->warm_fast_s[i]), around = 1.0 - exp(-t / fx->warm_slow_s[i]);
            s->warm_factor[i] -= fx->warm[i] * (fx->warm_share[i] * winding + (1.0 - fx->warm_share[i]) * around);
        }
        s->dip_factor[i] = dipped(fx, i, s->t_s);
        s->outer_Nm[i] = fx->drift_Nm_s[i] * t;
        double phase = fx->pulse_s[i] > 0.0 ? (s->t_s - fx->pulse_start_s[i]) / fx->pulse_s[i] : 0.0;
        s->outer_Nm[i] += fx->pulse_Nm[i] * trapezium(phase, fx->pulse_rise[i]);
        if (fx->knock_Nm[i] != 0.0)
            s->outer_Nm[i] += knocks(s->t_s, fx->knock_Nm[i], fx->knock_every_s[i], i);
    }
    s->chip_factor = fx->chip != 0.0 && s->t_s >= fx->chip_time_s ? 1.0 - fx->chip : 1.0;
    s->gravity_factor = 1.0;
    if (fx->weight != 0.0) {
        /* A weight that slides: slow at first, fast in the middle, slow at the end. */
        double part = fmin(fmax((s->t_s - fx->weight_time_s) / fx->weight_ramp_s, 0.0), 1.0);
        s->gravity_factor += fx->weight * 0.5 * (1.0 - cos(M_PI * part));
    }
}
