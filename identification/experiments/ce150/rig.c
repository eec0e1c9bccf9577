/* The rig of the simulated experiments: equations (4)-(9) of the paper with mounts, locks, a hand and a counterweight.
 *
 * Written apart from the generated kernels, which it must not resemble: plain Runge-Kutta with small steps, and a step in which a body
 * comes to rest or meets a stop is cut there by the secant of its ends.
 */
#include "rig.h"

#include <math.h>
#include <string.h>

enum { OMEGA_M, PSI, PSI_DOT, OMEGA_T, PHI, PHI_DOT, TURN_M, TURN_T, STATES };
enum { MAX_CUTS = 8 };

static double polynomial(const double *c, int count, double w)
{
    double sum = 0.0;
    for (int i = count - 1; i >= 0; i--)
        sum = sum * w + c[i];
    return sum;
}

static double thrust(const double *c, double w)
{
    return w == 0.0 ? 0.0 : copysign(polynomial(c, 5, fabs(w)), w);
}

/* Angle and speed that the hand gives the azimuth. */
static void hand(const rig_setup *s, double t_s, double *angle, double *speed)
{
    *angle = *speed = 0.0;
    for (int i = 0; i < 3; i++) {
        *angle += s->hand_rad[i] * sin(s->hand_rad_s[i] * t_s + s->hand_phase_rad[i]);
        *speed += s->hand_rad[i] * s->hand_rad_s[i] * cos(s->hand_rad_s[i] * t_s + s->hand_phase_rad[i]);
    }
}

static double elevation_torque(const rig_truth *p, const rig_setup *s, const double *x)
{
    const double turn = x[PHI_DOT], weight = s->weight_kg * p->g * s->lever_m;
    const double centrifugal = p->cf_sign * p->cf_length * p->tau_gE / (2.0 * p->g) * turn * turn * sin(2.0 * x[PSI]);
    return p->l_M * thrust(p->p_FM, x[OMEGA_M]) + centrifugal - p->tau_gE * cos(x[PSI] + s->mount_rad) - p->b_vE * x[PSI_DOT] +
           p->K_E * turn * x[OMEGA_M] * sin(x[PSI]) + weight * cos(x[PSI] + s->lever_rad);
}

static double azimuth_torque(const rig_truth *p, const rig_setup *s, const double *x)
{
    const double drive = p->l_T * thrust(p->p_FT, x[OMEGA_T]) - p->K_A * x[OMEGA_M];
    return (drive - s->turned * p->tau_gE * sin(x[PHI])) * cos(x[PSI]) - p->b_vA * x[PHI_DOT];
}

static void rates(const rig_truth *p, const rig_setup *s, const double *u, const double *sign, double t_s, const double *at, double *dx)
{
    double x[STATES];
    memcpy(x, at, sizeof x);
    if (s->hand_turned)
        hand(s, t_s, &x[PHI], &x[PHI_DOT]);
    dx[OMEGA_M] = p->K_M * u[0] - polynomial(p->p_bM, 3, fabs(x[OMEGA_M])) * x[OMEGA_M];
    dx[OMEGA_T] = p->K_T * u[1] - polynomial(p->p_bT, 3, fabs(x[OMEGA_T])) * x[OMEGA_T];
    dx[TURN_M] = x[OMEGA_M];
    dx[TURN_T] = x[OMEGA_T];
    const double J_E = p->J_E + s->weight_kg * s->lever_m * s->lever_m, J_A = p->J_A * cos(x[PSI]);
    dx[PSI] = sign[0] == 0.0 ? 0.0 : x[PSI_DOT];
    dx[PSI_DOT] = sign[0] == 0.0 ? 0.0 : (elevation_torque(p, s, x) - sign[0] * p->b_cE) / J_E;
    dx[PHI] = sign[1] == 0.0 ? 0.0 : x[PHI_DOT];
    dx[PHI_DOT] = sign[1] == 0.0 ? 0.0 : (azimuth_torque(p, s, x) - sign[1] * p->b_cA) / J_A;
}

