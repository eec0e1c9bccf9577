/* Outputs and their exact derivatives along a run with given inputs: the variational equations, integrated with the run itself.
 *
 * dS/dt = A S + D for S = dx/d(columns), by the same Runge-Kutta stages. At an event, where the rates jump from f- to f+ at an instant
 * that itself depends on the columns, S+ = S- + (f- - f+) dt*, with dt* from the event's margin: exact to first order, so neither
 * sticking nor stops are left out.
 */
#define LANES 1
#define EQUATIONS_ONCE /* inside each caller they run no faster here, and take the compiler twice as long */
#include "run.h"

#include "sensitivity.h"

#define MAX_COLUMNS 128

typedef struct {
    double row[N_STATES][MAX_COLUMNS];
} matrix;

typedef struct {
    const sensitivity_request *request;
    const double *c;
    double B_scale[N_INPUTS]; /* 0 for an input at its limit, which a small change does not move */
    const double *commanded, *u;
    int columns;    /* rounded up to whole vectors */
    int parameters; /* so many columns at the beginning are parameters */
} context;

/* f's derivatives by state, inputs and parameters. */
typedef struct {
    double A[N_STATES * N_STATES], B[N_STATES * N_INPUTS], D[N_STATES * N_PARAMETERS];
} jacobians;

static inline void evaluate(const context *at, double t_s, const double *x, const double *sign, jacobians *j)
{
    *j = (jacobians){{0.0}, {0.0}, {0.0}};
    model_state_slopes(t_s, x, at->u, at->c, sign, j->A);
    model_input_slopes(t_s, x, at->u, at->c, sign, j->B);
    model_parameter_slopes(t_s, x, at->u, at->c, sign, j->D);
}

/* Row i of the derivatives by the columns, apart from the way through the state. */
static inline void forcing(const context *at, const jacobians *j, int i, double *to)
{
    const double *const D = j->D + i * N_PARAMETERS, *const B = j->B + i * N_INPUTS;
    for (int column = 0; column < at->parameters; column++)
        to[column] = D[at->request->column[column]];
    for (int column = at->parameters; column < at->columns; column++)
        to[column] = 0.0;
    for (int column = at->parameters; column < at->request->columns; column++) {
        const int which = at->request->column[column] - N_PARAMETERS;
        if (which < 0)
            to[column] = D[which + N_PARAMETERS];
        else if (which < 2 * N_INPUTS)
            to[column] = B[which % N_INPUTS] * at->B_scale[which % N_INPUTS] * (which < N_INPUTS ? at->commanded[which] : 1.0);
    }
}

static bool held_row(const plant_body *body, int i)
{
    for (int a = 0; a < N_AXES; a++)
        if (i == AXIS_VELOCITY[a] && body->move[a] == 0.0)
            return true;
    return false;
}

static void slope(const context *at, const plant_body *body, double t_s, const double *x, const matrix *S, matrix *dS)
{
    jacobians j;
    evaluate(at, t_s, x, body->sign, &j);
    for (int i = 0; i < N_STATES; i++) {
        double *const restrict to = dS->row[i];
        if (held_row(body, i)) {
            for (int column = 0; column < at->columns; column++)
                to[column] = 0.0;
            continue;
        }
        forcing(at, &j, i, to);
        for (int k = 0; k < N_STATES; k++) {
            const double a = j.A[i * N_STATES + k];
            if (a == 0.0)
                continue;
            for (int column = 0; column < at->columns; column++)
                to[column] += a * S->row[k][column];
        }
    }
}

static void combine(const context *at, const matrix *S, double h_s, const matrix *dS, matrix *result)
{
    for (int i = 0; i < N_STATES; i++)
        for (int column = 0; column < at->columns; column++)
            result->row[i][column] = S->row[i][column] + h_s * dS->row[i][column];
}

