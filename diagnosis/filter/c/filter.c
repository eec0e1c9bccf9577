/* Extended Kalman filter over a plant's equations.
 *
 * The mean goes the kernel's way, with located friction and stops; the covariance, and the slopes by parameters of slopes.h, go by the
 * Jacobians at the middle of each step, second order in its length, of which fast states get pieces.
 */
#define LANES 1
#include "lane.h"

#include <string.h>

#include "quick_exp.h"
#define lane_exp quick_exp /* in the plant's equations below; where friction and stops act, events.c goes its own way */
#include "events.h"
#include "step.h"

#include "follow.h"
#include "slopes.h"
#include "states.h"

#define UNSURE 10.0 /* times what friction stops in a step, beyond which a speed's spread is no rest */
#define PIECES_ALLOWED 200 /* of the motion between events, */
#define PIECES_A_STEP 8    /* and for each step: a plant that rubs and rattles has some, one that makes no sense has no end of them */

#define FASTEST 0.5     /* of a state's own time constant, or of a radian's time of a swing, that a piece of a step may last, */
#define MANY_PIECES 8.0 /* but for so many: beyond, nothing is left of it anyway, and a piece need only be so short */
#define FADES 1.5       /* that the series, too, make less of it: at 2 they would begin to grow */
#define MOST_PIECES 64.0

/* Entries that are identically zero are never written, so these are emptied once a run. */
typedef struct {
    double A[N * N], D[N * N_PARAMETERS], H[N_OUTPUTS * N], E[N_OUTPUTS * N_PARAMETERS];
} jacobians;

typedef struct {
    filter_request *request;
    double c[N_CONSTANTS], u[N_INPUTS];
    plant_body body;
    int64_t pieces;
    jacobians j;
    matrix P, A, square, F, FP, PF; /* the last five are worked with within a step */
    /* Rows and columns of matrices are 0 where a state sleeps, but F's are those of 1, and are left alone. */
    awake_states states;
    follow_state following[N];
    filter_slopes slopes;
} filter_state;

static void start(filter_state *at, filter_request *request)
{
    at->request = request;
    at->j = (jacobians){{0.0}, {0.0}, {0.0}, {0.0}};
    model_constants(request->p, at->c);
    wake(&at->states, request);
    start_slopes(&at->slopes, request);
    for (int i = 0; i < N; i++) {
        at->following[i].z = -1.0;
        at->body.x[i] = request->x0[i];
        for (int j = 0; j < WIDTH; j++) {
            at->A[i][j] = at->square[i][j] = at->FP[i][j] = at->PF[i][j] = 0.0;
            at->F[i][j] = i == j;
            at->P[i][j] = i == j && !at->states.sleeps[i] ? request->p0[i] : 0.0;
        }
    }
    for (int a = 0; a < N_AXES; a++)
        if (request->locked[a]) {
            at->c[AXIS_LOWER[a]] = at->c[AXIS_UPPER[a]] = at->body.x[AXIS_POSITION[a]];
            at->body.x[AXIS_VELOCITY[a]] = 0.0;
        }
    for (int a = 0; a < AXES; a++)
        at->body.sign[a] = at->body.move[a] = 0.0;
    at->pieces = 0;
    request->log_likelihood = 0.0;
}

static void apply(filter_state *at, int64_t step)
{
    for (int j = 0; j < N_INPUTS; j++)
        at->u[j] = lane_clamp(at->request->u[step * N_INPUTS + j], at->c[INPUT_LOWER[j]], at->c[INPUT_UPPER[j]]);
}

