/* The plants' own equations, each as its plant file's numbers have it, with what is wrong with it. */
#include <math.h>

#include "simulation.h"

static double series(const double *p, int count, double w)
{
    double sum = 0.0, power = 1.0;
    for (int i = 0; i < count; i++, power *= w)
        sum += p[i] * power;
    return sum;
}

static double odd_thrust(const double p[5], double w)
{
    return w == 0.0 ? 0.0 : copysign(series(p, 5, fabs(w)), w);
}

/* Part of a thrust that is left above the speed at which the blades stall. */
static double unstalled(const effects_t *fx, int rotor, double share)
{
    double over = share - fx->stall_from[rotor];
    return fx->stall[rotor] != 0.0 && over > 0.0 ? 1.0 - fx->stall[rotor] * over * over / (over + 0.1) : 1.0;
}

/* Two equal masses that warm one another: slow at first. */
double motor_factor(const model_t *m, const state_t *s, int rotor)
{
    const effects_t *fx = &m->effects;
    double t = fmax(s->t_s, 0.0), left = 1.0;
    if (fx->warm[rotor] != 0.0) {
        double x = t / fx->warm_s[rotor];
        left -= fx->warm[rotor] * (1.0 - (1.0 + x) * exp(-x));
    }
    if (fx->chip[rotor] != 0.0 && t >= fx->chip_time_s[rotor])
        left *= 1.0 - fx->chip[rotor];
    return left;
}

static double heavier(const effects_t *fx, const state_t *s)
{
    if (fx->weight == 0.0)
        return 1.0;
    return 1.0 + fx->weight / (1.0 + exp(-(s->t_s - fx->weight_time_s) / 0.05));
}

static double rotor_rate(const model_t *m, const state_t *s, int i, double w)
{
    const ce150_t *p = &m->rig.ce150;
    double drive = (i ? p->K_T : p->K_M) * s->volts[i] * motor_factor(m, s, i);
    double dry = m->effects.dry[i] * atan(w / 2.0) / M_PI_2;
    return drive - series(i ? p->p_bT : p->p_bM, 3, fabs(w)) * w - dry;
}

static void ce150(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2], double spin[2])
{
    const ce150_t *p = &m->rig.ce150;
    const effects_t *fx = &m->effects;
    double c = cos(x[0]), sn = sin(x[0]), w = x[4], v = x[5];
    double lift = odd_thrust(p->p_FM, w) * unstalled(fx, 0, fabs(w) / 600.0);
    double side = odd_thrust(p->p_FT, v) * unstalled(fx, 1, fabs(v) / 800.0);
    if (fx->ground != 0.0) {
        double height = (x[0] + p->Psi_lim) / fx->ground_rad;
        lift *= 1.0 + fx->ground / (1.0 + height * height);
    }
    if (fx->downwash != 0.0)
        side *= 1.0 - fx->downwash * tanh(fx->downwash_bend * fabs(w) / 600.0) / tanh(fx->downwash_bend);
    double centre = cos(x[0] + fx->centre_rad);
    torque[0] = p->l_M * lift + p->K_E * x[3] * w * sn - p->tau_gE * heavier(fx, s) * centre - p->b_vE * x[1];
    torque[0] += p->cf_sign * p->cf_length * p->tau_gE / p->g * x[3] * x[3] * sn * c;
    torque[0] += fx->tail_lift * v * fabs(v) / (1.0 + fabs(v) / 2000.0);
    torque[1] = c * (p->l_T * side - p->K_A * w) - p->b_vA * x[3];
    torque[1] -= fx->gyro_azimuth * x[1] * w * sn + fx->tilt * sin(x[2] - fx->tilt_rad);
    inertia[0] = p->J_E;
    inertia[1] = p->J_A * c;
    for (int i = 0; i < 2; i++)
        spin[i] = rotor_rate(m, s, i, x[4 + i]);
}

static void aeroshield(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2])
{
    const aeroshield_t *p = &m->rig.aeroshield;
    const effects_t *fx = &m->effects;
    double u = s->volts[0] * motor_factor(m, s, 0) * unstalled(fx, 0, fabs(s->volts[0]) / p->u_max);
    torque[0] = p->l * (p->K * u - p->m * p->g * heavier(fx, s) * sin(x[0] + fx->centre_rad)) - p->c * x[1];
    inertia[0] = p->m * p->l * p->l;
}

static void emps(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2])
{
    const emps_t *p = &m->rig.emps;
    torque[0] = p->gtau * s->volts[0] * motor_factor(m, s, 0) - p->F_v * x[1] - p->offset;
    inertia[0] = p->M;
}

