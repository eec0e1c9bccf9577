/* The slopes of the likelihood by numbers of the noise: what each changes of the covariance and, by the gain, of the mean goes along with
 * these, step by step and measurement by measurement, all numbers side by side. They leave out how the Jacobians move with the mean. */
#ifndef NOISE_SLOPES_H
#define NOISE_SLOPES_H

#include "estimate.h"
#include "substep.h"

#define EACH(at, d) for (noise_slopes_block *d = (at)->noises.by, *const end = d + (at)->noises.blocks; d < end; d++)

/* Of what the substep brings each state and keeps of it (process_noise.h). */
static void find_noise_slopes(filter_state *at, const substep *part)
{
    EACH(at, d)
    for (int n = 0; n < at->states.awake; n++) {
        const int i = at->states.order[n];
        const double rate = at->request->forget[i], kept = part->kept[i], q = at->request->q[i];
        d->kept[i] = rate > 0.0 ? -part->h_s * kept * d->forget[i] : (block){0.0};
        d->noise[i] = d->q[i] * part->h_s;
        if (rate > 0.0)
            d->noise[i] = 0.5 * (1.0 - kept * kept) / rate * (d->q[i] - q / rate * d->forget[i]) - q / rate * kept * d->kept[i];
    }
}

/* Of an axis' doubt of friction (rest.h): `a_second` of it brings the speed that variance, which falls with the speed by its `width`. */
static void doubt_slopes(filter_state *at, int axis, double a_second, double width)
{
    const int v = AXIS_VELOCITY[axis];
    const double speed = at->body.x[v] / width, rub = at->request->rub[axis];
    EACH(at, d)
    d->noise[v] += a_second * (d->rub[axis] + rub * speed * (0.5 * speed * d->P[v][v] - d->x[v]));
}

/* Of the mean over the substep; that of speeds which are held stays. */
static void move_mean_slopes(filter_state *at, const substep *part)
{
    EACH(at, d) {
        block moved[N];
        for (int n = 0; n < at->states.awake; n++) {
            const int i = at->states.order[n];
            moved[i] = part->before.x[i] * d->kept[i];
            for (int l = 0; l < at->noises.count[i]; l++)
                moved[i] += at->F[i][at->noises.mover[i][l]] * d->x[at->noises.mover[i][l]];
        }
        for (int n = 0; n < at->states.awake; n++)
            d->x[at->states.order[n]] = moved[at->states.order[n]];
        for (int a = 0; a < N_AXES; a++)
            if (part->held[a])
                d->x[AXIS_VELOCITY[a]] = (block){0.0};
    }
}

/* Takes the noise of speeds from that of the other states, as rest.h does. */
static void part_speed_slopes(filter_state *at, const substep *part)
{
    EACH(at, d)
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double usual = part->rests[a] ? at->request->rest_s / part->h_s : 1.0;
        d->brought[a] = at->request->locked[a] ? (block){0.0} : usual * d->noise[v];
        d->noise[v] = (block){0.0};
    }
}

/* F dP */
static void multiply_left(const filter_state *at, noise_slopes_block *d)
{
    const int awake = at->states.awake, *const order = at->states.order;
    for (int n = 0; n < awake; n++) {
        const int i = order[n], count = at->noises.count[i], *const mover = at->noises.mover[i];
        for (int m = 0; m < awake; m++) {
            block sum = {0.0};
            for (int l = 0; l < count; l++)
                sum += at->F[i][mover[l]] * d->P[mover[l]][order[m]];
            d->FP[i][order[m]] = sum;
        }
    }
}

/* (F dP) F', and what F's own slopes add by the F P of this step. */
static void multiply_right(const filter_state *at, noise_slopes_block *d)
{
    const int awake = at->states.awake, *const order = at->states.order;
    for (int m = 0; m < awake; m++) {
        const int k = order[m], count = at->noises.count[k], *const mover = at->noises.mover[k];
        for (int n = m; n < awake; n++) {
            const int i = order[n];
            block sum = d->kept[i] * at->FP[k][i] + d->kept[k] * at->FP[i][k];
            for (int l = 0; l < count; l++)
                sum += at->F[k][mover[l]] * d->FP[i][mover[l]];
            d->P[i][k] = d->P[k][i] = sum;
        }
    }
}