/* One scalar measurement: innovation, gain, new mean, covariance and slopes. */
static void correct(filter_state *at, int64_t step, int output, double predicted, const double *H)
{
    filter_request *const r = at->request;
    const double variance = r->r[step * N_OUTPUTS + output];
    double PH[WIDTH] __attribute__((aligned(sizeof(block)))) = {0.0}, s = variance;
    for (int n = 0; n < at->states.awake; n++)
        UNROLLED for (int b = 0; b < ROW; b++)
            if (H[at->states.order[n]] != 0.0 && FILLED(at->states, b))
                ((block *)PH)[b] += ((block *)at->P[at->states.order[n]])[b] * H[at->states.order[n]];
    for (int n = 0; n < at->states.awake; n++)
        s += H[at->states.order[n]] * PH[at->states.order[n]];
    const double nu = r->y[step * N_OUTPUTS + output] - predicted, scale = 1.0 / sqrt(s);
    double K[N] = {0.0};
    for (int n = 0; n < at->states.awake; n++) {
        const int i = at->states.order[n];
        K[i] = PH[i] / s;
        at->body.x[i] += K[i] * nu;
        UNROLLED for (int b = 0; b < ROW; b++)
            if (FILLED(at->states, b))
                ((block *)at->P[i])[b] -= K[i] * ((block *)PH)[b];
    }
    if (r->K)
        for (int i = 0; i < N; i++) {
            r->K[(step * N_OUTPUTS + output) * N + i] = K[i];
            r->H[(step * N_OUTPUTS + output) * N + i] = H[i];
        }
    const int slot = r->slot[output];
    const int64_t row = r->place[step * N_OUTPUTS + output], place = row >= 0 && slot >= 0 ? row * r->slots + slot : -1;
    if (place >= 0) {
        r->log_likelihood -= 0.5 * (nu * nu / s + log(s));
        r->w[place] = nu * scale;
        r->s[place] = s;
    }
    const filter_correction given = {H, K, nu, scale, place};
    correct_slopes(&at->slopes, r, &at->states, output, at->j.E + output * N_PARAMETERS, given);
}

static void measure(filter_state *at, int64_t step)
{
    filter_request *const r = at->request;
    const int64_t row = r->row[step];
    double y[N_OUTPUTS];
    if (row >= 0)
        for (int i = 0; i < N; i++)
            r->x[row * N + i] = at->body.x[i];
    bool any_output = false;
    for (int o = 0; o < N_OUTPUTS; o++)
        any_output |= !isnan(r->y[step * N_OUTPUTS + o]);
    if (any_output) {
        model_output_slopes(r->t_s[step], at->body.x, at->c, at->j.H, at->j.E);
        for (int o = 0; o < N_OUTPUTS; o++) {
            if (isnan(r->y[step * N_OUTPUTS + o]))
                continue;
            model_outputs(r->t_s[step], at->body.x, at->c, y);
            correct(at, step, o, y[o], at->j.H + o * N);
        }
    }
    if (row >= 0 && r->filtered)
        for (int i = 0; i < N; i++)
            r->filtered[row * N + i] = at->body.x[i];
}

/* to = left times right, where `has` says which entries of `left` can be other than 0: known to the compiler, which leaves out the rest.
 * Rows of states that sleep are not touched. */
ALWAYS_INLINE void product(const filter_state *at, const matrix left, const int has[N][N], const matrix right, matrix to)
{
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i))
            continue;
        UNROLLED for (int b = 0; b < ROW; b++) {
            if (!FILLED(at->states, b))
                continue;
            block sum = {0.0};
            UNROLLED for (int m = 0; m < N; m++)
                if (has[i][m])
                    sum += left[i][m] * ((const block *)right[m])[b];
            ((block *)to[i])[b] = sum;
        }
    }
}

/* F = 1 + h A + h^2 A^2 / 2 */
static void transition(filter_state *at, double h_s)
{
    UNROLLED for (int i = 0; i < N; i++)
        UNROLLED for (int k = 0; k < N; k++)
            if (A_HAS[i][k])
                at->A[i][k] = at->j.A[i * N + k];
    product(at, at->A, A_HAS, at->A, at->square);
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i))
            continue;
        UNROLLED for (int k = 0; k < N; k++)
            if (F_HAS[i][k])
                at->F[i][k] = (i == k) + h_s * (at->A[i][k] + 0.5 * h_s * at->square[i][k]);
    }
}

/* The rows of F of states that follow, once those of all others are there. */
static void follow_transition(filter_state *at)
{
    UNROLLED for (int i = 0; i < N; i++) {
        if (!FOLLOWING(at->states, i))
            continue;
        const follow_weights w = at->following[i].whole;
        UNROLLED for (int k = 0; k < N; k++) {
            double sum = 0.0;
            UNROLLED for (int m = 0; m < N; m++)
                if (m != i && A_HAS[i][m])
                    sum += at->A[i][m] * (w.last * at->F[m][k] + (m == k ? w.first : 0.0));
            if (F_HAS[i][k])
                at->F[i][k] = i == k ? w.kept : sum;
        }
    }
}