/* S over a stretch without events, and x with it. */
static void rk4_sensitivity(const context *at, plant_body *body, double t_s, double h_s, matrix *S)
{
    static const double AT[4] = {0.0, 0.5, 0.5, 1.0}, WEIGHT[4] = {1.0, 2.0, 2.0, 1.0};
    matrix sum, stage, dS;
    combine(at, S, 0.0, S, &sum);
    combine(at, S, 0.0, S, &stage);
    double x[N_STATES], k[N_STATES], x_sum[N_STATES], torque[AXES], up[AXES], down[AXES];
    for (int i = 0; i < N_STATES; i++)
        x[i] = x_sum[i] = body->x[i];
    for (int s = 0; s < 4; s++) {
        const double then_s = t_s + AT[s] * h_s;
        model_rates(then_s, x, at->u, at->c, body->sign, body->move, k, torque, up, down);
        slope(at, body, then_s, x, &stage, &dS);
        combine(at, &sum, WEIGHT[s] * h_s / 6.0, &dS, &sum);
        for (int i = 0; i < N_STATES; i++)
            x_sum[i] += WEIGHT[s] * h_s / 6.0 * k[i];
        if (s == 3)
            break;
        combine(at, S, AT[s + 1] * h_s, &dS, &stage);
        for (int i = 0; i < N_STATES; i++)
            x[i] = body->x[i] + AT[s + 1] * h_s * k[i];
    }
    *S = sum;
    for (int i = 0; i < N_STATES; i++)
        body->x[i] = x_sum[i];
}

/* d(stop)/d(column): the stops are parameters, too. */
static double stop_slope(const context *at, int axis, int event, int column)
{
    const double *const slopes = event == EVENT_LOWER ? at->request->lower_slope : at->request->upper_slope;
    const int which = at->request->column[column];
    return which < N_PARAMETERS ? slopes[axis * N_PARAMETERS + which] : 0.0;
}

/* An axis that in a whole step moves by less than this share of what its place and its acceleration come to does not hit its stop but is
 * there: a time of arrival that turns on such a speed is none, and its slope would be the reciprocal of rounding. */
#define GRAZE 1e-12

/* Whether a stop is hit at a speed that tells when. */
static bool is_hit(const plant_body *before, const double *rates, int axis, double h_s)
{
    const double speed = before->x[AXIS_VELOCITY[axis]], gained = rates[AXIS_VELOCITY[axis]] * h_s;
    return fabs(speed) > GRAZE * (fabs(before->x[AXIS_POSITION[axis]]) / h_s + fabs(gained) + GRAZE);
}

static void jump(const context *at, const plant_body *before, const plant_body *after, double t_s, double h_s, event_piece piece, matrix *S)
{
    double old[N_STATES], new[N_STATES], torque[AXES], up[AXES], down[AXES];
    model_rates(t_s, before->x, at->u, at->c, before->sign, before->move, old, torque, up, down);
    model_rates(t_s, after->x, at->u, at->c, after->sign, after->move, new, torque, up, down);
    const int position = AXIS_POSITION[piece.axis], velocity = AXIS_VELOCITY[piece.axis];
    const bool stop = piece.event != EVENT_REST;
    const double speed = stop ? before->x[velocity] : old[velocity];
    const bool is_told = stop ? is_hit(before, old, piece.axis, h_s) : speed != 0.0;
    for (int column = 0; column < at->request->columns; column++) {
        const double limit = stop ? stop_slope(at, piece.axis, piece.event, column) : 0.0;
        const double distance = stop ? S->row[position][column] - limit : S->row[velocity][column];
        const double later = is_told ? -distance / speed : 0.0;
        for (int i = 0; i < N_STATES; i++)
            S->row[i][column] += (old[i] - new[i]) * later;
        if (stop)
            S->row[position][column] = limit;
        S->row[velocity][column] = -new[velocity] * later;
    }
}

/* At the zero of a state where the rates may have a step; a mere kink leaves S as it is. At a breakaway the rates do not jump. */
static void jump_kink(const context *at, const plant_body *before, const plant_body *after, double t_s, event_piece piece, matrix *S)
{
    double old[N_STATES], new[N_STATES], torque[AXES], up[AXES], down[AXES];
    plant_body last = *before;
    const int state = KINK_STATE[piece.axis];
    last.x[state] = -after->x[state];
    model_rates(t_s, last.x, at->u, at->c, last.sign, last.move, old, torque, up, down);
    model_rates(t_s, after->x, at->u, at->c, after->sign, after->move, new, torque, up, down);
    for (int column = 0; column < at->request->columns; column++) {
        const double later = old[state] != 0.0 ? -S->row[state][column] / old[state] : 0.0;
        for (int i = 0; i < N_STATES; i++)
            S->row[i][column] += (old[i] - new[i]) * later;
    }
}

