/* Rotors, thrust, the two axes and their friction: one step (rotors at their middle, then rates,
 * then angles with the mean of old and new rates; bristles implicitly). */
#include <math.h>
#include <string.h>

#include "simulation.h"

enum { MAIN = 0, TAIL = 1, ELEVATION = 0, AZIMUTH = 1 };

static double rotor_thrust(const rig_t *rig, int rotor, double speed)
{
    double w = fabs(speed);
    const double *p = rig->thrust[rotor];
    return copysign(p[0] * (w > 0.0) + w * (p[1] + w * (p[2] + w * (p[3] + w * p[4]))), speed);
}

/* What changes slowly is brought up to date once a sample. */
void rig_slow(const effects_t *fx, state_t *s)
{
    double t = s->t_s > 0.0 ? s->t_s : 0.0;
    for (int i = 0; i < 2; i++) {
        /* Copper warms: resistance grows, so the drive falls as 1 / (1 + a (1 - exp(-t/T))). */
        s->warm_factor[i] = fx->warm[i] != 0.0 ? 1.0 / (1.0 + fx->warm[i] * (1.0 - exp(-t / fx->warm_time_s[i]))) : 1.0;
        s->grease_factor[i] = fx->grease[i] != 0.0 ? 1.0 - fx->grease[i] * (1.0 - exp(-t / fx->grease_time_s[i])) : 1.0;
        double phase = fx->pulse_s[i] > 0.0 ? (s->t_s - fx->pulse_start_s[i]) / fx->pulse_s[i] : -1.0;
        /* A push by hand swells and fades: a raised sine, flat in the middle. */
        s->pulse_Nm[i] = phase > 0.0 && phase < 1.0 ? fx->pulse_Nm[i] * sqrt(sin(M_PI * phase)) : 0.0;
        s->draught_Nm[i] = fx->draught_Nm[i] * sin(fx->draught_rad_s[i] * s->t_s + fx->draught_phase[i]);
    }
    double moved = fx->weight_ramp_s > 0.0 ? (s->t_s - fx->weight_time_s) / fx->weight_ramp_s : 0.0;
    s->gravity_factor = 1.0 + fx->weight * (moved < 0.0 ? 0.0 : (moved > 1.0 ? 1.0 : moved));
}

/* Midpoint rule, so that the rotor neither leads nor lags the body by half a step. */
static void spin_rotor(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double dt)
{
    double drive = rig->drive[rotor] * s->warm_factor[rotor] * driver_output(rig, fx, s, rotor, dt);
    double w = s->omega[rotor];
    double middle = w + 0.5 * dt * (drive - rotor_damping(rig, rotor, w) * w);
    double next = w + dt * (drive - rotor_damping(rig, rotor, middle) * middle);
    double dry = fx->dry[rotor] * dt;
    if (dry > 0.0)
        next = fabs(next) <= dry ? 0.0 : next - copysign(dry, next);
    s->spin[rotor] = (next - w) / dt;
    s->middle[rotor] = 0.5 * (w + next);
    s->omega[rotor] = next;
}

static double main_thrust(const rig_t *rig, const effects_t *fx, const state_t *s)
{
    double force = rotor_thrust(rig, MAIN, s->middle[MAIN]);
    if (fx->ground != 0.0) {
        /* Image rotor below the floor: inverse square of the height. */
        double h = fx->ground_height_rad / (fx->ground_height_rad + s->angle[ELEVATION] + rig->stop_rad[ELEVATION]);
        force *= 1.0 + fx->ground * h * h;
    }
    return force - fx->inflow[MAIN] * s->middle[MAIN] * s->rate[ELEVATION];
}

static double tail_thrust(const rig_t *rig, const effects_t *fx, const state_t *s)
{
    double w = s->middle[TAIL];
    double force = rotor_thrust(rig, TAIL, w);
    if (fx->reverse != 0.0)
        force *= 1.0 + fx->reverse * 0.5 * (1.0 - tanh(w / fx->reverse_width_rad_s));
    if (fx->downwash != 0.0)
        force /= 1.0 + fx->downwash * s->middle[MAIN] / 600.0;
    if (fx->stall_rad_s > 0.0) {
        double x = w / fx->stall_rad_s, x4 = x * x * x * x;
        force /= 1.0 + x4;
    }
    return force - fx->inflow[TAIL] * fabs(w) * s->rate[AZIMUTH];
}

