/* What the rigs have alike apart from how they move: damping of a rotor, commands under way, angles shown late. */
#include <math.h>

#include "simulation.h"

enum { LINE_LENGTH = 64, PAST_LENGTH = 1024 };

double rotor_damping(const rig_t *rig, int rotor, double speed)
{
    const double *p = rig->damping[rotor];
    double w = fabs(speed);
    return (p[2] * w + p[1]) * w + p[0];
}

void line_send(line_t *line, double t_s, double luck, double u_V)
{
    line->sent_s[line->head] = t_s;
    line->luck[line->head] = luck;
    line->u_V[line->head] = u_V;
    line->head = (line->head + 1) % LINE_LENGTH;
}

/* The newest command that has been under way for its whole delay, which its luck (-1 to 1) makes longer or shorter; none
 * overtakes another. */
double line_arrived(line_t *line, double t_s, double delay_s, double spread)
{
    while (line->tail != line->head) {
        if (line->sent_s[line->tail] + delay_s * (1.0 + spread * line->luck[line->tail]) > t_s + 1e-9)
            break;
        line->now_V = line->u_V[line->tail];
        line->tail = (line->tail + 1) % LINE_LENGTH;
    }
    return line->now_V;
}

/* As if the shaft had stood there for ever. */
void past_fill(past_t *past, double angle, double rate)
{
    for (int index = 0; index < PAST_LENGTH; index++) {
        past->angle[index] = angle;
        past->rate[index] = rate;
    }
}

/* Takes what the shaft shows now, gives what it showed that long ago; once a step. */
void past_delay(past_t *past, double delay_s, double dt, double *angle, double *rate)
{
    past->angle[past->index] = *angle;
    past->rate[past->index] = *rate;
    int back = (int)(delay_s / dt + 0.5);
    int index = (past->index - back + PAST_LENGTH) % PAST_LENGTH;
    *angle = past->angle[index];
    *rate = past->rate[index];
    past->index = (past->index + 1) % PAST_LENGTH;
}
