/* Commands under way. */
#include "simulation.h"

enum { LINE_LENGTH = 256 };

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