/* Of the covariance over the substep, with half the noise before and half behind; part->noise is the half. */
static void propagate_noise_slopes(filter_state *at, const substep *part)
{
    const int awake = at->states.awake, *const order = at->states.order;
    EACH(at, d) {
        block half[N];
        for (int n = 0; n < awake; n++) {
            const int i = order[n];
            const double kept = part->kept[i];
            half[i] = (d->noise[i] - 2.0 * kept * part->noise[i] * d->kept[i]) / (1.0 + kept * kept);
            d->P[i][i] += half[i];
        }
        multiply_left(at, d);
        multiply_right(at, d);
        for (int n = 0; n < awake; n++)
            d->P[order[n]][order[n]] += half[order[n]];
    }
}

/* What noise brings a speed at rest. */
static void bring_speed_slopes(filter_state *at, int axis)
{
    const int v = AXIS_VELOCITY[axis];
    EACH(at, d)
    d->P[v][v] += d->brought[axis];
}

/* What noise brings a speed that spreads along g by instant, which most states have no part in. */
static void spread_noise_slopes(filter_state *at, int axis, double g[INSTANTS][WIDTH])
{
    int moved[N], count = 0;
    for (int n = 0; n < at->states.awake; n++)
        if (g[0][at->states.order[n]] != 0.0 || g[1][at->states.order[n]] != 0.0)
            moved[count++] = at->states.order[n];
    EACH(at, d)
    for (int n = 0; n < count; n++)
        for (int m = 0; m < count; m++) {
            const int i = moved[n], k = moved[m];
            d->P[i][k] += 0.5 * (g[0][i] * g[0][k] + g[1][i] * g[1][k]) * d->brought[axis];
        }
}

/* What an innovation adds to Fisher's information. */
static void inform(filter_state *at)
{
    for (int k = 0; k < at->request->noises; k++) {
        const noise_slopes_block *const one = &at->noises.by[k / BLOCK];
        const double spread = 0.5 * ((const double *)&one->spread)[k % BLOCK], turned = ((const double *)&one->nu)[k % BLOCK];
        EACH(at, d)
        d->information[k] += spread * d->spread + turned * d->nu;
    }
}

/* One scalar measurement, as the filter took it (measurement.h), and its part of the score and of Fisher's information

       d ln L = - sum (d ln s (1 - w^2) / 2 + w d nu / sqrt(s)),    I = sum (d ln s d ln s' / 2 + d nu d nu' / s) */
static void correct_noise_slopes(filter_state *at, filter_correction given, const double *PH, double s)
{
    const int awake = at->states.awake, *const order = at->states.order;
    const double *const H = given.H, *const K = given.K, nu = given.nu, w = nu * given.scale;
    EACH(at, d) {
        block by_PH[N], by_K[N], by_s = {0.0}, by_nu = {0.0};
        for (int n = 0; n < awake; n++) {
            by_PH[order[n]] = (block){0.0};
            for (int m = 0; m < awake; m++)
                if (H[order[m]] != 0.0)
                    by_PH[order[n]] += H[order[m]] * d->P[order[m]][order[n]];
        }
        for (int n = 0; n < awake; n++)
            if (H[order[n]] != 0.0) {
                by_s += H[order[n]] * by_PH[order[n]];
                by_nu -= H[order[n]] * d->x[order[n]];
            }
        for (int n = 0; n < awake; n++) {
            const int i = order[n];
            by_K[i] = (by_PH[i] - K[i] * by_s) / s;
            d->x[i] += K[i] * by_nu + nu * by_K[i];
        }
        for (int n = 0; n < awake; n++)
            for (int m = 0; m < awake; m++)
                d->P[order[n]][order[m]] -= by_K[order[n]] * PH[order[m]] + K[order[n]] * by_PH[order[m]];
        d->spread = by_s / s;
        d->nu = by_nu * given.scale;
        if (given.place >= 0)
            d->score -= 0.5 * (1.0 - w * w) * d->spread + w * d->nu;
    }
    if (given.place >= 0)
        inform(at);
}

#endif