static void quanser_aero(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2])
{
    const quanser_aero_t *p = &m->rig.quanser_aero;
    const effects_t *fx = &m->effects;
    double square[2], c = cos(x[0]), sn = sin(x[0]);
    for (int i = 0; i < 2; i++) {
        double w = p->K_omega * s->volts[i] * motor_factor(m, s, i);
        square[i] = w * w * unstalled(fx, i, fabs(s->volts[i]) / p->u_max);
    }
    double body = 2.0 * (p->mpa + p->me) * p->dt * p->dt + p->me * p->dx * p->dx + p->mrod * p->lt * p->lt / 12.0;
    torque[0] = p->dt * (p->Kmt * square[0] + p->Ktt * square[1]) - body * x[3] * x[3] * c * sn - p->d1 * x[1];
    torque[0] -= p->dx * p->g * p->me * heavier(fx, s) * sin(x[0] + fx->centre_rad);
    torque[1] = p->dt * c * (p->Ktp * square[1] - p->Kmp * square[0]) + 2.0 * body * x[1] * x[3] * c * sn - p->d2 * x[3];
    inertia[0] = body;
    inertia[1] = 0.5 * p->my * p->ry * p->ry + body * c * c;
}

/* What thrust is late by is a Pade approximant of second order, an all-pass: the command less a multiple of its filter's rate. */
static void antx_2dof_drone(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2], double spin[2])
{
    const antx_2dof_drone_t *p = &m->rig.antx_2dof_drone;
    double a = 6.0 / p->tau, thrust = (s->volts[0] - 6.0 * x[5] / a) * motor_factor(m, s, 0);
    torque[0] = p->mu * thrust - p->omega_n * (p->omega_n * x[0] + 2.0 * p->xi * x[1]);
    inertia[0] = 1.0;
    spin[0] = x[5];
    spin[1] = a * a / 3.0 * (s->volts[0] - x[4]) - a * x[5];
}

static void dc_motor(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2], double spin[2])
{
    const dc_motor_t *p = &m->rig.dc_motor;
    torque[0] = p->K * x[4] - p->b * x[1];
    inertia[0] = p->J;
    spin[0] = (s->volts[0] - p->R * x[4] - p->K * x[1]) / p->L;
}

/* Without dry friction and what all axes have alike. */
void torques(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2], double spin[2])
{
    torque[1] = spin[0] = spin[1] = 0.0;
    inertia[1] = 1.0;
    if (m->rig.plant == 0)
        ce150(m, s, x, torque, inertia, spin);
    else if (m->rig.plant == 1)
        aeroshield(m, s, x, torque, inertia);
    else if (m->rig.plant == 2)
        emps(m, s, x, torque, inertia);
    else if (m->rig.plant == 3)
        quanser_aero(m, s, x, torque, inertia);
    else if (m->rig.plant == 4)
        antx_2dof_drone(m, s, x, torque, inertia, spin);
    else
        dc_motor(m, s, x, torque, inertia, spin);
}

/* What a bearing gives at most against its motion. */
double dry_level(const model_t *m, const state_t *s, int axis, double rate)
{
    const effects_t *fx = &m->effects;
    double level = fx->coulomb[axis];
    if (m->rig.plant == 0)
        level += axis ? m->rig.ce150.b_cA : m->rig.ce150.b_cE;
    else if (m->rig.plant == 2)
        level += m->rig.emps.F_c;
    else if (m->rig.plant == 5)
        level += m->rig.dc_motor.tau_c;
    if (fx->stribeck[axis] != 0.0)
        level += fx->stribeck[axis] * exp(-fabs(rate) / fx->stribeck_rate[axis]);
    if (fx->load_friction[axis] != 0.0)
        level += fx->load_friction[axis] * fabs(s->volts[axis]);
    return fmax(level + 0.5 * copysign(fx->asymmetry[axis], fx->asymmetry[axis] * rate), 0.0);
}

static double push_of_a_hand(const effects_t *fx, int axis, double t_s)
{
    double x = fx->pulse[axis] != 0.0 ? 2.0 * (t_s - fx->pulse_start_s[axis]) / fx->pulse_s[axis] - 1.0 : 1.0;
    return fabs(x) < 1.0 ? fx->pulse[axis] * (1.0 - x * x * x * x) : 0.0;
}

/* What may act on any axis. */
double shared_torque(const model_t *m, const state_t *s, int axis, double angle, double rate)
{
    const effects_t *fx = &m->effects;
    double torque = push_of_a_hand(fx, axis, s->t_s) + fx->drift[axis] * fmax(s->t_s, 0.0);
    if (fx->drag[axis] != 0.0)
        torque -= fx->drag[axis] * rate * fabs(rate) / (1.0 + fabs(rate) / fx->drag_rate[axis]);
    if (fx->spring[axis] != 0.0) {
        double x = angle - fx->spring_zero[axis], hard = fx->spring_hard[axis];
        torque -= fx->spring[axis] * sinh(hard * x) / hard;
    }
    if (fx->detent[axis] != 0.0)
        torque += fx->detent[axis] * sin(fx->detent_waves[axis] * angle + fx->detent_rad[axis]);
    if (fx->hum[axis] != 0.0)
        torque += fx->hum[axis] * sin(fx->hum_rad_s[axis] * s->t_s);
    if (fx->bumper[axis] != 0.0)
        torque -= fx->bumper[axis] * (fmax(angle - fx->bumper_at[axis], 0.0) + fmin(angle + fx->bumper_at[axis], 0.0));
    return torque;
}
