/* Equations (4) to (9) with what may be added to them, and one step: half of the friction, Runge-Kutta for the rest,
 * the other half. */
#include <math.h>
#include <string.h>

#include "simulation.h"

enum { MAIN = 0, TAIL = 1, ELEVATION = 0, AZIMUTH = 1, PLAIN = 6, WHOLE = 12 };

static double rotor_slope(const rig_t *rig, const effects_t *fx, const state_t *s, int rotor, double w)
{
    double a = rig->drive[rotor] * s->warm_factor[rotor] * s->volts[rotor] - rotor_damping(rig, rotor, w) * w;
    if (rotor == MAIN && fx->clutch_rad_s2 > 0.0)
        a = fx->clutch_rad_s2 * tanh(a / fx->clutch_rad_s2);
    return a;
}

/* A tether that hardens, slacker on one side. */
static double tether(const effects_t *fx, int axis, double angle)
{
    double x = angle - fx->spring_zero_rad[axis];
    return -fx->spring[axis] * (x < 0.0 ? fx->spring_slack[axis] : 1.0) * x * (1.0 + fx->spring_growth[axis] * fabs(x));
}

/* What both axes can suffer alike. */
static double shared_torque(const effects_t *fx, const state_t *s, int axis, double angle, double rate)
{
    double torque = s->outer_Nm[axis];
    if (fx->drag[axis] != 0.0)
        torque -= fx->drag[axis] * copysign(pow(fabs(rate), fx->drag_power[axis]), rate);
    if (fx->spring[axis] != 0.0)
        torque += tether(fx, axis, angle);
    return torque;
}

/* A rotor that speeds up turns its mount the other way; the mount is a little soft. */
static double spin_torque(const effects_t *fx, const double x[12], int axis)
{
    int rotor = 1 - axis;
    if (fx->spin_inertia[axis] == 0.0)
        return 0.0;
    return -fx->spin_inertia[axis] * (x[4 + rotor] - x[10 + axis]) / fx->spin_soft_s[axis];
}

static double elevation_torque(const rig_t *rig, const effects_t *fx, const state_t *s, const double x[12], double lift,
                               double c, double sn)
{
    double turn = x[3], w = x[5];
    double torque = rig->arm_m[MAIN] * lift + rig->gyro * turn * x[4] * sn;
    torque += rig->centrifugal * turn * turn * 2.0 * sn * c;
    double centre = fx->centre_rad * (1.0 + fx->centre_droop * c);
    torque -= rig->gravity_Nm * s->gravity_factor * (centre != 0.0 ? cos(x[0] + centre) : c);
    if (fx->tail_lift != 0.0)
        torque += fx->tail_lift * copysign(pow(fabs(w) / 100.0, fx->tail_lift_power), w);
    if (fx->lean_Nm != 0.0)
        torque -= fx->lean_Nm * sn * cos(x[2] - fx->lean_rad);
    if (fx->maxwell_Nm_rad != 0.0)
        torque -= fx->maxwell_Nm_rad * (x[0] - s->maxwell_rad);
    return torque + spin_torque(fx, x, ELEVATION) + shared_torque(fx, s, ELEVATION, x[0], x[1]);
}

static double azimuth_torque(const rig_t *rig, const effects_t *fx, const state_t *s, const double x[12], double lift,
                             double side, double c)
{
    double phi = x[2], v = x[3], raise = x[1], w = x[4];
    double torque = c * (rig->arm_m[TAIL] * side - rig->reaction * w);
    torque += c * (spin_torque(fx, x, AZIMUTH) + fx->flap * lift * raise);
    if (fx->gyro_azimuth != 0.0)
        torque -= fx->gyro_azimuth * raise * w * sin(x[0] + fx->gyro_cant_rad);
    if (fx->tilt_Nm != 0.0)
        torque -= fx->tilt_Nm * c * sin(phi - fx->tilt_rad);
    if (fx->magnet_Nm != 0.0) {
        double d = (phi - fx->magnet_rad) / fx->magnet_width_rad;
        torque -= fx->magnet_Nm * d * exp(0.5 - 0.5 * d * d);
    }
    if (fx->eddy_Nms != 0.0)
        torque -= fx->eddy_Nms * v / (1.0 + v * v / (fx->eddy_rad_s * fx->eddy_rad_s));
    return torque + shared_torque(fx, s, AZIMUTH, phi, v);
}

/* One axis: its arm alone, or two masses with a spring between; the bearing drags the hub where there is one. */
static void accelerate(const rig_t *rig, const effects_t *fx, const state_t *s, int axis, const double x[12],
                       double torque, double shape, double *dx)
{
    int arm = 2 * axis, mass = 6 + 2 * axis;
    double whole = rig->inertia[axis] * shape, share = fx->mass_share[axis], hub = fx->mass_reads[axis];
    double bearing = hub != 0.0 ? x[mass + 1] : x[arm + 1], drag = rig->viscous[axis] * bearing, force = 0.0;
    dx[arm] = x[arm + 1];
    if (share != 0.0) {
        double omega = fx->mass_rad_s[axis], reduced = rig->inertia[axis] * share * (1.0 - share);
        double stretch = x[arm] - x[mass], slip = x[arm + 1] - x[mass + 1];
        force = reduced * omega * (omega * stretch + 2.0 * fx->mass_zeta[axis] * slip);
        dx[mass] = x[mass + 1];
        dx[mass + 1] = (force - hub * drag) / (whole * share);
    }
    dx[arm + 1] = (torque - force - (1.0 - hub) * drag) / (whole * (1.0 - share));
    if (s->held[axis]) {
        int stuck = hub != 0.0 ? mass : arm;
        dx[stuck] = dx[stuck + 1] = 0.0;
    }
}