/* Bristles (LuGre): z' = v - sigma |v| z / g(v), torque sigma z + sigma1 z'; the stiff part is taken implicitly. */
static double friction(const model_t *m, state_t *s, int axis, double load_Nm, double dt)
{
    const rig_t *rig = &m->rig;
    const effects_t *fx = &m->effects;
    double v = s->rate[axis];
    double level = rig->coulomb_Nm[axis] + load_Nm + fx->asymmetry_Nm[axis] * 0.5 * (v > 0.0 ? 1.0 : -1.0);
    double peak = level;
    if (fx->stribeck_Nm[axis] > 0.0)
        peak += fx->stribeck_Nm[axis] * exp(-fabs(v) / fx->stribeck_rad_s[axis]);
    if (peak <= 0.0)
        return 0.0;
    double most_Nm = rig->coulomb_Nm[axis] + load_Nm + fabs(fx->asymmetry_Nm[axis]) + fx->stribeck_Nm[axis];
    double stiffness = most_Nm / m->bearing.width[axis];
    double old = s->bristle[axis];
    s->bristle[axis] = (old + dt * v) / (1.0 + dt * stiffness * fabs(v) / peak);
    double damping = 0.6 * sqrt(stiffness * rig->inertia[axis]);
    return stiffness * s->bristle[axis] + damping * (s->bristle[axis] - old) / dt;
}

/* What both axes can suffer alike; added to the nominal torque. */
static double common_torque(const effects_t *fx, state_t *s, int axis, double dt)
{
    double v = s->rate[axis], torque = s->pulse_Nm[axis] + s->draught_Nm[axis];
    if (fx->drag[axis] != 0.0)
        torque -= fx->drag[axis] * v * sqrt(v * v + fx->drag_floor_rad_s[axis] * fx->drag_floor_rad_s[axis]);
    if (fx->spring[axis] != 0.0) {
        double x = s->angle[axis] - fx->spring_zero_rad[axis];
        torque -= fx->spring[axis] * x * (1.0 + fx->hardening[axis] * x * x);
    }
    if (fx->cable_Nm_rad[axis] != 0.0) {
        s->cable[axis] = (s->cable[axis] + dt * v) / (1.0 + dt * fabs(v) / fx->cable_slip_rad[axis]);
        torque -= fx->cable_Nm_rad[axis] * s->cable[axis];
    }
    return torque;
}

static double elevation_torque(const model_t *m, state_t *s, double lift, double side, double c, double sn, double dt)
{
    const rig_t *rig = &m->rig;
    const effects_t *fx = &m->effects;
    double v = s->rate[ELEVATION], turn = s->rate[AZIMUTH];
    double torque = rig->arm_m[MAIN] * lift + 2.0 * rig->centrifugal * turn * turn * sn * c;
    torque -= rig->gravity_Nm * s->gravity_factor * c - fx->centre_Nm * sn;
    torque -= rig->viscous[ELEVATION] * s->grease_factor[ELEVATION] * v - rig->gyro * turn * s->middle[MAIN] * sn;
    torque += fx->tail_to_elevation_m * side - fx->spin_inertia[ELEVATION] * s->spin[TAIL];
    if (fx->bumper_Nm_rad > 0.0 && s->angle[ELEVATION] > fx->bumper_rad)
        torque -= fx->bumper_Nm_rad * (s->angle[ELEVATION] - fx->bumper_rad);
    torque += common_torque(fx, s, ELEVATION, dt);
    return torque - friction(m, s, ELEVATION, fx->load_friction_m * fabs(lift), dt);
}