/* P = F P F' + noise */
static void spread(filter_state *at, const double *noise)
{
    product(at, at->F, F_HAS, at->P, at->FP);
    for (int n = 0; n < at->states.awake; n++)
        for (int m = 0; m < at->states.awake; m++)
            at->PF[at->states.order[n]][at->states.order[m]] = at->FP[at->states.order[m]][at->states.order[n]];
    product(at, at->F, F_HAS, at->PF, at->P);
    for (int i = 0; i < N; i++) {
        for (int k = 0; AWAKE(at->states, i) && k < i; k++)
            at->P[k][i] = at->P[i][k];
        at->P[i][i] += noise[i];
    }
}

/* White noise on a speed as it spreads within the step, the integral of g(t) g(t)' dt noise / h with g(t) the speed's column of F over t:
 * by Gauss's rule at two instants, which is exact for the speed and its position. As a sum of squares it leaves no reading, however sure
 * and however far behind the speed, a variance below zero. */
static void stir(filter_state *at, int v, double h_s, double noise)
{
    for (int k = 0; k < INSTANTS; k++) {
        const double t_s = INSTANT[k] * h_s;
        double g[WIDTH] __attribute__((aligned(sizeof(block)))) = {0.0};
        for (int n = 0; n < at->states.awake; n++) {
            const int i = at->states.order[n];
            g[i] = (i == v) + t_s * (at->A[i][v] + 0.5 * t_s * at->square[i][v]);
        }
        for (int i = 0; i < N; i++) {
            if (!FOLLOWING(at->states, i))
                continue;
            const follow_weights w = at->following[i].until[k];
            g[i] = 0.0;
            for (int m = 0; m < N; m++)
                if (m != i && A_HAS[i][m])
                    g[i] += at->A[i][m] * (w.last * g[m] + (m == v ? w.first : 0.0));
        }
        for (int n = 0; n < at->states.awake; n++) {
            const int i = at->states.order[n];
            UNROLLED for (int b = 0; b < ROW; b++)
                if (g[i] != 0.0 && FILLED(at->states, b))
                    ((block *)at->P[i])[b] += 0.5 * noise * g[i] * ((const block *)g)[b];
        }
    }
}

/* Noise of states other than speeds comes half before a step's motion, half behind it; of one with a memory, of which `kept` is left,
 * (1 - kept^2) q / 2 rate in all. */
static void halve(filter_state *at, const double *kept, double *noise)
{
    for (int i = 0; i < N; i++) {
        noise[i] /= 1.0 + kept[i] * kept[i];
        at->P[i][i] += noise[i];
    }
}

/* What the friction of each axis may do: its level as an acceleration at rest, in doubt for `rub` seconds about v = 0. */
static void doubt(const filter_state *at, const double *level, double h_s, double *noise)
{
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double rub = at->request->rub[a], square = level[a] * level[a];
        const double rest_s = at->request->rest_s, width = square * rest_s * rest_s + at->P[v][v];
        if (square > 0.0 && rub > 0.0)
            noise[v] += square * h_s * rub * quick_exp(-0.5 * at->body.x[v] * at->body.x[v] / (width + 1e-12));
    }
}

/* Which axes are taken to rest: held by a stop, or by friction that could have stopped what is known of their speed. Where a flight
 * begins nothing is, and an axis that the first guess holds may well be moving: to take it as sure would keep all later readings out. */
static void resting(const filter_state *at, const double *level, double h_s, const double *noise, bool *rests)
{
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double position = at->body.x[AXIS_POSITION[a]], stopped = level[a] * at->request->rest_s;
        const bool rubs = level[a] > 0.0 && !at->request->locked[a] && position > at->c[AXIS_LOWER[a]] && position < at->c[AXIS_UPPER[a]];
        const double usual = noise[v] * at->request->rest_s / h_s;
        const bool unsure = rubs && at->P[v][v] > UNSURE * UNSURE * (usual + stopped * stopped);
        rests[a] = at->body.move[a] == 0.0 && !unsure;
    }
}

/* The column of F by which a speed moves all other states, times a factor. */
static void scale_column(filter_state *at, int v, double factor)
{
    for (int n = 0; n < at->states.awake; n++)
        if (at->states.order[n] != v)
            at->F[at->states.order[n]][v] *= factor;
}

