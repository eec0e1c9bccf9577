/* What the rigs have alike apart from how they move: damping of a rotor, angles shown late. */
#include <math.h>

#include "simulation.h"

enum { PAST_LENGTH = 1024 };

double rotor_damping(const rig_t *rig, int rotor, double speed)
{
    const double *p = rig->damping[rotor];
    double w = fabs(speed);
    return (p[2] * w + p[1]) * w + p[0];
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