/* `gust` in rad/s^2 on each arm. */
void slope(const rig_t *rig, const effects_t *fx, const state_t *s, const double x[12], const double gust[2],
           double dx[12])
{
    double c = cos(x[0]), sn = sin(x[0]);
    double lift = main_thrust(rig, fx, x[4], x[0], s->stale_N);
    double side = tail_thrust(rig, fx, x[5], x[4], x[3], s->chip_factor);
    memset(dx, 0, WHOLE * sizeof *dx);
    double raise = elevation_torque(rig, fx, s, x, lift, c, sn) + rig->inertia[ELEVATION] * gust[ELEVATION];
    double turn = azimuth_torque(rig, fx, s, x, lift, side, c) + rig->inertia[AZIMUTH] * c * gust[AZIMUTH];
    accelerate(rig, fx, s, ELEVATION, x, raise, 1.0, dx);
    accelerate(rig, fx, s, AZIMUTH, x, turn, c, dx);
    for (int i = 0; i < 2; i++) {
        dx[4 + i] = rotor_slope(rig, fx, s, i, x[4 + i]);
        if (fx->spin_inertia[i] != 0.0)
            dx[10 + i] = (x[4 + 1 - i] - x[10 + i]) / fx->spin_soft_s[i];
    }
}

static void runge_kutta(const rig_t *rig, const effects_t *fx, state_t *s, const double gust[2], double h)
{
    double k1[12], k2[12], k3[12], k4[12], x[12] = {0};
    int masses = fx->mass_share[0] != 0.0 || fx->mass_share[1] != 0.0;
    int followers = fx->spin_inertia[0] != 0.0 || fx->spin_inertia[1] != 0.0;
    int n = masses || followers ? WHOLE : PLAIN;
    slope(rig, fx, s, s->x, gust, k1);
    for (int i = 0; i < n; i++)
        x[i] = s->x[i] + 0.5 * h * k1[i];
    slope(rig, fx, s, x, gust, k2);
    for (int i = 0; i < n; i++)
        x[i] = s->x[i] + 0.5 * h * k2[i];
    slope(rig, fx, s, x, gust, k3);
    for (int i = 0; i < n; i++)
        x[i] = s->x[i] + h * k3[i];
    slope(rig, fx, s, x, gust, k4);
    for (int i = 0; i < n; i++)
        s->x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
}

/* A tether that creeps, and air that has been blown round the room: both follow what drives them. */
static void follow_up(const rig_t *rig, const effects_t *fx, state_t *s, double dt)
{
    if (fx->maxwell_Nm_rad != 0.0)
        s->maxwell_rad += (s->x[0] - s->maxwell_rad) * -expm1(-dt / fx->maxwell_s);
    if (fx->stale != 0.0) {
        double fresh = main_thrust(rig, fx, s->x[4], s->x[0], 0.0);
        s->stale_N += (fresh - s->stale_N) * -expm1(-dt / fx->stale_s);
    }
}

/* Inelastic stops; a hub stops with its arm. */
static void stop(const rig_t *rig, const effects_t *fx, state_t *s, int axis)
{
    double *angle = &s->x[2 * axis], end = rig->stop_rad[axis];
    if (fabs(*angle) < end)
        return;
    *angle = copysign(end, *angle);
    if (angle[1] * *angle > 0.0)
        angle[1] = 0.0;
    if (fx->mass_reads[axis] != 0.0 && s->x[7 + 2 * axis] * *angle > 0.0)
        s->x[7 + 2 * axis] = 0.0;
}

void plant_step(const model_t *m, state_t *s, const double gust[2], double dt)
{
    const rig_t *rig = &m->rig;
    const effects_t *fx = &m->effects;
    driver_step(rig, fx, s, dt);
    follow_up(rig, fx, s, dt);
    bearing_grip(rig, &m->bearing, fx, s, gust);
    bearing_step(rig, &m->bearing, fx, s, 0.5 * dt);
    runge_kutta(rig, fx, s, gust, dt);
    bearing_step(rig, &m->bearing, fx, s, 0.5 * dt);
    rotor_brake(fx, s, dt);
    stop(rig, fx, s, ELEVATION);
    stop(rig, fx, s, AZIMUTH);
    s->t_s += dt;
}

void state_motion(const state_t *s, double x[6])
{
    memcpy(x, s->x, PLAIN * sizeof *x);
}

void state_place(const model_t *m, const double x[6], state_t *s)
{
    memcpy(s->x, x, PLAIN * sizeof *x);
    sensor_rest(&m->effects, s);
}

void state_begin(const model_t *m, const double x[6], double t_s, state_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_s = t_s;
    state_place(m, x, s);
    s->x[10] = s->x[5];
    s->x[11] = s->x[4];
    s->maxwell_rad = x[0];
    weather(&m->effects, s);
}

void state_advance(const model_t *m, state_t *s, const inputs_t *in, int row, int windy)
{
    static const double calm[2] = {0.0, 0.0};
    const effects_t *fx = &m->effects;
    int moves = sensor_moves(fx), steps = in->steps[row];
    for (int step = 0; step < steps; step++) {
        /* The last gust goes on in a row that comes late. */
        int gust = step / in->gust_steps < in->gusts ? step / in->gust_steps : in->gusts - 1;
        if (step % in->gust_steps == 0)
            weather(fx, s);
        plant_step(m, s, windy ? in->gust + 2 * (in->gusts * row + gust) : calm, in->step_s);
        if (moves || step + 1 == steps)
            sensor_step(fx, s, in->step_s);
    }
}