/* What is left over a step of each state that is noise with a memory, exactly: rows may be further apart than it lasts. Others keep all. */
static void forgetting(const filter_state *at, double h_s, double *kept, double *noise)
{
    const filter_request *const r = at->request;
    for (int i = 0; i < N; i++) {
        kept[i] = 1.0;
        if (r->forget[i] > 0.0 && AWAKE(at->states, i)) {
            kept[i] = exp(-r->forget[i] * h_s);
            noise[i] = 0.5 * r->q[i] / r->forget[i] * (1.0 - kept[i] * kept[i]);
        }
    }
}

/* The rows of the axes' speeds, of `width` numbers each, set to 0 where chosen. */
static void empty_rows(const bool *chosen, double *rows, int width)
{
    for (int a = 0; a < N_AXES; a++)
        for (int k = 0; chosen[a] && k < width; k++)
            rows[AXIS_VELOCITY[a] * width + k] = 0.0;
}

/* Where states that follow others are after a step from `before`; `slopes_A` are those at its middle. */
static void follow(filter_state *at, const plant_body *before, double t_s, double h_s, const double *slopes_A)
{
    bool any_follows = false;
    for (int i = 0; i < N; i++)
        any_follows |= FOLLOWING(at->states, i);
    if (!any_follows)
        return;
    double rates[N], torque[AXES], up[AXES], down[AXES];
    follow_over(at->following, &at->states, slopes_A, h_s);
    model_rates(t_s, before->x, at->u, at->c, before->sign, before->move, rates, torque, up, down);
    for (int i = 0; i < N; i++) {
        if (!FOLLOWING(at->states, i))
            continue;
        const follow_weights w = at->following[i].whole;
        double g = rates[i] - slopes_A[i * N + i] * before->x[i], changed = 0.0;
        for (int m = 0; m < N; m++)
            if (m != i && A_HAS[i][m])
                changed += slopes_A[i * N + m] * (at->body.x[m] - before->x[m]);
        at->body.x[i] = w.kept * before->x[i] + (w.first + w.last) * g + w.last * changed;
    }
}

/* One piece of a step, `share` of it, from t_s on. */
static void advance(filter_state *at, int64_t step, double t_s, double h_s, double share)
{
    filter_request *const r = at->request;
    double x[N], middle[N], noise[N], kept[N], level[AXES] = {0.0}, sign[AXES];
    bool rests[AXES], held[AXES];
    step_stages seen;
    plant_body before = at->body;
    for (int i = 0; i < N; i++)
        noise[i] = AWAKE(at->states, i) ? r->q[i] * h_s + (r->stir ? r->stir[step * N + i] * share : 0.0) : 0.0;
    forgetting(at, h_s, kept, noise);
    for (int a = 0; a < AXES; a++)
        sign[a] = 1.0;
    model_friction(t_s, at->body.x, at->u, at->c, sign, level);
    doubt(at, level, h_s, noise);
    rk4_step(t_s, h_s, &at->body, at->u, at->c, x, &seen);
    const bool suspect = N_AXES + N_KINKS > 0 && any(step_suspect(&at->body, x, h_s, at->c, &seen));
    if (suspect)
        at->pieces += events_advance(at->body.x, at->body.sign, at->body.move, t_s, h_s, at->u, at->c, NULL, NULL);
    else
        for (int i = 0; i < N; i++)
            at->body.x[i] = x[i];
    for (int i = 0; i < N; i++)
        if (kept[i] < 1.0)
            at->body.x[i] = kept[i] * before.x[i];
    for (int i = 0; i < N; i++)
        middle[i] = 0.5 * (before.x[i] + at->body.x[i]);
    resting(at, level, h_s, noise, rests);
    for (int a = 0; a < N_AXES; a++)
        held[a] = at->body.move[a] == 0.0;
    jacobians *const j = &at->j;
    model_state_slopes(t_s + 0.5 * h_s, middle, at->u, at->c, at->body.sign, j->A);
    follow(at, &before, t_s, h_s, j->A);
    for (int i = 0; i < N; i++)
        if (FOLLOWING(at->states, i))
            middle[i] = 0.5 * (before.x[i] + at->body.x[i]);
    if (r->columns)
        model_parameter_slopes(t_s + 0.5 * h_s, middle, at->u, at->c, at->body.sign, j->D);
    empty_rows(rests, j->A, N);
    transition(at, h_s);
    empty_rows(rests, at->F[0], WIDTH);
    for (int i = 0; i < N; i++)
        if (kept[i] < 1.0)
            at->F[i][i] = kept[i];
    follow_transition(at);
    /* The mean stays where friction holds it, however unsure its speed is: parameters move nothing there. */
    empty_rows(held, j->A, N);
    empty_rows(held, j->D, N_PARAMETERS);
    move_slopes(&at->slopes, r, &at->states, h_s, j->A, j->D, kept, at->following);
    for (int a = 0; a < N_AXES; a++) {
        if (held[a])
            hold_slopes(&at->slopes, r, AXIS_VELOCITY[a]);
        if (r->locked[a])
            noise[AXIS_VELOCITY[a]] = 0.0;
    }
    /* Friction stops within the usual step whatever moves an axis at rest: the row of its speed is emptied, and all that is unknown of that
     * comes after. That is what the usual step brings, however long this one was, and moves the other states by the root of time, as steps
     * that know nothing of one another do: so instants more or less change nothing. */
    const double usual = r->rest_s / h_s;
    double jolts[AXES] = {0.0}, stays[AXES] = {0.0};
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        if (rests[a])
            scale_column(at, v, sqrt(usual));
        (rests[a] ? stays : jolts)[a] = noise[v] * (rests[a] ? usual : 1.0);
        noise[v] = 0.0;
    }
    halve(at, kept, noise);
    spread(at, noise);
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        at->P[v][v] += stays[a];
        if (rests[a])
            scale_column(at, v, 1.0 / sqrt(usual));
        if (jolts[a] > 0.0)
            stir(at, v, h_s, jolts[a]);
    }
}