static double azimuth_torque(const model_t *m, state_t *s, double side, double c, double sn, double dt)
{
    const rig_t *rig = &m->rig;
    const effects_t *fx = &m->effects;
    double v = s->rate[AZIMUTH], w = s->middle[MAIN], x = s->angle[AZIMUTH];
    double torque = c * (rig->arm_m[TAIL] * side - rig->reaction * w - fx->reaction_quadratic * w * w);
    torque -= rig->viscous[AZIMUTH] * s->grease_factor[AZIMUTH] * v + c * fx->spin_inertia[AZIMUTH] * s->spin[MAIN];
    torque += (fx->coriolis * 2.0 * c * v - fx->gyro_azimuth * w) * s->rate[ELEVATION] * sn;
    if (fx->tilt_Nm != 0.0)
        torque -= fx->tilt_Nm * sin(x - fx->tilt_rad);
    if (fx->detent_Nm != 0.0)
        torque -= fx->detent_Nm * sin(fx->detent_count * x);
    if (fx->wind != 0.0) {
        double stream = fx->wind_m_s * cos(x - fx->wind_rad) - rig->arm_m[TAIL] * v;
        torque += fx->wind * stream * fabs(stream);
    }
    torque += common_torque(fx, s, AZIMUTH, dt);
    return torque - friction(m, s, AZIMUTH, 0.0, dt);
}

/* Inelastic stop. */
static void move(const rig_t *rig, state_t *s, int axis, double acceleration, double dt)
{
    double before = s->rate[axis];
    s->rate[axis] += dt * acceleration;
    s->angle[axis] += 0.5 * dt * (before + s->rate[axis]);
    double stop = rig->stop_rad[axis];
    if (fabs(s->angle[axis]) >= stop) {
        s->angle[axis] = copysign(stop, s->angle[axis]);
        if (s->rate[axis] * s->angle[axis] > 0.0)
            s->rate[axis] = 0.0;
    }
}

void plant_step(const model_t *m, state_t *s, const double gust_Nm[2], double dt)
{
    const rig_t *rig = &m->rig;
    const effects_t *fx = &m->effects;
    s->load_V += (fabs(s->line[MAIN].now_V) + fabs(s->line[TAIL].now_V) - s->load_V) * dt / 0.02;
    spin_rotor(rig, fx, s, MAIN, dt);
    spin_rotor(rig, fx, s, TAIL, dt);
    double c = cos(s->angle[ELEVATION]), sn = sin(s->angle[ELEVATION]);
    double lift = main_thrust(rig, fx, s), side = tail_thrust(rig, fx, s);
    double about_azimuth = (rig->inertia[AZIMUTH] + fx->inertia_cosine2 * (c - 1.0)) * c;
    double raise = gust_Nm[ELEVATION] + elevation_torque(m, s, lift, side, c, sn, dt);
    double turn = gust_Nm[AZIMUTH] + azimuth_torque(m, s, side, c, sn, dt);
    move(rig, s, ELEVATION, raise / rig->inertia[ELEVATION], dt);
    move(rig, s, AZIMUTH, turn / about_azimuth, dt);
    s->t_s += dt;
}

void state_motion(const state_t *s, double x[6])
{
    for (int i = 0; i < 2; i++) {
        x[2 * i] = s->angle[i];
        x[2 * i + 1] = s->rate[i];
        x[4 + i] = s->omega[i];
    }
}

void state_place(const model_t *m, const double x[6], state_t *s)
{
    for (int i = 0; i < 2; i++) {
        s->angle[i] = x[2 * i];
        s->rate[i] = x[2 * i + 1];
        s->omega[i] = x[4 + i];
    }
    sensor_reset(&m->effects, s);
}

void state_begin(const model_t *m, const double x[6], double t_s, state_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_s = t_s;
    state_place(m, x, s);
    rig_slow(&m->effects, s);
}

void state_advance(const model_t *m, state_t *s, const inputs_t *in, int row, int windy)
{
    static const double calm[2] = {0.0, 0.0};
    const effects_t *fx = &m->effects;
    int moves = sensor_moves(fx), steps = in->steps[row];
    rig_slow(fx, s);
    for (int step = 0; step < steps; step++) {
        /* A row that comes late has longer gusts. */
        int gust = step * in->gusts / steps;
        plant_step(m, s, windy ? in->gust + 2 * (in->gusts * row + gust) : calm, in->step_s);
        if (moves || step + 1 == steps)
            sensor_step(fx, s, in->step_s);
    }
}