/* Which way each axis moves, or is about to; 0 while it is held by lock, friction or a stop, which takes what speed is left. */
static void directions(const rig_truth *p, const rig_setup *s, double *x, double *sign)
{
    const double torque[2] = {elevation_torque(p, s, x), azimuth_torque(p, s, x)}, level[2] = {p->b_cE, p->b_cA};
    const double stop[2] = {p->Psi_lim, p->Phi_lim};
    const int locked[2] = {s->elevation_locked, s->azimuth_locked || s->hand_turned};
    for (int a = 0; a < 2; a++) {
        const double angle = x[a ? PHI : PSI];
        double *const left = &x[a ? PHI_DOT : PSI_DOT];
        if (!locked[a] && ((angle >= stop[a] && *left > 0.0) || (angle <= -stop[a] && *left < 0.0)))
            *left = 0.0;
        const double speed = *left;
        sign[a] = speed > 0.0 ? 1.0 : speed < 0.0 ? -1.0 : torque[a] > level[a] ? 1.0 : torque[a] < -level[a] ? -1.0 : 0.0;
        if (locked[a] || (angle >= stop[a] && sign[a] > 0.0) || (angle <= -stop[a] && sign[a] < 0.0))
            sign[a] = 0.0;
    }
}

static void runge_kutta(const rig_truth *p, const rig_setup *s, const double *u, const double *sign, double t_s, double h_s,
                        const double *x, double *next)
{
    double k[4][STATES], at[STATES];
    static const double AT[4] = {0.0, 0.5, 0.5, 1.0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < STATES; i++)
            at[i] = x[i] + (stage ? AT[stage] * h_s * k[stage - 1][i] : 0.0);
        rates(p, s, u, sign, t_s + AT[stage] * h_s, at, k[stage]);
    }
    for (int i = 0; i < STATES; i++)
        next[i] = x[i] + h_s / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
}

/* The share of the step until `from` - `to` reaches zero, 1 where it does not. */
static double share(double from, double to)
{
    return from > 0.0 && to < 0.0 ? from / (from - to) : 1.0;
}

static void advance(const rig_truth *p, const rig_setup *s, const double *u, double t_s, double h_s, double *x)
{
    for (int cut = 0; cut < MAX_CUTS && h_s > 1e-9; cut++) {
        double sign[2], next[STATES], first = 1.0;
        int rest = -1, stopped = -1;
        directions(p, s, x, sign);
        runge_kutta(p, s, u, sign, t_s, h_s, x, next);
        for (int a = 0; a < 2; a++) {
            const int angle = a ? PHI : PSI, speed = angle + 1;
            const double limit = sign[a] * (a ? p->Phi_lim : p->Psi_lim);
            const double still = share(sign[a] * x[speed], sign[a] * next[speed]);
            const double wall = share(sign[a] * (limit - x[angle]), sign[a] * (limit - next[angle]));
            if (still < first) {
                first = still;
                rest = a;
                stopped = -1;
            }
            if (wall < first) {
                first = wall;
                stopped = a;
                rest = -1;
            }
        }
        if (first < 1.0)
            runge_kutta(p, s, u, sign, t_s, first * h_s, x, next);
        memcpy(x, next, sizeof next);
        if (rest >= 0)
            x[rest ? PHI_DOT : PSI_DOT] = 0.0;
        if (stopped >= 0) {
            x[stopped ? PHI : PSI] = copysign(stopped ? p->Phi_lim : p->Psi_lim, x[stopped ? PHI : PSI]);
            x[stopped ? PHI_DOT : PSI_DOT] = 0.0;
        }
        t_s += first * h_s;
        h_s -= first * h_s;
    }
}

void rig_run(const rig_truth *p, const rig_setup *s, int samples, int steps, double t_s, double period_s, const double *u, double *x,
             double *history)
{
    const double h_s = period_s / steps;
    for (int k = 0; k < samples; k++) {
        if (s->hand_turned)
            hand(s, t_s + k * period_s, &x[PHI], &x[PHI_DOT]);
        memcpy(history + k * STATES, x, STATES * sizeof *x);
        for (int n = 0; n < steps; n++)
            advance(p, s, u + 2 * k, t_s + k * period_s + n * h_s, h_s, x);
    }
}