/* One step: the events are found by the same code as in a plain run, then S follows stretch by stretch. */
static void advance_with(const context *at, plant_body *body, double t_s, double h_s, matrix *S)
{
    event_piece pieces[MAX_EVENTS + 1];
    plant_body next = *body;
    step_stages seen;
    rk4_step(t_s, h_s, body, at->u, at->c, next.x, &seen);
    if (!step_suspect(body, next.x, h_s, at->c, &seen)) {
        rk4_sensitivity(at, body, t_s, h_s, S);
        *body = next;
        return;
    }
    events_settle(body->x, body->sign, body->move, t_s, at->u, at->c);
    next = *body;
    const int count = events_advance(next.x, next.sign, next.move, t_s, h_s, at->u, at->c, 0, pieces);
    for (int n = 0; n < count; n++) {
        rk4_sensitivity(at, body, pieces[n].t_s, pieces[n].h_s, S);
        if (pieces[n].event == EVENT_NONE)
            break;
        const plant_body before = *body;
        const double then_s = pieces[n].t_s + pieces[n].h_s;
        events_apply(body->x, body->sign, body->move, then_s, at->u, at->c, pieces[n]);
        if (pieces[n].event < EVENT_BREAK_UP)
            jump(at, &before, body, then_s, h_s, pieces[n], S);
        else if (pieces[n].event > EVENT_BREAK_DOWN)
            jump_kink(at, &before, body, then_s, pieces[n], S);
    }
    *body = next;
}

static void record(const context *at, const plant_body *body, double t_s, int64_t sample, const matrix *S)
{
    const sensitivity_request *const request = at->request;
    double H[N_OUTPUTS * N_STATES] = {0.0}, E[N_OUTPUTS * N_PARAMETERS] = {0.0};
    model_output_slopes(t_s, body->x, at->c, H, E);
    model_outputs(t_s, body->x, at->c, request->y + sample * N_OUTPUTS);
    for (int i = 0; i < N_OUTPUTS; i++) {
        double *const to = request->dy + (sample * N_OUTPUTS + i) * request->columns;
        for (int column = 0; column < request->columns; column++) {
            const int which = request->column[column];
            to[column] = which < N_PARAMETERS ? E[i * N_PARAMETERS + which] : 0.0;
            for (int k = 0; k < N_STATES; k++)
                to[column] += H[i * N_STATES + k] * S->row[k][column];
        }
    }
    for (int i = 0; request->x && i < N_STATES; i++)
        request->x[sample * N_STATES + i] = body->x[i];
}

static void apply_input(context *at, int64_t sample, double *u)
{
    at->commanded = at->request->input + sample * N_INPUTS;
    for (int j = 0; j < N_INPUTS; j++) {
        const double lower = at->c[INPUT_LOWER[j]], upper = at->c[INPUT_UPPER[j]];
        u[j] = lane_clamp(at->commanded[j], lower, upper);
        at->B_scale[j] = at->commanded[j] >= lower && at->commanded[j] <= upper ? 1.0 : 0.0;
    }
}

/* 0, or 1 when there are more columns than there is room for. */
int sensitivity_run(const sensitivity_request *request)
{
    if (request->columns > MAX_COLUMNS)
        return 1;
    double c[N_CONSTANTS], u[N_INPUTS];
    model_constants(request->p, c);
    context at = {.request = request, .c = c, .u = u, .columns = (request->columns + 7) / 8 * 8};
    while (at.parameters < request->columns && request->column[at.parameters] < N_PARAMETERS)
        at.parameters++;
    matrix S = {{{0.0}}};
    plant_body body;
    for (int i = 0; i < N_STATES; i++) {
        body.x[i] = request->x0[i];
        for (int column = 0; column < request->columns; column++)
            S.row[i][column] = request->column[column] == N_PARAMETERS + 2 * N_INPUTS + i ? 1.0 : 0.0;
    }
    for (int64_t sample = 0; sample < request->samples; sample++) {
        const double t_s = request->t_s[sample];
        apply_input(&at, sample, u);
        if (sample == 0)
            events_settle(body.x, body.sign, body.move, t_s, u, c);
        record(&at, &body, t_s, sample, &S);
        if (sample + 1 == request->samples)
            break;
        const double h_s = (request->t_s[sample + 1] - t_s) / request->substeps;
        for (int step = 0; step < request->substeps; step++)
            advance_with(&at, &body, t_s + step * h_s, h_s, &S);
    }
    return 0;
}