/* How many pieces a step is done in: as many as the fastest state, and the fastest two that swing against each other, need for series that
 * end at h^2; but for noise with a memory and states that follow. */
static int pieces_of(const filter_state *at, double h_s)
{
    const double *const A = at->j.A;
    double fastest = 0.0, swinging = 0.0;
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i) || FOLLOWING(at->states, i) || at->request->forget[i] > 0.0)
            continue;
        fastest = fmax(fastest, fabs(A[i * N + i]));
        UNROLLED for (int k = 0; k < i; k++)
            if (A_HAS[i][k] && A_HAS[k][i])
                swinging = fmax(swinging, fabs(A[i * N + k] * A[k * N + i]));
    }
    const double span = h_s * fmax(fastest, sqrt(swinging)), enough = fmax(MANY_PIECES, ceil(span / FADES));
    return (int)fmin(fmax(ceil(span / FASTEST), 1.0), fmin(enough, MOST_PIECES));
}

/* F of the pieces done so far: that of the last times that of those before it. */
static void keep_transition(const filter_state *at, double *F, bool is_first)
{
    double product[N * N];
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            product[i * N + k] = is_first ? at->F[i][k] : 0.0;
            for (int m = 0; !is_first && m < N; m++)
                product[i * N + k] += at->F[i][m] * F[m * N + k];
        }
    memcpy(F, product, sizeof(product));
}

static void advance_to_next(filter_state *at, int64_t step)
{
    const filter_request *const r = at->request;
    const double t_s = r->t_s[step], h_s = r->t_s[step + 1] - t_s;
    const int pieces = pieces_of(at, h_s);
    for (int piece = 0; piece < pieces; piece++) {
        advance(at, step, t_s + piece * h_s / pieces, h_s / pieces, 1.0 / pieces);
        if (r->F)
            keep_transition(at, r->F + step * N * N, piece == 0);
    }
}

/* Returns the number of instants done; fewer than asked when the state left all bounds, or rattles in nearly every step. */
int32_t filter_run(filter_request *request)
{
    static _Thread_local filter_state at;
    if (request->columns > MAX_COLUMNS)
        return -1;
    start(&at, request);
    for (int64_t step = 0; step < request->steps; step++) {
        apply(&at, step);
        measure(&at, step);
        events_settle(at.body.x, at.body.sign, at.body.move, request->t_s[step], at.u, at.c);
        if (step == 0) /* how fast the states are, before any step has told */
            model_state_slopes(request->t_s[0], at.body.x, at.u, at.c, at.body.sign, at.j.A);
        if (step + 1 < request->steps)
            advance_to_next(&at, step);
        for (int i = 0; i < N; i++)
            if (!(fabs(at.body.x[i]) < 1e9))
                return (int32_t)step;
        if (at.pieces > PIECES_ALLOWED + PIECES_A_STEP * step)
            return (int32_t)step;
    }
    finish_slopes(&at.slopes, request);
    return (int32_t)request->steps;
}
